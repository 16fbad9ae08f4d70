//! Tests of the gravity wizard from its first to its last step by accessible names, with good and bad data.

use std::{
    path::Path,
    time::{Duration, Instant},
};

use egui::accesskit::Role;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use nima_machine::{config::RigConfig, messages::ForceSource, rig::Prompt};
use nima_panels::tiles::PanelId;
use nima_simulation::{
    SimulationPlan,
    scene::{Flaw, Scene},
};

use crate::{
    bench::{Console, TIMEOUT, WIZARD_SPEED, can_press, pick, shown_at, shows, texts, wait, write_into},
    image, language,
};

fn console(scene: Scene, store: &Path) -> Console {
    console_of_size(scene, store, [1600.0, 1000.0])
}

fn console_of_size(scene: Scene, store: &Path, size: [f32; 2]) -> Console {
    let rig = RigConfig::load("simulated").unwrap();
    let store = store.to_owned();
    let plan = SimulationPlan { rig, scene, calibrations: Default::default(), engage: false };
    shown_at(WIZARD_SPEED, &plan, size, move |app| app.with_store(&store))
}

fn gravity_scene(flaw: Option<Flaw>) -> Scene {
    let mut scene = Scene::load("gravity").unwrap();
    scene.person.as_mut().unwrap().flaw = flaw;
    scene
}

/// Continues from the checks to the poses. On a busy computer a check may fail again for longer than a click waits.
fn leave_the_checks(console: &mut Console) {
    let began = Instant::now();
    while !shows(console, "Step 2 of 5") {
        assert!(began.elapsed() < TIMEOUT, "never left: the checks; there is: {:?}", texts(console));
        if shows(console, "Step 1 of 5") && can_press(console, "Next") {
            console.get_by_role_and_label(Role::Button, "Next").click_accesskit();
            console.step();
        }
        std::thread::sleep(Duration::from_millis(5));
        console.step();
    }
}

fn files(folder: &Path) -> usize {
    std::fs::read_dir(folder).map_or(0, Iterator::count)
}

/// The view wizard has this little room next to the endoscope image.
#[test]
fn a_wizard_in_a_narrow_window_is_not_cut_off() {
    let folder = tempfile::tempdir().unwrap();
    let width = 940.0;
    let mut console = console_of_size(gravity_scene(None), folder.path(), [width, 1000.0]);
    console.state_mut().settings_mut().layout.front.insert(0, PanelId::Calibrations);
    pick(&mut console, "Calibrate gravity…");
    wait(&mut console, "the checks", |c| shows(c, "Step 1 of 5"));
    leave_the_checks(&mut console);
    let drawing = console.get_by_label("Drawing of the required pose").rect();
    assert!(drawing.right() <= width, "the drawing ends at {}", drawing.right());
}

#[test]
fn a_technician_walks_from_an_uncalibrated_wrist_to_a_force_that_is_known() {
    let folder = tempfile::tempdir().unwrap();
    let mut console = console(Scene::load("palpation").unwrap(), folder.path());
    wait(&mut console, "an unknown force", |c| shows(c, "the wrist sensor is not calibrated"));
    pick(&mut console, "Calibrate gravity…");
    wait(&mut console, "the first step", |c| shows(c, "release it: nothing may touch the tool"));
    assert!(!can_press(&console, "Engage"), "an arm that is being guided by hand cannot be engaged");
    language::fits(&mut console, "checks before the poses");
    leave_the_checks(&mut console);
    wait(&mut console, "some poses", |c| shows(c, "4 of 12 recorded"));
    language::fits(&mut console, "poses");
    // Going back or closing does not lose good data.
    pick(&mut console, "Back");
    pick(&mut console, "Back to the monitor");
    wait(&mut console, "the monitor", |c| shows(c, "Calibrate gravity…") && c.state().tick().is_some());
    pick(&mut console, "Calibrate gravity…");
    leave_the_checks(&mut console);
    assert!(!shows(&console, "0 of 12 recorded"), "the poses were lost");
    wait(&mut console, "all poses", |c| shows(c, "12 of 12 recorded"));
    assert!(!shows(&console, "touched the tool"), "nobody did");
    pick(&mut console, "Next");
    wait(&mut console, "a verdict", |c| shows(c, "Accepted"));
    assert!(shows(&console, "Paper") && shows(&console, "Physical"), "the models side by side");
    language::fits(&mut console, "result");
    image::same(&mut console, "wizard-gravity-result");
    pick(&mut console, "Next");
    wait(&mut console, "the proof", |c| shows(c, "Passed: free motion reads near zero"));
    language::fits(&mut console, "free motion");
    pick(&mut console, "Next");
    language::fits(&mut console, "save");
    image::same(&mut console, "wizard-gravity-save");
    pick(&mut console, "Save and use");
    wait(&mut console, "saved", |c| shows(c, "Saved and in use"));
    assert_eq!(files(folder.path()), 1);
    pick(&mut console, "Back to the monitor");
    wait(&mut console, "a known force", |c| {
        c.state().tick().is_some_and(|tick| tick.force.source == ForceSource::Wrist && tick.t_s > 0.1)
    });
    assert!(shows(&console, "held-out error"), "the active calibration is on the monitor");
}

#[test]
fn a_hand_on_the_tool_is_told_and_cannot_be_saved_without_a_name() {
    let folder = tempfile::tempdir().unwrap();
    let mut console = console(gravity_scene(Some(Flaw::Touches)), folder.path());
    pick(&mut console, "Calibrate gravity…");
    leave_the_checks(&mut console);
    // Either while the tool is touched, or afterwards.
    let report = ["something touches it", "something touches the tool", "Something touched the tool"];
    wait(&mut console, "the touch", |c| report.iter().any(|words| shows(c, words)));
    assert_eq!(files(folder.path()), 0);
    wait(&mut console, "the touch as it stays", |c| shows(c, report[2]));
    pick(&mut console, "Back");
    leave_the_checks(&mut console);
    console.step();
    assert!(shows(&console, report[2]), "forgotten by a step back");
}

