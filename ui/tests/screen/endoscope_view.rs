//! Tests of the endoscope image in the Surgeon view, from an emulated camera over TCP, and of the text for each of its
//! faults.

use egui::{
    Event, Key, Modifiers, MouseWheelSource, MouseWheelUnit, PointerButton, Pos2, Rect, Shape, TouchPhase, pos2, vec2,
};
use egui_kittest::kittest::Queryable as _;
use nima_emulation::emulators::{
    EmulatedFault, EmulatorThread,
    endoscope::{EmulatedEndoscope, EndoscopeInstrument},
};
use nima_machine::{
    config::{EndoscopeConfig, StereoView},
    messages::LoopState,
};
use nima_panels::tiles::{PanelId, PanelLayout};
use nima_simulation::{
    SimulationPlan,
    camera::{camera_of, usual},
    scene::Scene,
};
use nima_tests::plan;

use crate::bench::{Console, TIMEOUT, comes, press, shown, until};

/// Small images, so that a busy machine keeps up.
pub(crate) fn camera() -> (EmulatorThread, EndoscopeConfig) {
    lenses(None)
}

/// Like [`camera`], with a second lens at this distance to the right of the first one, m.
pub(crate) fn lenses(baseline_m: Option<f64>) -> (EmulatorThread, EndoscopeConfig) {
    let scene = Scene::load("bimanual").unwrap();
    let mut camera = usual(&scene);
    camera.focal_px *= 0.5;
    camera.size_px = [640, 360];
    let emulated = EmulatedEndoscope { camera: camera_of(&camera), baseline_m, ..EmulatedEndoscope::of(&scene, 0) };
    let mut x_m = 0.0;
    let body = move |_: f64| {
        x_m = (x_m + 0.0005) % 0.03;
        vec![EndoscopeInstrument { tip_m: [x_m, 0.0, 0.01].into(), trocar_m: scene.trocar_m }]
    };
    let serving = emulated.with(&Scene::load("bimanual").unwrap(), Box::new(body)).serve().unwrap();
    let endoscope =
        EndoscopeConfig { url: serving.endpoint.clone(), camera: Some(camera), ..EndoscopeConfig::default() };
    (serving, endoscope)
}

pub(crate) fn surgeon(endoscope: EndoscopeConfig, size: [f32; 2]) -> Console {
    let mut plan = plan("bimanual");
    plan.rig.endoscope = Some(endoscope);
    let mut harness = shown(&SimulationPlan { engage: true, ..plan }, size, |app| app);
    harness.key_press(Key::F1);
    harness.step();
    until(&mut harness, "engaged", |tick| tick.state == LoopState::Engaged);
    harness
}

/// Waits until this text is reported and painted.
pub(crate) fn report(harness: &mut Console, words: &str) {
    let is_reported = comes(harness, TIMEOUT, |harness| {
        harness.query_by_label_contains(words).is_some() && (words.ends_with("live") || is_painted(harness, words))
    });
    assert!(is_reported, "never told: {words}");
}

pub(crate) fn is_painted(harness: &Console, words: &str) -> bool {
    fn is_in(shape: &Shape, words: &str) -> bool {
        match shape {
            Shape::Vec(shapes) => shapes.iter().any(|shape| is_in(shape, words)),
            Shape::Text(text) => text.galley.text().contains(words),
            _ => false,
        }
    }
    harness.output().shapes.iter().any(|clipped| is_in(&clipped.shape, words))
}

fn is_image(shape: &Shape) -> bool {
    matches!(shape, Shape::Mesh(mesh) if matches!(mesh.texture_id, egui::TextureId::Managed(id) if id > 0) && mesh.vertices.len() == 4)
}

fn has_image(harness: &Console) -> bool {
    harness.output().shapes.iter().any(|clipped| is_image(&clipped.shape))
}

