//! The endoscope's picture in the surgeon's view, from an emulated camera over TCP, and each of its faults in words.

use egui::{Key, Shape};
use egui_kittest::kittest::Queryable as _;
use nima_console::console::desk::{Layout, Panel};
use nima_machine::{config::Endoscope, messages::LoopState};
use nima_tests::plan;
use nima_world::{
    Plan,
    emulators::{
        EmulatedFault, Serving,
        endoscope::{Emulated, Instrument, camera_of, usual},
    },
    scene::Scene,
};

use crate::bench::{Console, TIMEOUT, comes, press, shown, until};

/// Small pictures, so that a busy machine keeps up.
fn camera() -> (Serving, Endoscope) {
    let scene = Scene::load("bimanual").unwrap();
    let mut camera = usual(&scene);
    camera.focal_px *= 0.5;
    camera.size_px = [640, 360];
    let emulated = Emulated { camera: camera_of(&camera), ..Emulated::of(&scene, 0) };
    let mut x_m = 0.0;
    let body = move |_: f64| {
        x_m = (x_m + 0.0005) % 0.03;
        vec![Instrument { tip_m: [x_m, 0.0, 0.01].into(), trocar_m: scene.trocar_m }]
    };
    let serving = emulated.with(&Scene::load("bimanual").unwrap(), Box::new(body)).serve().unwrap();
    let endoscope = Endoscope { url: serving.endpoint.clone(), camera: Some(camera), ..Endoscope::default() };
    (serving, endoscope)
}

fn surgeon(endoscope: Endoscope, size: [f32; 2]) -> Console {
    let mut plan = plan("bimanual");
    plan.rig.endoscope = Some(endoscope);
    let mut harness = shown(&Plan { engage: true, ..plan }, size, |app| app);
    harness.key_press(Key::F1);
    harness.step();
    until(&mut harness, "engaged", |tick| tick.state == LoopState::Engaged);
    harness
}

/// Waits until the picture is told so, and painted so.
fn told(harness: &mut Console, words: &str) {
    let is_told = comes(harness, TIMEOUT, |harness| {
        harness.query_by_label_contains(words).is_some() && (words.ends_with("live") || is_painted(harness, words))
    });
    assert!(is_told, "never told: {words}");
}

fn is_painted(harness: &Console, words: &str) -> bool {
    fn is_in(shape: &Shape, words: &str) -> bool {
        match shape {
            Shape::Vec(shapes) => shapes.iter().any(|shape| is_in(shape, words)),
            Shape::Text(text) => text.galley.text().contains(words),
            _ => false,
        }
    }
    harness.output().shapes.iter().any(|clipped| is_in(&clipped.shape, words))
}

fn has_picture(harness: &Console) -> bool {
    let is_picture = |shape: &Shape| matches!(shape, Shape::Mesh(mesh) if matches!(mesh.texture_id, egui::TextureId::Managed(id) if id > 0) && mesh.vertices.len() == 4);
    harness.output().shapes.iter().any(|clipped| is_picture(&clipped.shape))
}

#[test]
fn the_picture_is_shown_with_the_forces_in_it_and_each_of_its_faults_in_words() {
    let (serving, endoscope) = camera();
    let mut harness = surgeon(endoscope, [1280.0, 720.0]);
    told(&mut harness, "Endoscope's picture: live");
    assert!(comes(&mut harness, TIMEOUT, has_picture));
    assert!(is_painted(&harness, "pictures a second") && is_painted(&harness, "Forces are drawn at the tips"));
    assert!(comes(&mut harness, TIMEOUT, |harness| is_painted(harness, "ceiling 4 N")));
    for (fault, words) in [
        (EmulatedFault::Freeze, "Picture is frozen: nothing new for"),
        (EmulatedFault::Black, "Picture is black"),
        (EmulatedFault::Torn, "Picture is damaged: its end is missing"),
        (EmulatedFault::Late, "ms old"),
        (EmulatedFault::WrongSize, "Picture is 320 x 180 pixels, not 640 x 360"),
        (EmulatedFault::OtherFormat, "sends image/png, not motion JPEG"),
        (EmulatedFault::Disconnect, "Picture is lost: nobody listens at 127.0.0.1"),
    ] {
        serving.faults.set(fault);
        told(&mut harness, words);
        serving.faults.set(EmulatedFault::None);
        told(&mut harness, "Endoscope's picture: live");
    }
    // The loop went on: nothing of the picture concerns it.
    assert_eq!(harness.state().tick().unwrap().state, LoopState::Engaged);
}

#[test]
fn a_key_hides_the_forces() {
    let (_serving, endoscope) = camera();
    let mut harness = surgeon(endoscope, [1280.0, 720.0]);
    told(&mut harness, "Endoscope's picture: live");
    harness.key_press(Key::O);
    harness.step();
    harness.step();
    assert!(comes(&mut harness, TIMEOUT, |harness| is_painted(harness, "O draws the forces at the tips")));
}

#[test]
fn a_camera_that_is_not_there_is_told_with_a_cure_there_and_among_the_devices() {
    let endoscope = |url: &str| Endoscope { url: url.to_owned(), ..Endoscope::default() };
    let mut harness = surgeon(endoscope("http://127.0.0.1:1/"), [1280.0, 720.0]);
    told(&mut harness, "Picture is lost: nobody listens at 127.0.0.1:1");
    assert!(is_painted(&harness, "Correct the port in the rig file"));
    harness.state_mut().settings_mut().layout = Layout { front: vec![Panel::Devices], ..Layout::default() };
    press(&mut harness, "Technician");
    assert!(comes(&mut harness, TIMEOUT, |harness| is_painted(harness, "nobody listens at 127.0.0.1:1")));
    let mut harness = surgeon(endoscope("rtsp://127.0.0.1/"), [1280.0, 720.0]);
    told(&mut harness, "only http:// and files are supported");
}

#[test]
fn without_an_endoscope_the_field_is_drawn_as_ever() {
    let mut harness = shown(&plan("bimanual"), [1280.0, 720.0], |app| app);
    harness.key_press(Key::F1);
    harness.step();
    harness.step();
    assert!(harness.query_by_label_contains("Endoscope's picture").is_none());
    harness.get_by_label("Operating field");
}
