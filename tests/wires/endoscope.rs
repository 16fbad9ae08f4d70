//! The endoscope of an emulated rig shows both instruments at their positions in the simulated world, also after it was
//! pushed.
#![cfg(target_os = "linux")]
use std::{
    net::TcpListener,
    thread,
    time::{Duration, Instant},
};

use nalgebra::{Isometry3, Vector2, Vector3};
use nima_emulation::emulators::EmulatedFault;
use nima_endoscope::{Camera, DecodedImage, EndoscopeFeed};
use nima_machine::{
    config::EndoscopeConfig,
    rig::{DeviceRig, Rig, SIDES, Side},
};
use nima_simulation::{
    camera::{camera_of, usual},
    scene::Scene,
};
use nima_testing::real_time::{alone, judged};
use nima_tests::emulated::{elsewhere, started_in};

use super::sides::hand_eye;

fn free_port() -> u16 {
    TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port()
}

#[test]
fn both_tips_are_in_the_picture_where_the_world_has_them() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    let devices = elsewhere(folder.path());
    let scene = Scene::load("bimanual").unwrap();
    let mut rig = started_in(&scene, &devices);
    let port = free_port();
    let mut settings = usual(&scene);
    settings.k1 = 0.3;
    let url = format!("http://127.0.0.1:{port}/");
    let endoscope = EndoscopeConfig { url: url.clone(), camera: Some(settings), ..EndoscopeConfig::default() };
    let elsewhere = EndoscopeConfig { url: "http://192.0.2.1/".to_owned(), ..endoscope.clone() };
    let report = rig.show(&elsewhere, &devices, &scene).unwrap_err().to_string();
    assert!(report.contains("endoscope") && report.contains("127.0.0.1"), "{report}");
    rig.show(&endoscope, &devices, &scene).unwrap();
    assert_eq!(rig.servings().last().map(|device| device.name.as_str()), Some("endoscope"));

    let feed = EndoscopeFeed::start(url.parse().unwrap(), Some(settings.size_px), || {}).unwrap();
    let begin = Instant::now();
    let image = loop {
        if let Some((_, image)) = feed.look(Instant::now()).image {
            break image;
        }
        assert!(begin.elapsed() < Duration::from_secs(30), "{:?}", feed.standing(Instant::now()));
        thread::sleep(Duration::from_millis(5));
    };
    // The arms are not driven, so the tips have not moved.
    for side in Side::ALL {
        let place_px = camera_of(&settings).project(&rig.truth(side).unwrap().tip_m).unwrap();
        let at = 4 * (image.size_px[0] * place_px.y as usize + place_px.x as usize);
        let [r, g, b] = [0, 1, 2].map(|colour| image.rgba[at + colour]);
        assert!(g > 150 && r < 90 && b < 150, "{side:?}: {r} {g} {b} at {place_px}");
    }
}

fn is_tip(pixel: &[u8]) -> bool {
    pixel[1] > 150 && pixel[0] < 90 && pixel[2] < 150
}

/// Returns the middle of the visible tip near this point, px; `None` if there is none.
fn tip_px(image: &DecodedImage, near_px: &Vector2<f64>) -> Option<Vector2<f64>> {
    let width = image.size_px[0];
    let places = image.rgba.chunks_exact(4).enumerate().filter(|(_, pixel)| is_tip(pixel));
    let places = places.map(|(at, _)| Vector2::new((at % width) as f64 + 0.5, (at / width) as f64 + 0.5));
    let near: Vec<_> = places.filter(|place_px| (place_px - near_px).norm() < 40.0).collect();
    (near.len() > 20).then(|| near.iter().sum::<Vector2<f64>>() / near.len() as f64)
}

/// Reads the rig for this long; returns the mean position of the endoscope's marker, and its last orientation.
fn marker(rig: &mut DeviceRig, begin: Instant, last: Duration) -> Option<Isometry3<f64>> {
    let end = Instant::now() + last;
    let mut seen = Vec::new();
    while Instant::now() < end {
        let inputs = rig.read(begin.elapsed().as_secs_f64());
        seen.extend(inputs.iter().flatten().filter_map(|inputs| inputs.view.world_from_n().copied()));
        thread::sleep(Duration::from_millis(1));
    }
    let newest = seen.last()?;
    let mean_m = seen.iter().map(|pose| pose.translation.vector).sum::<Vector3<f64>>() / seen.len() as f64;
    Some(Isometry3::from_parts(mean_m.into(), newest.rotation))
}

#[test]
fn the_camera_goes_with_the_marker_on_a_pushed_endoscope() {
    let _alone = alone();
    judged(|| {
        let folder = tempfile::tempdir().unwrap();
        let mut devices = elsewhere(folder.path());
        let scene = Scene::load("bimanual").unwrap();
        let mut emulated = started_in(&scene, &devices);
        for (set, side) in [&mut devices.right, &mut devices.left].into_iter().zip(Side::ALL) {
            hand_eye(set.as_mut().unwrap(), &emulated.truth(side).unwrap());
        }
        let settings = usual(&scene);
        let url = format!("http://127.0.0.1:{}/", free_port());
        let endoscope = EndoscopeConfig { url: url.clone(), camera: Some(settings), ..EndoscopeConfig::default() };
        emulated.show(&endoscope, &devices, &scene).unwrap();
        let (mut rig, _) = DeviceRig::start(&devices, 1e-3, [false; SIDES]).unwrap();
        let begin = Instant::now();
        let mut seen = None;
        while seen.is_none() && begin.elapsed() < Duration::from_mins(2) {
            seen = marker(&mut rig, begin, Duration::from_millis(500));
        }
        let fixed = camera_of(&settings);
        let n_from_camera = seen.expect("the tracker sees the endoscope").inverse() * fixed.world_from_camera;

        let feed = EndoscopeFeed::start(url.parse().unwrap(), Some(settings.size_px), || {}).unwrap();
        assert!(emulated.set_fault("endoscope", EmulatedFault::Moved));
        // Rendering the first image takes some tenths of a second.
        let end = Instant::now() + Duration::from_secs(20);
        let misses_px = loop {
            let world_from_n = marker(&mut rig, begin, Duration::from_millis(500)).unwrap();
            let camera = Camera { world_from_camera: world_from_n * n_from_camera, ..fixed };
            let image = feed.look(Instant::now()).image;
            let misses = Side::ALL.map(|side| {
                let tip_m = emulated.truth(side).unwrap().tip_m;
                let [before_px, drawn_px] = [&fixed, &camera].map(|camera| camera.project(&tip_m).unwrap());
                assert!((before_px - drawn_px).norm() > 20.0 || Instant::now() < end, "{before_px} {drawn_px}");
                let is_px = tip_px(&image.as_ref()?.1, &drawn_px)?;
                Some((is_px - drawn_px).norm()).filter(|_| (before_px - drawn_px).norm() > 20.0)
            });
            if let [Some(right_px), Some(left_px)] = misses {
                break [right_px, left_px];
            }
            assert!(Instant::now() < end, "{misses:?}");
        };
        println!("{misses_px:?} px");
        assert!(misses_px.iter().all(|miss_px| *miss_px < 5.0), "{misses_px:?} px");
    });
}