#[test]
fn the_picture_is_shown_with_the_forces_in_it_and_each_of_its_faults_in_words() {
    let (serving, endoscope) = camera();
    let mut harness = surgeon(endoscope, [1280.0, 720.0]);
    report(&mut harness, "Endoscope image: live");
    assert!(comes(&mut harness, TIMEOUT, has_image));
    assert!(is_painted(&harness, "images per second") && is_painted(&harness, "Forces are drawn at the tips"));
    assert!(comes(&mut harness, TIMEOUT, |harness| is_painted(harness, "ceiling 4 N")));
    for (fault, words) in [
        (EmulatedFault::Freeze, "Image is frozen: no new image for"),
        (EmulatedFault::Black, "Image is black"),
        (EmulatedFault::Torn, "Image is damaged: its end is missing"),
        (EmulatedFault::Late, "ms old"),
        (EmulatedFault::WrongSize, "Image is 320 x 180 pixels, not 640 x 360"),
        (EmulatedFault::OtherFormat, "sends image/png, not motion JPEG"),
        (EmulatedFault::Disconnect, "Image is lost: no response from 127.0.0.1"),
    ] {
        serving.faults.set(fault);
        report(&mut harness, words);
        serving.faults.set(EmulatedFault::None);
        report(&mut harness, "Endoscope image: live");
    }
    // The loop kept running, because the image does not affect it.
    assert_eq!(harness.state().tick().unwrap().state, LoopState::Engaged);
}

#[test]
fn a_key_hides_the_forces() {
    let (_serving, endoscope) = camera();
    let mut harness = surgeon(endoscope, [1280.0, 720.0]);
    report(&mut harness, "Endoscope image: live");
    harness.key_press(Key::O);
    harness.step();
    harness.step();
    assert!(comes(&mut harness, TIMEOUT, |harness| is_painted(harness, "Forces are hidden; O draws them at the tips")));
}

/// Opacities of the letters of this text, wherever it is painted.
fn opacities(harness: &Console, words: &str) -> Vec<u8> {
    fn of(shape: &Shape, words: &str, found: &mut Vec<u8>) {
        match shape {
            Shape::Vec(shapes) => shapes.iter().for_each(|shape| of(shape, words, found)),
            Shape::Text(text) if text.galley.text().contains(words) => {
                let vertices = text.galley.rows.iter().flat_map(|row| &row.visuals.mesh.vertices);
                found.extend(vertices.map(|vertex| vertex.color.a()).max());
            }
            _ => {}
        }
    }
    let mut found = Vec::new();
    harness.output().shapes.iter().for_each(|clipped| of(&clipped.shape, words, &mut found));
    found
}

#[test]
fn the_forces_fade_where_the_check_of_the_camera_was_worse_than_ten_pixels() {
    let checked = |checked_px: Option<f64>| {
        let (serving, mut endoscope) = camera();
        endoscope.camera.as_mut().unwrap().checked_px = checked_px;
        let mut harness = surgeon(endoscope, [1280.0, 720.0]);
        report(&mut harness, "Endoscope image: live");
        (serving, harness)
    };
    let faint = |harness: &Console| opacities(harness, "ceiling 4 N").iter().filter(|max| **max < 128).count();
    // The image is half as wide as the one to which the limit of 10 px applies.
    let (_serving, mut good) = checked(Some(4.0));
    assert!(comes(&mut good, TIMEOUT, |harness| is_painted(harness, "Forces are drawn at the tips")));
    let (_serving, mut faded) = checked(Some(14.0));
    // The gauges next to the image show the same text.
    assert!(comes(&mut faded, TIMEOUT, |harness| {
        is_painted(harness, "14 px or more away from the tips") && faint(harness) > faint(&good)
    }));
}

#[test]
fn a_camera_whose_place_is_not_known_draws_no_forces_and_says_so() {
    let (_serving, mut endoscope) = camera();
    let camera = endoscope.camera.as_mut().unwrap();
    camera.position_m = None;
    camera.world_from_camera_deg = None;
    let mut harness = surgeon(endoscope, [1280.0, 720.0]);
    report(&mut harness, "Endoscope image: live");
    assert!(comes(&mut harness, TIMEOUT, |harness| is_painted(harness, "the camera position is unknown")));
    assert!(!is_painted(&harness, "O hides them"));
}

