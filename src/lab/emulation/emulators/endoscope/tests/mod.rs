use std::{
    sync::Arc,
    thread,
    time::{Duration, Instant, SystemTime, UNIX_EPOCH},
};

use nalgebra::Vector2;
use nima_endoscope::{
    Damage, DecodedImage, EndoscopeError, EndoscopeFeed, FROZEN, FeedSnapshot, FrameFault, FrameHealth, jpeg, time_code,
};
use nima_testing::real_time;

use super::{
    draw::{MARK, Painter},
    standalone::in_the_air,
    *,
};
use crate::emulators::{EmulatedFault, EmulatorThread};

#[cfg(feature = "h264")]
mod rtsp;

type Feeding = FeedSnapshot<Arc<DecodedImage>>;

fn scene() -> Scene {
    Scene::load("bimanual").unwrap()
}

/// Small images, so that a busy machine keeps up.
fn small(k1: f64) -> Camera {
    let mut settings = usual(&scene());
    settings.k1 = k1;
    settings.focal_px *= 0.5;
    settings.size_px = settings.size_px.map(|side| side / 2);
    camera_of(&settings)
}

fn serve() -> EmulatorThread {
    serve_with(None)
}

fn serve_with(pipe: Option<std::path::PathBuf>) -> EmulatorThread {
    let emulated = EmulatedEndoscope {
        camera: small(usual(&scene()).k1),
        square_px: SQUARE_PX,
        pipe,
        ..EmulatedEndoscope::of(&scene(), 0)
    };
    emulated.with(&scene(), in_the_air(&scene())).serve().unwrap()
}

fn feed(serving: &EmulatorThread) -> EndoscopeFeed {
    EndoscopeFeed::start(serving.endpoint.parse().unwrap(), Some([640, 360]), || {}).unwrap()
}

fn until(feed: &EndoscopeFeed, what: &str, wanted: impl Fn(&Feeding) -> bool) -> Feeding {
    let begin = Instant::now();
    loop {
        let look = feed.look(Instant::now());
        if wanted(&look) {
            return look;
        }
        assert!(begin.elapsed() < Duration::from_secs(30), "not {what}: {:?} {:?}", look.standing, look.rate_hz);
        thread::sleep(Duration::from_millis(2));
    }
}

fn is_live(look: &Feeding) -> bool {
    look.standing == FrameHealth::Live
}

fn time_us(image: &DecodedImage) -> Option<u64> {
    time_code::read(SQUARE_PX, |x, y| image.rgba[4 * (image.size_px[0] * y + x) + 1])
}

/// Returns the middle of the mark at a tip, px.
fn mark_px(image: &DecodedImage) -> Option<Vector2<f64>> {
    let [width, _] = image.size_px;
    let is_mark = |pixel: &[u8]| pixel.iter().zip(MARK).all(|(is, was)| is.abs_diff(was) < 70);
    let marked = image.rgba.chunks_exact(4).enumerate().filter(|(_, pixel)| is_mark(&pixel[..3]));
    let places: Vec<_> =
        marked.map(|(at, _)| Vector2::new((at % width) as f64 + 0.5, (at / width) as f64 + 0.5)).collect();
    (places.len() > 20).then(|| places.iter().sum::<Vector2<f64>>() / places.len() as f64)
}

#[test]
fn a_tip_is_seen_where_the_camera_says_through_either_distortion() {
    let scene = scene();
    for k1 in [-0.3, 0.0, 0.3] {
        let mut settings = usual(&scene);
        settings.k1 = k1;
        let camera = camera_of(&settings);
        let mut painter = Painter::new(camera, &scene);
        let mut squares = 0.0;
        let mut count = 0.0;
        for number in 0..40 {
            let turn = 0.7 * f64::from(number);
            let far_m = 0.0012 * f64::from(number);
            let up_m = 0.004 + 0.008 * turn.sin();
            let tip_m = Vector3::new(far_m * turn.cos(), 0.7 * far_m * turn.sin(), up_m);
            let expected_px = camera.project(&tip_m).unwrap();
            let inside =
                expected_px.x > 10.0 && expected_px.x < 1270.0 && expected_px.y > 10.0 && expected_px.y < 710.0;
            let rgb = painter.draw(&[EndoscopeInstrument { tip_m, trocar_m: scene.trocar_m }]);
            let image = jpeg::decode(&jpeg::encode(rgb, [1280, 720], 85)).unwrap();
            if let Some(seen_px) = mark_px(&image).filter(|_| inside) {
                squares += (seen_px - expected_px).norm_squared();
                count += 1.0;
            }
        }
        let rms_px = f64::sqrt(squares / count);
        assert!(count > 30.0 && rms_px < 2.0, "k1 {k1}: {rms_px} px over {count} pictures");
    }
}

