//! The Camera wizard, driven by accessible names, with a board in front of an emulated endoscope.

use std::{
    path::Path,
    sync::{Arc, Mutex},
};

use nalgebra::Isometry3;
use nima_console::console::ConsoleOptions;
use nima_emulation::emulators::{
    EmulatorThread,
    endoscope::{BoardHands, EmulatedEndoscope, held},
};
use nima_endoscope::Checkerboard;
use nima_machine::config::{RigConfig, RigFile};
use nima_simulation::{
    SimulationPlan,
    camera::{camera_of, usual},
    scene::Scene,
};
use nima_tests::plan;
use nima_wizards::WizardKind;

use crate::{
    bench::{Console, can_press, pick, read, shown, shows, toured, until, wait},
    image, language,
};

/// A small image, so that a busy machine keeps up.
const SIZE_PX: [usize; 2] = [640, 360];

/// An emulated endoscope, the board in front of it, and the poses in which a person holds the board.
struct Fixture {
    _serving: EmulatorThread,
    pose: Arc<Mutex<Isometry3<f64>>>,
    poses: BoardHands,
    url: String,
}

const FOCAL_PX: f64 = 380.0;
const CENTRE_PX: [f64; 2] = [327.0, 174.0];

impl Fixture {
    fn new() -> Self {
        let scene = Scene::load("peg_transfer").unwrap();
        let mut settings = usual(&scene);
        settings.size_px = SIZE_PX;
        settings.focal_px = FOCAL_PX;
        settings.k1 = -0.25;
        settings.centre_px = Some(CENTRE_PX);
        let camera = camera_of(&settings);
        let board = Checkerboard::new([9, 6], 0.01).unwrap();
        let mut poses = held(board, &camera.lens);
        let pose = Arc::new(Mutex::new(poses(0.0)));
        let shown = Arc::clone(&pose);
        let emulated = EmulatedEndoscope { camera, quality: 90, ..EmulatedEndoscope::of(&scene, 0) };
        let serving = emulated.with_board(board, Box::new(move |_| *shown.lock().unwrap())).serve().unwrap();
        Self { url: serving.endpoint.clone(), _serving: serving, pose, poses }
    }

    /// Moves the board to another pose.
    fn hold(&mut self, number: u32) {
        *self.pose.lock().unwrap() = (self.poses)(2.2 * f64::from(number) + 0.5);
    }

    fn console(&self, folder: &Path, size: [f32; 2]) -> (Console, String) {
        let mut file = RigFile::of("simulated").unwrap();
        file.set("endoscope.url", self.url.as_str());
        let path = folder.join("theatre.toml");
        let rig = file.save(&path).unwrap();
        let name = path.display().to_string();
        // Not engaged: an instrument performing its task would be at a corner only by chance.
        let plan = SimulationPlan { rig, engage: false, ..plan("peg_transfer") };
        let kept = folder.to_path_buf();
        let running = name.clone();
        let console = shown(&plan, size, move |app| {
            let options = ConsoleOptions { wizard: Some(WizardKind::Camera), ..ConsoleOptions::default() };
            app.with_settings(toured(&kept)).with_rig_name(running).with_options(options)
        });
        (console, name)
    }
}

#[test]
fn a_technician_finds_the_lens_from_live_views_saves_it_and_undoes_it() {
    let folder = tempfile::tempdir().unwrap();
    let mut bench = Fixture::new();
    let (mut console, rig) = bench.console(folder.path(), [1280.0, 720.0]);
    until(&mut console, "any tick", |_| true);
    read(&mut console, "Image: passed");
    pick(&mut console, "Next");
    read(&mut console, "Hold the board straight in front of the lens");
    assert!(!can_press(&console, "Next"), "there are no views yet");
    for number in 0..18 {
        bench.hold(number);
        read(&mut console, &format!("{} captured;", number + 1));
    }
    read(&mut console, "All views captured");
    language::fits(&mut console, "views");
    pick(&mut console, "Remove the last view");
    read(&mut console, "18 captured;");
    pick(&mut console, "Next");
    read(&mut console, "Accepted: it predicts held-out views");
    language::fits(&mut console, "lens");
    image::same(&mut console, "wizard-camera-lens");
    pick(&mut console, "Next");
    // The board is at rest, but the tip does not move between corners, so no pose results.
    for touched in 0..4 {
        read(&mut console, "Touch the marked corner with the tip");
        pick(&mut console, "Tip is on the corner");
        read(&mut console, &format!("{} corners touched", touched + 1));
    }
    read(&mut console, "off the board");
    language::fits(&mut console, "place");
    assert!(!can_press(&console, "Next"));
    pick(&mut console, "Reposition the board");
    read(&mut console, "0 corners touched");
    pick(&mut console, "Continue with less");
    read(&mut console, "position unknown");
    language::fits(&mut console, "save");
    image::same(&mut console, "wizard-camera-save");
    assert!(
        RigConfig::load(&rig).unwrap().endoscope.unwrap().camera.is_none(),
        "nothing is changed before it is saved"
    );
    pick(&mut console, "Save and use");
    wait(&mut console, "saved", |console| shows(console, "Saved in "));
    let camera = RigConfig::load(&rig).unwrap().endoscope.unwrap().camera.unwrap();
    let [x, y] = camera.centre_px.unwrap();
    for (found, real) in [(camera.focal_px, FOCAL_PX), (x, CENTRE_PX[0]), (y, CENTRE_PX[1])] {
        assert!((found - real).abs() < 0.005 * FOCAL_PX, "{found} {real}");
    }
    assert_eq!((camera.size_px, camera.position_m), (SIZE_PX, None));
    pick(&mut console, "Restore previous values");
    read(&mut console, "The previous values are in the rig file again");
    assert!(RigConfig::load(&rig).unwrap().endoscope.unwrap().camera.is_none());
}

#[test]
fn without_a_picture_the_wizard_says_what_it_needs() {
    let folder = tempfile::tempdir().unwrap();
    let bench = Fixture { url: "http://127.0.0.1:1/".to_owned(), ..Fixture::new() };
    let (mut console, _) = bench.console(folder.path(), [1280.0, 720.0]);
    until(&mut console, "any tick", |_| true);
    read(&mut console, "no image received");
    assert!(!can_press(&console, "Next"));
}
