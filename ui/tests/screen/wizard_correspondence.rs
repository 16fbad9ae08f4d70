//! Tests of the correspondence wizard, operated by accessible names on a running loop, with a simulated person who
//! pushes.

use std::{
    path::Path,
    time::{Duration, Instant, SystemTime},
};

use egui_kittest::kittest::{NodeT as _, Queryable as _};
use nima_core::{
    calibration::{Verdict, correspondence::CorrespondenceRecord},
    frames::from_roll_pitch_yaw_deg,
};
use nima_machine::{
    config::RigConfig,
    rig::{Prompt, Side},
    teleop::Calibrations,
};
use nima_recording::store::Store;
use nima_simulation::{
    SimulationPlan,
    scene::{Flaw, Scene},
};
use nima_tests::gravity::gravity;

use crate::{
    bench::{Console, WIZARD_SPEED, can_press, pick, read, shown_at, write_into},
    image, language,
};

fn console(scene: Scene, store: &Path, calibrations: Calibrations) -> Console {
    let rig = RigConfig::load("simulated").unwrap();
    let plan = SimulationPlan { rig, scene, calibrations: [calibrations, Calibrations::default()], engage: false };
    let store = store.to_owned();
    shown_at(WIZARD_SPEED, &plan, [1600.0, 1500.0], move |app| app.with_store(&store))
}

fn saved(store: &Store) -> Option<CorrespondenceRecord> {
    let rig = RigConfig::load("simulated").unwrap();
    let wrist = rig.simulated_wrist(Side::Right).unwrap();
    store.load(&wrist.serial_number, &wrist.tool, SystemTime::now()).unwrap().map(|loaded| loaded.record)
}

#[test]
fn nine_pushes_as_asked_end_in_a_saved_correspondence_and_more_may_follow() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path());
    store.save(&gravity()).unwrap();
    let scene = Scene::load("correspondence").unwrap();
    let mut harness = console(Scene::load("peg_transfer").unwrap(), folder.path(), Calibrations::default());
    pick(&mut harness, "Calibrate correspondence…");
    pick(&mut harness, "Next");
    read(&mut harness, "Pushes: 2 recorded, at least 9 needed");
    pick(&mut harness, "Remove the last push");
    read(&mut harness, "Pushes: 1 recorded, at least 9 needed");
    assert!(!can_press(&harness, "Next"), "one push does not make a calibration");
    language::fits(&mut harness, "pushes");
    read(&mut harness, "recorded, at least 9 needed");
    pick(&mut harness, "Start over");
    pick(&mut harness, "Next");
    // Nothing that takes time follows: a tenth push would be on the picture.
    read(&mut harness, "Pushes: 9 recorded, at least 9 needed");
    pick(&mut harness, "Next");
    read(&mut harness, "Euler cross-check");
    read(&mut harness, "held out: MAE");
    harness.check_accessibility();
    language::fits(&mut harness, "result");
    image::same(&mut harness, "wizard-correspondence-result");
    pick(&mut harness, "Next");
    language::fits(&mut harness, "save");
    assert!(saved(&store).is_none(), "nothing is kept without being asked");
    pick(&mut harness, "Save and use");
    read(&mut harness, "Saved and in use");
    let record = saved(&store).unwrap();
    assert_eq!((record.judgement.verdict, record.judgement.override_by.as_deref()), (Verdict::Accepted, None));
    let sensor = scene.tissue_sensor.unwrap();
    let c_from_s2 = from_roll_pitch_yaw_deg(&sensor.world_from_c_deg).inverse()
        * from_roll_pitch_yaw_deg(&sensor.world_from_s2_deg);
    let off_deg = record.rotation().angle_to(&c_from_s2).to_degrees();
    assert!(off_deg < 0.5, "{off_deg} degrees off");
    let lines = harness.state().active().lines();
    assert!(lines.iter().any(|line| line.starts_with("Correspondence: 2") && line.contains("pushes")), "{lines:?}");
    // Saving restarted the loop and its clock: the pushes continue.
    pick(&mut harness, "Back");
    pick(&mut harness, "Back");
    read(&mut harness, &format!("Pushes: {} recorded, at least 9 needed", record.pairs + 1));
}