#[test]
fn its_picture_arrives_with_the_time_at_which_it_was_made() {
    let now_us = || SystemTime::now().duration_since(UNIX_EPOCH).unwrap().as_micros() as u64;
    // Its first image is rendered before a client connects.
    let begin_us = now_us();
    let serving = serve();
    let feed = feed(&serving);
    let mut last_us = 0;
    for _ in 0..5 {
        let look = until(&feed, "another picture", |look| {
            look.image.as_ref().and_then(|(_, image)| time_us(image)).is_some_and(|time_us| time_us > last_us)
        });
        last_us = look.image.and_then(|(_, image)| time_us(&image)).unwrap();
        assert!((begin_us..=now_us()).contains(&last_us), "{begin_us} {last_us}");
    }
}

/// Visible effect of a fault.
type Sign = fn(&FrameHealth) -> bool;

/// Switches every fault on and off; `own` has the effects of those that look different with this kind of source.
fn every_fault_is_told(serving: &EmulatorThread, feed: &EndoscopeFeed, own: impl Fn(EmulatedFault) -> Option<Sign>) {
    for fault in EmulatedFault::every() {
        let sign: Sign = match fault {
            EmulatedFault::Freeze => |standing| matches!(standing, FrameHealth::Wrong(FrameFault::Frozen(_))),
            EmulatedFault::Black => |standing| *standing == FrameHealth::Wrong(FrameFault::Black),
            EmulatedFault::WrongSize => {
                |standing| *standing == FrameHealth::Wrong(FrameFault::Size([320, 180], [640, 360]))
            }
            EmulatedFault::Disconnect => {
                |standing| matches!(standing, FrameHealth::Lost(EndoscopeError::NobodyListens { .. }))
            }
            EmulatedFault::Silence => |standing| matches!(standing, FrameHealth::Lost(EndoscopeError::Silent { .. })),
            EmulatedFault::Late => {
                |standing| matches!(standing, FrameHealth::Wrong(FrameFault::Late(late)) if late.as_millis() > 300)
            }
            fault => match own(fault) {
                Some(sign) => sign,
                // These faults occasionally remove an image, or do not apply to a camera.
                None => continue,
            },
        };
        until(feed, "live", is_live);
        serving.faults.set(fault);
        until(feed, fault.name(), |look| sign(&look.standing));
        serving.faults.set(EmulatedFault::None);
    }
}

#[test]
fn every_fault_is_told_by_its_name_and_forgotten_when_it_has_gone() {
    let serving = serve();
    let feed = feed(&serving);
    every_fault_is_told(&serving, &feed, |fault| match fault {
        EmulatedFault::Torn => Some(|standing| *standing == FrameHealth::Wrong(FrameFault::Damaged(Damage::Torn))),
        EmulatedFault::OtherFormat => Some(
            |standing| matches!(standing, FrameHealth::Lost(EndoscopeError::OtherFormat { found, .. }) if found == "image/png"),
        ),
        _ => None,
    });
    until(&feed, "live", is_live);
}

#[test]
fn frozen_is_told_in_time_and_a_cut_is_mended_within_a_second() {
    real_time::judged(|| {
        let _alone = real_time::alone();
        let serving = serve();
        let feed = feed(&serving);
        let is_live =
            |look: &FeedSnapshot<Arc<DecodedImage>>| look.standing == FrameHealth::Live && look.rate_hz > 25.0;
        until(&feed, "live", is_live);
        serving.faults.set(EmulatedFault::Freeze);
        let begin = Instant::now();
        until(&feed, "frozen", |look| matches!(look.standing, FrameHealth::Wrong(FrameFault::Frozen(_))));
        // Plus one period, during which the last fresh image was in transit.
        assert!(begin.elapsed() <= FROZEN + Duration::from_millis(40), "{:?}", begin.elapsed());
        serving.faults.set(EmulatedFault::Disconnect);
        until(&feed, "lost", |look| matches!(look.standing, FrameHealth::Lost(_)));
        thread::sleep(Duration::from_millis(300));
        serving.faults.set(EmulatedFault::None);
        let begin = Instant::now();
        until(&feed, "live", |look| look.standing == FrameHealth::Live);
        assert!(begin.elapsed() < Duration::from_secs(1), "{:?}", begin.elapsed());
    });
}

