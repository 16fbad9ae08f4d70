//! The endoscope of an emulated rig sees both instruments where the simulated world has them.
#![cfg(target_os = "linux")]
use std::{
    net::TcpListener,
    thread,
    time::{Duration, Instant},
};

use nima_endoscope::Feed;
use nima_machine::{config::Endoscope, rig::Side};
use nima_testing::real_time::alone;
use nima_tests::emulated::{elsewhere, started_in};
use nima_world::{
    emulators::endoscope::{camera_of, usual},
    scene::Scene,
};

#[test]
fn both_tips_are_in_the_picture_where_the_world_has_them() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    let (devices, scene) = (elsewhere(folder.path()), Scene::load("bimanual").unwrap());
    let mut rig = started_in(&scene, &devices);
    let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let mut settings = usual(&scene);
    settings.k1 = 0.3;
    let url = format!("http://127.0.0.1:{port}/");
    let endoscope = Endoscope { url: url.clone(), camera: Some(settings), ..Endoscope::default() };
    let elsewhere = Endoscope { url: "http://192.0.2.1/".to_owned(), ..endoscope.clone() };
    let told = rig.show(&elsewhere, &devices, &scene).unwrap_err().to_string();
    assert!(told.contains("endoscope") && told.contains("127.0.0.1"), "{told}");
    rig.show(&endoscope, &devices, &scene).unwrap();
    assert_eq!(rig.servings().last().map(|device| device.name.as_str()), Some("endoscope"));

    let feed = Feed::start(url.parse().unwrap(), Some(settings.size_px), || {}).unwrap();
    let begin = Instant::now();
    let picture = loop {
        if let Some((_, picture)) = feed.look(Instant::now()).picture {
            break picture;
        }
        assert!(begin.elapsed() < Duration::from_secs(30), "{:?}", feed.standing(Instant::now()));
        thread::sleep(Duration::from_millis(5));
    };
    // Nobody drives the arms, so that the tips are still where they were.
    for side in Side::ALL {
        let place_px = camera_of(&settings).project(&rig.truth(side).unwrap().tip_m).unwrap();
        let at = 4 * (picture.size_px[0] * place_px.y as usize + place_px.x as usize);
        let [r, g, b] = [0, 1, 2].map(|colour| picture.rgba[at + colour]);
        assert!(g > 150 && r < 90 && b < 150, "{side:?}: {r} {g} {b} at {place_px}");
    }
}