#[test]
fn a_key_chooses_the_half_of_two_lenses_and_the_forces_go_with_it() {
    let (_serving, endoscope) = lenses(Some(0.004));
    let view = Some(StereoView::Left);
    let mut harness = surgeon(EndoscopeConfig { view, baseline_m: Some(0.004), ..endoscope }, [1280.0, 720.0]);
    report(&mut harness, "Endoscope image: live");
    for (words, fractions) in [
        ("Left image", vec![[0.0, 0.5]]),
        ("Right image", vec![[0.5, 1.0]]),
        ("Both images", vec![[0.0, 0.5], [0.5, 1.0]]),
        ("Left image", vec![[0.0, 0.5]]),
    ] {
        let is_so = comes(&mut harness, TIMEOUT, |harness| {
            is_painted(harness, words) && halves(harness) == fractions && has_forces(harness, fractions.len() > 1)
        });
        assert!(is_so, "{words}: {:?}", halves(&harness));
        harness.key_press(Key::V);
        harness.step();
    }
}

/// Returns whether forces are drawn, in both halves of the view if `both`.
fn has_forces(harness: &Console, both: bool) -> bool {
    let mut places = Vec::new();
    for clipped in &harness.output().shapes {
        if let Shape::Text(text) = &clipped.shape
            && text.galley.text().contains("ceiling 4 N")
        {
            places.push(text.pos.x);
        }
    }
    let is_left = |x: &f32| *x < 640.0;
    if both { places.iter().any(is_left) && !places.iter().all(is_left) } else { !places.is_empty() }
}

/// Returns the start and end of the displayed parts of the image, as fractions of its width.
fn halves(harness: &Console) -> Vec<[f32; 2]> {
    let fractions = |shape: &Shape| match shape {
        Shape::Mesh(mesh) if is_image(shape) => Some([mesh.vertices[0].uv.x, mesh.vertices[3].uv.x]),
        _ => None,
    };
    harness.output().shapes.iter().filter_map(|clipped| fractions(&clipped.shape)).collect()
}

#[test]
fn a_camera_that_is_not_there_is_told_with_a_cure_there_and_among_the_devices() {
    let endoscope = |url: &str| EndoscopeConfig { url: url.to_owned(), ..EndoscopeConfig::default() };
    let mut harness = surgeon(endoscope("http://127.0.0.1:1/"), [1280.0, 720.0]);
    report(&mut harness, "Image is lost: no response from 127.0.0.1:1");
    assert!(is_painted(&harness, "Correct the port in the rig file"));
    harness.state_mut().settings_mut().layout = PanelLayout { front: vec![PanelId::Devices], ..PanelLayout::default() };
    press(&mut harness, "Technician");
    assert!(comes(&mut harness, TIMEOUT, |harness| is_painted(harness, "no response from 127.0.0.1:1")));
    for (url, words) in [
        ("rtmp://127.0.0.1/", "cameras (/dev/video0) and files are supported"),
        ("rtsp://127.0.0.1/", "Image is lost: this program was built without RTSP and H.264"),
        ("/dev/video987654", "Image is lost: /dev/video987654 does not exist"),
    ] {
        report(&mut surgeon(endoscope(url), [1280.0, 720.0]), words);
    }
}

#[test]
fn without_an_endoscope_the_field_is_drawn_as_ever() {
    let mut harness = shown(&plan("bimanual"), [1280.0, 720.0], |app| app);
    harness.key_press(Key::F1);
    harness.step();
    harness.step();
    assert!(harness.query_by_label_contains("Endoscope image").is_none());
    harness.get_by_label("Operating field");
}

/// Returns the position of the image, including parts outside the view, and its displayed part.
fn image(harness: &Console) -> Option<(Rect, Rect)> {
    harness.output().shapes.iter().find_map(|clipped| match &clipped.shape {
        Shape::Mesh(mesh)
            if matches!(mesh.texture_id, egui::TextureId::Managed(id) if id > 0) && mesh.vertices.len() == 4 =>
        {
            let rect = |of: fn(&egui::epaint::Vertex) -> Pos2| {
                Rect::from_points(&mesh.vertices.iter().map(of).collect::<Vec<_>>())
            };
            Some((rect(|vertex| vertex.pos), rect(|vertex| vertex.uv)))
        }
        _ => None,
    })
}

fn place(harness: &Console) -> Rect {
    image(harness).unwrap().0
}

/// Turns the wheel at a position until the image rests.
fn wheel(harness: &mut Console, at: Pos2, turned: f32) {
    harness.event(Event::PointerMoved(at));
    harness.step();
    let unit = MouseWheelUnit::Point;
    let phase = TouchPhase::Move;
    let modifiers = Modifiers::NONE;
    harness.event(Event::MouseWheel {
        unit,
        delta: vec2(0.0, turned),
        phase,
        source: MouseWheelSource::Unknown,
        modifiers,
    });
    harness.run_steps(60);
}