#[test]
fn two_lenses_see_a_tip_where_each_camera_says() {
    let camera = small(0.3);
    let baseline_m = Some(BASELINE_M);
    let emulated = EmulatedEndoscope { camera, baseline_m, square_px: 0, ..EmulatedEndoscope::of(&scene(), 0) };
    let trocar_m = scene().trocar_m;
    let tip_m = Vector3::new(0.01, 0.005, 0.01);
    let seen = render::ShotState::Instruments(vec![EndoscopeInstrument { tip_m, trocar_m }]);
    let mut studio = render::SceneRenderer::new(emulated, &render::ShotSubject::Scene(Box::new(scene())));
    let shot = studio.take(Duration::ZERO, &seen, EmulatedFault::None);
    assert_eq!(shot.size_px, [1280, 360]);
    for (number, camera) in [camera, camera.beside(BASELINE_M)].into_iter().enumerate() {
        let rows = shot.rgb.chunks_exact(3 * 1280).map(|row| &row[3 * 640 * number..][..3 * 640]);
        let rgba = rows.flat_map(|row| row.chunks_exact(3).flat_map(|rgb| [rgb[0], rgb[1], rgb[2], 255])).collect();
        let seen_px = mark_px(&DecodedImage { size_px: [640, 360], rgba }).unwrap();
        assert!((seen_px - camera.project(&tip_m).unwrap()).norm() < 2.0, "{number}: {seen_px}");
    }
}

#[test]
fn pictures_are_written_for_who_reads_raw_ones() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("stream.mjpeg");
    let _serving = serve_with(Some(path.clone()));
    let is_there = |path: &std::path::Path| std::fs::metadata(path).map_or(0, |about| about.len()) > 100_000;
    let begin = Instant::now();
    while !is_there(&path) {
        assert!(begin.elapsed() < Duration::from_secs(30));
        thread::sleep(Duration::from_millis(10));
    }
    let feed = EndoscopeFeed::start(path.to_str().unwrap().parse().unwrap(), None, || {}).unwrap();
    until(&feed, "a time code", |look| look.image.as_ref().is_some_and(|(_, image)| time_us(image).is_some()));
}

#[cfg(not(feature = "h264"))]
#[test]
fn without_its_feature_rtsp_and_a_raw_stream_are_refused_in_words() {
    let serving = serve();
    let mut stream = std::net::TcpStream::connect(&serving.endpoint[7..serving.endpoint.len() - 1]).unwrap();
    let request = "DESCRIBE rtsp://127.0.0.1/stream RTSP/1.0\r\nCSeq: 1\r\n\r\n";
    std::io::Write::write_all(&mut stream, request.as_bytes()).unwrap();
    let mut answer = [0; 24];
    std::io::Read::read_exact(&mut stream, &mut answer).unwrap();
    assert!(answer.starts_with(b"RTSP/1.0 501 Not"), "{}", String::from_utf8_lossy(&answer));
    let settings = super::super::EmulatorSettings::new(&["pipe=/tmp/a.h264".to_owned()]).unwrap();
    let report = standalone::endoscope(&settings).err().unwrap().to_string();
    assert!(report.contains("--features h264"), "{report}");
}