#[test]
fn a_trembling_tool_never_gives_a_pose() {
    let folder = tempfile::tempdir().unwrap();
    let mut console = console(gravity_scene(Some(Flaw::Trembles)), folder.path());
    pick(&mut console, "Calibrate gravity…");
    leave_the_checks(&mut console);
    wait(&mut console, "the trembling", |c| shows(c, "hold the tool still"));
    let began = Instant::now();
    wait(&mut console, "five seconds", |_| began.elapsed() > Duration::from_secs(5));
    assert!(shows(&console, "0 of 12 recorded"));
    assert!(!can_press(&console, "Next"), "too few poses lead nowhere");
}

#[test]
fn a_wrong_sign_is_named_and_an_override_is_written_into_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let mut scene = gravity_scene(None);
    scene.wrist.as_mut().unwrap().imu.as_mut().unwrap().reads_gravity = true;
    let mut console = console(scene, folder.path());
    pick(&mut console, "Calibrate gravity…");
    leave_the_checks(&mut console);
    wait(&mut console, "enough poses", |c| shows(c, "8 of 12 recorded"));
    pick(&mut console, "Next");
    wait(&mut console, "the verdict", |c| shows(c, "Poor data") && shows(c, "sign"));
    // The switch fixes this without a new pose, and switching back restores it.
    for verdict in ["Accepted", "Poor data"] {
        pick(&mut console, "Back");
        pick(&mut console, "Back");
        let by_arm = console.query_all_by_label_contains("Take the orientation from the arm").next().unwrap();
        assert!(by_arm.accesskit_node().is_disabled(), "what is in the poses cannot be changed");
        console.query_all_by_label_contains("points down at rest").next().unwrap().click();
        console.run_steps(2);
        leave_the_checks(&mut console);
        pick(&mut console, "Next");
        wait(&mut console, verdict, |c| shows(c, verdict));
    }
    pick(&mut console, "Next");
    wait(&mut console, "a reading", |c| shows(c, "Not passed yet"));
    pick(&mut console, "Next");
    wait(&mut console, "the last step", |c| shows(c, "not proven"));
    assert!(!can_press(&console, "Save despite the verdict"), "a name and a reason come first");
    write_into(&mut console, "Your name", "Ada Lovelace");
    write_into(&mut console, "Reason", "bench test");
    pick(&mut console, "Save despite the verdict");
    wait(&mut console, "saved", |c| shows(c, "Saved and in use"));
    let path = std::fs::read_dir(folder.path()).unwrap().next().unwrap().unwrap().path();
    let text = std::fs::read_to_string(path).unwrap();
    assert!(text.contains("Ada Lovelace") && text.contains("bench test"), "{text}");
    wait(&mut console, "who kept it", |c| shows(c, "NOT PROVEN, accepted by Ada Lovelace"));
}

#[test]
fn a_noisy_sensor_is_told_with_its_figure_and_the_way_on_stays_shut() {
    let folder = tempfile::tempdir().unwrap();
    let mut scene = gravity_scene(None);
    scene.wrist.as_mut().unwrap().force_noise_n = 0.3;
    let mut console = console(scene, folder.path());
    pick(&mut console, "Calibrate gravity…");
    wait(&mut console, "the noise", |c| shows(c, "Force noise: 0.3") && shows(c, "check shield and earth"));
    wait(&mut console, "the good lines", |c| shows(c, "Rate: ") && shows(c, "of the loop's 1000 Hz, passed"));
    assert!(!can_press(&console, "Next"));
}

#[test]
fn a_sensor_without_an_accelerometer_uses_the_orientation_of_the_arm() {
    let folder = tempfile::tempdir().unwrap();
    let mut scene = gravity_scene(None);
    scene.wrist.as_mut().unwrap().imu = None;
    let mut console = console(scene, folder.path());
    pick(&mut console, "Calibrate gravity…");
    wait(&mut console, "the remedy", |c| shows(c, "use the arm's orientation"));
    assert!(!can_press(&console, "Next"));
    console.query_all_by_label_contains("Take the orientation from the arm, not").next().unwrap().click();
    console.step();
    console.step();
    leave_the_checks(&mut console);
    wait(&mut console, "a pose by the arm", |c| shows(c, "1 of 12 recorded"));
}

#[test]
fn the_left_arm_is_calibrated_by_itself_and_keeps_nothing_of_the_right_one() {
    let folder = tempfile::tempdir().unwrap();
    let mut console = console(gravity_scene(None).with_left_hand(), folder.path());
    wait(&mut console, "a tick", |c| c.state().tick().is_some());
    pick(&mut console, "Left arm");
    pick(&mut console, "Calibrate gravity…");
    wait(&mut console, "the left sensor", |c| shows(c, "Left: Sensor SIM-S1-0002"));
    leave_the_checks(&mut console);
    wait(&mut console, "a pose of the left arm", |c| shows(c, "1 of 12 recorded"));
    assert_eq!(
        console.state().tick().map(|tick| tick.guidance.prompt),
        Some(Prompt::Rest),
        "no request at the right arm"
    );
    pick(&mut console, "Right arm");
    wait(&mut console, "the first step again", |c| shows(c, "release it: nothing may touch the tool"));
    leave_the_checks(&mut console);
    assert!(shows(&console, "0 of 12 recorded"), "poses of the left arm");
    wait(&mut console, "a pose of the right arm", |c| shows(c, "1 of 12 recorded"));
}