#[test]
fn without_gravity_no_push_is_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = console(Scene::load("peg_transfer").unwrap(), folder.path(), Calibrations::default());
    pick(&mut harness, "Calibrate correspondence…");
    read(&mut harness, "Gravity is not calibrated: calibrate it first");
    read(&mut harness, "Force under the tissue: passed");
    let from = Instant::now();
    while from.elapsed() < Duration::from_secs(1) {
        harness.step();
        assert!(!can_press(&harness, "Next"));
    }
    assert_eq!(harness.state().tick().map(|tick| tick.guidance.prompt), Some(Prompt::Rest));
}

#[test]
fn pushes_along_one_line_are_kept_only_under_a_name() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path());
    let record = gravity();
    store.save(&record).unwrap();
    let mut scene = Scene::load("correspondence").unwrap();
    scene.person.as_mut().unwrap().flaw = Some(Flaw::PushesOneLine);
    let mut harness =
        console(scene.clone(), folder.path(), Calibrations { gravity: Some(record.model), ..Calibrations::default() });
    pick(&mut harness, "Calibrate correspondence…");
    pick(&mut harness, "Next");
    pick(&mut harness, "Continue with less");
    read(&mut harness, "Insufficient motion");
    read(&mut harness, "along one line");
    pick(&mut harness, "Next");
    let button = "Save despite the verdict";
    assert!(!can_press(&harness, button) && harness.query_by_label("Save and use").is_none());
    for (label, text) in [("Your name", "A. Technician"), ("Reason", "practice")] {
        write_into(&mut harness, label, text);
    }
    pick(&mut harness, button);
    read(&mut harness, "Saved and in use");
    let record = saved(&store).unwrap();
    assert_eq!(record.judgement.verdict, Verdict::InsufficientMotion);
    assert_eq!(record.judgement.override_by.as_deref(), Some("A. Technician"));
    let lines = harness.state().active().lines();
    assert!(lines.iter().any(|line| line.contains("NOT PROVEN, accepted by A. Technician")), "{lines:?}");
}

#[test]
fn a_sensor_of_the_opposite_sign_is_named_and_the_switch_cures_it_without_new_pushes() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path());
    let record = gravity();
    store.save(&record).unwrap();
    let mut scene = Scene::load("correspondence").unwrap();
    scene.tissue_sensor.as_mut().unwrap().reads_tissue = true;
    let mut harness =
        console(scene.clone(), folder.path(), Calibrations { gravity: Some(record.model), ..Calibrations::default() });
    pick(&mut harness, "Calibrate correspondence…");
    pick(&mut harness, "Next");
    read(&mut harness, "Pushes: 9 recorded, at least 9 needed");
    pick(&mut harness, "Next");
    read(&mut harness, "opposite forces");
    pick(&mut harness, "Back");
    pick(&mut harness, "Back");
    let switch = |harness: &mut Console, words: &str| {
        harness.query_all_by_label_contains(words).next().unwrap().click();
        harness.step();
        harness.step();
    };
    let tracker = harness.query_all_by_label_contains("No tracker").next().unwrap();
    assert!(tracker.accesskit_node().is_disabled(), "what is in the pushes cannot be changed");
    switch(&mut harness, "reports the force on the tissue");
    pick(&mut harness, "Next");
    pick(&mut harness, "Next");
    read(&mut harness, "Accepted");
    pick(&mut harness, "Next");
    pick(&mut harness, "Save and use");
    read(&mut harness, "Saved and in use");
    let record = saved(&store).unwrap();
    assert!(record.flip_s2 && record.judgement.verdict == Verdict::Accepted, "{}", record.judgement.reason);
    pick(&mut harness, "Start over");
    switch(&mut harness, "No tracker");
    read(&mut harness, "Arm and tracker (not used): passed");
}