#[test]
fn a_board_is_held_before_the_lens_whole_at_every_pose() {
    let lens = small(-0.3).lens;
    let board = nima_endoscope::Checkerboard::new([9, 6], 0.01).unwrap();
    let mut hands = held(board, &lens);
    let mut places = Vec::new();
    for pose in 0..20 {
        let [early, late] = [0.1, 1.7].map(|more| hands(2.2 * f64::from(pose) + more));
        assert_eq!(early, late, "it is held still");
        for place_m in board.places_m() {
            let place_px = lens.project(&(early * nalgebra::Point3::from(place_m)).coords).unwrap();
            assert!((0.0..640.0).contains(&place_px.x) && (0.0..360.0).contains(&place_px.y), "{pose}: {place_px}");
            places.push(place_px);
        }
    }
    let far =
        |from: [f64; 2]| places.iter().map(|place| (place - Vector2::from(from)).norm()).fold(f64::INFINITY, f64::min);
    for side in [[0.0, 180.0], [640.0, 180.0], [320.0, 0.0], [320.0, 360.0]] {
        assert!(far(side) < 100.0, "{side:?}: {}", far(side));
    }
    let serving = EmulatedEndoscope { camera: small(-0.3), ..EmulatedEndoscope::of(&scene(), 0) }
        .with_board(board, hands)
        .serve()
        .unwrap();
    let feed = feed(&serving);
    let look = until(&feed, "a board", |look| look.standing == FrameHealth::Live && look.image.is_some());
    let rgba = look.image.unwrap().1.rgba.clone();
    let fraction =
        |wanted: fn(u8) -> bool| rgba.iter().step_by(4).filter(|grey| wanted(**grey)).count() as f64 / (640.0 * 360.0);
    assert!(fraction(|grey| grey > 190) > 0.04 && fraction(|grey| grey < 60) > 0.04, "white and black squares");
}

#[test]
fn a_wrong_page_and_a_wrong_setting_are_told() {
    let serving = serve();
    let address = format!("{}nothing", serving.endpoint).parse().unwrap();
    let feed = EndoscopeFeed::start(address, None, || {}).unwrap();
    until(&feed, "404", |look| matches!(look.standing, FrameHealth::Lost(EndoscopeError::Refused { status: 404, .. })));
    for (setting, word) in [
        ("k1=9", "-2 to 2"),
        ("width=9", "64 to 4096"),
        ("rate_hz=0", "1 to 120"),
        ("scene=none", "none"),
        ("baseline_m=1", "0.0005 to 0.05"),
        ("board=9x7", "upside down"),
    ] {
        let settings = super::super::EmulatorSettings::new(&[setting.to_owned()]).unwrap();
        let report = standalone::endoscope(&settings).err().unwrap().to_string();
        assert!(report.contains(word), "{setting}: {report}");
    }
}

#[test]
#[ignore = "figures of docs/results/endoscope.md: 20 s, alone; a 1280 x 720 picture 30 times a second"]
fn figures_of_a_picture_on_its_way() {
    let serving = EmulatedEndoscope::of(&scene(), 0).with(&scene(), in_the_air(&scene())).serve().unwrap();
    let feed = EndoscopeFeed::start(serving.endpoint.parse().unwrap(), Some([1280, 720]), || {}).unwrap();
    let now_us = || SystemTime::now().duration_since(UNIX_EPOCH).unwrap().as_micros() as u64;
    until(&feed, "live", |look| look.standing == FrameHealth::Live && look.rate_hz > 25.0);
    let begin = Instant::now();
    let mut last = 0;
    let mut work_ms = Vec::new();
    let mut whole_ms = Vec::new();
    while begin.elapsed() < Duration::from_secs(20) {
        let look = feed.look(Instant::now());
        if let Some((number, image)) = look.image.filter(|(number, _)| *number != last) {
            last = number;
            work_ms.push(look.work.as_secs_f64() * 1e3);
            whole_ms.extend(time_us(&image).map(|made_us| (now_us() - made_us) as f64 * 1e-3));
        }
        thread::sleep(Duration::from_micros(500));
    }
    for (what, values) in
        [("from the complete frame to its delivery", &mut work_ms), ("from rendering to delivery", &mut whole_ms)]
    {
        values.sort_by(f64::total_cmp);
        let at = |fraction: f64| values[((values.len() - 1) as f64 * fraction) as usize];
        println!(
            "{what}: {} pictures, p50 {:.1} ms, p99 {:.1} ms, max {:.1} ms",
            values.len(),
            at(0.5),
            at(0.99),
            at(1.0)
        );
    }
    assert!(work_ms.len() > 300, "{} pictures in 20 s", work_ms.len());
}