fn button(harness: &mut Console, pos: Pos2, pressed: bool) {
    harness.event(Event::PointerButton { pos, button: PointerButton::Primary, pressed, modifiers: Modifiers::NONE });
    harness.step();
}

fn double_click(harness: &mut Console, at: Pos2) {
    harness.event(Event::PointerMoved(at));
    harness.step();
    for _ in 0..2 {
        button(harness, at, true);
        button(harness, at, false);
    }
    harness.run_steps(2);
}

#[test]
fn the_wheel_zooms_a_drag_moves_and_a_double_click_shows_all() {
    let (_serving, endoscope) = camera();
    let mut harness = surgeon(endoscope, [1280.0, 720.0]);
    report(&mut harness, "Endoscope image: live");
    assert!(comes(&mut harness, TIMEOUT, has_image));
    let whole = place(&harness);
    let at = whole.center() + vec2(60.0, 40.0);
    wheel(&mut harness, at, 250.0);
    let zoomed = place(&harness);
    let by = zoomed.width() / whole.width();
    assert!((by - 2.0).abs() < 0.1, "{whole:?} {zoomed:?}");
    let fraction = |rect: Rect| (at - rect.min) / rect.size();
    assert!((fraction(whole).y - fraction(zoomed).y).abs() < 0.01, "what is under the pointer stays there");
    assert!(comes(&mut harness, TIMEOUT, |harness| is_painted(harness, "Zoom 2.0")));

    button(&mut harness, at, true);
    for step in 1..=5 {
        harness.event(Event::PointerMoved(at + vec2(0.0, 10.0 * step as f32)));
        harness.step();
    }
    button(&mut harness, at + vec2(0.0, 50.0), false);
    let moved = place(&harness).min.y - zoomed.min.y;
    assert!((moved - 50.0).abs() < 12.0, "moved by {moved}");

    // Zoom away from the tips, which are then marked at the edge.
    wheel(&mut harness, whole.left_bottom() + vec2(4.0, -4.0), 800.0);
    assert!(comes(&mut harness, TIMEOUT, |harness| is_painted(harness, "Right tip")), "the tip is still to be found");
    assert!(place(&harness).width() < 8.1 * whole.width());

    double_click(&mut harness, at);
    assert!((place(&harness).width() - whole.width()).abs() < 1.0);
    assert!(!is_painted(&harness, "Zoom") && !is_painted(&harness, "Right tip"));
}

#[test]
fn edges_are_cut_off_by_the_rig_file_and_on_the_screen() {
    let (_serving, endoscope) = camera();
    let mut harness = surgeon(EndoscopeConfig { crop_px: [64, 0, 64, 0], ..endoscope }, [1280.0, 720.0]);
    report(&mut harness, "Endoscope image: live");
    assert!(comes(&mut harness, TIMEOUT, has_image));
    let (by_file, part) = image(&harness).unwrap();
    assert_eq!(part, Rect::from_min_max(pos2(0.1, 0.0), pos2(0.9, 1.0)));
    harness.state_mut().settings_mut().image.crop_percent = [0, 20, 25, 0];
    harness.run_steps(2);
    let (on_screen, part) = image(&harness).unwrap();
    assert_eq!(part, Rect::from_min_max(pos2(0.1, 0.2), pos2(0.75, 1.0)));
    // The cropped image is as large as possible, and not distorted.
    assert!((on_screen.height() - by_file.height()).abs() < 1.0);
    let proportions = on_screen.width() / on_screen.height();
    assert!((proportions - 640.0 * 0.65 / (360.0 * 0.8)).abs() < 0.01, "{proportions}");
}

#[test]
fn forces_of_now_are_called_so() {
    let (_serving, endoscope) = camera();
    let mut harness = surgeon(endoscope, [1280.0, 720.0]);
    report(&mut harness, "Endoscope image: live");
    harness.state_mut().settings_mut().image.forces_of_now = true;
    assert!(comes(&mut harness, TIMEOUT, |harness| is_painted(harness, "Current forces, ahead of the image")));
}
