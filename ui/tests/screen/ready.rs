//! Tests of the ready check on its page, operated by accessible names on the simulated rig.

use std::path::Path;

use nima_machine::{config::RigConfig, messages::LoopState, teleop::Calibrations};
use nima_recording::store::{PointOutcome, Store};
use nima_simulation::{SimulationPlan, scene::Scene};
use nima_tests::gravity::gravity;

use crate::bench::{Console, WIZARD_SPEED, can_press, pick, press, read, shown_at, shows, until};

fn console(store: &Path) -> Console {
    let record = gravity();
    Store::open(store).save(&record).unwrap();
    let calibrations =
        [Calibrations { gravity: Some(record.model), ..Calibrations::default() }, Calibrations::default()];
    let rig = RigConfig::load("simulated").unwrap();
    let scene = Scene::load("correspondence").unwrap();
    let store = store.to_owned();
    let plan = SimulationPlan { rig, scene, calibrations, engage: false };
    shown_at(WIZARD_SPEED, &plan, [1600.0, 1000.0], move |app| app.with_store(&store))
}

#[test]
fn the_list_is_gone_through_by_the_person_at_the_screen_and_the_one_at_the_arm() {
    let folder = tempfile::tempdir().unwrap();
    let mut console = console(&folder.path().join("calibrations"));
    until(&mut console, "a tick", |tick| tick.state == LoopState::Idle);
    pick(&mut console, "Set-up…");
    pick(&mut console, "Run Right arm, ready check");
    read(&mut console, "Checked by");
    read(&mut console, "not engaged. Not during the ready check");
    read(&mut console, "Devices present and steady: skipped, this rig is simulated");
    // The simulated person obeys the instructions at the arm; the stop is pressed here.
    read(&mut console, "Press Stop");
    assert!(shows(&console, "Right arm: direction of the force: "), "the push was made");
    assert!(!can_press(&console, "Engage"), "no engagement during the check");
    press(&mut console, "Stop");
    until(&mut console, "stopped", |tick| tick.state == LoopState::Stopped);
    press(&mut console, "Release stop");
    for watchdog in ["Watchdog of the loop", "Watchdog of the measurements", "Watchdog of the link"] {
        until(&mut console, watchdog, |tick| {
            matches!(tick.state, LoopState::Faulted(_)) && tick.rendering.rendered_n.norm() == 0.0
        });
        press(&mut console, "Release stop");
        read(&mut console, &format!("{watchdog}: 0."));
    }
    read(&mut console, "Ready: all checks passed");
    read(&mut console, "Saved in ");
    let record = Store::open(folder.path().join("calibrations")).last_check("Simulated rig").unwrap();
    assert!(record.passed && record.items.iter().all(|item| item.outcome != PointOutcome::Failed), "{record:?}");
    press(&mut console, "Continue to Engage");
    assert!(!shows(&console, "Checked by") && !shows(&console, "Back to the monitor"), "Engage is at the monitor");
}

#[test]
fn all_calibrations_stand_on_one_page_and_each_is_repeated_by_its_button() {
    let folder = tempfile::tempdir().unwrap();
    let mut console = console(&folder.path().join("calibrations"));
    until(&mut console, "a tick", |tick| tick.state == LoopState::Idle);
    pick(&mut console, "Set-up…");
    read(&mut console, "Sensor SIM-S1-0001, Simulated grasper");
    assert!(shows(&console, "Accepted, held-out error 0.0") && shows(&console, ", less than a day old"));
    assert!(shows(&console, "not calibrated"), "the correspondence is missing");
    // The result of the bias check appears without a click.
    read(&mut console, "N without contact, passed");
    assert!(shows(&console, "never run"), "the ready check");
    pick(&mut console, "Recalibrate Right arm, gravity");
    read(&mut console, "release it: nothing may touch the tool");
    pick(&mut console, "Back to the set-up");
    read(&mut console, "never run");
    pick(&mut console, "Run Right arm, ready check");
    read(&mut console, "Checked by");
    pick(&mut console, "Back to the set-up");
    read(&mut console, "never run");
    pick(&mut console, "Show Right arm, devices");
    read(&mut console, "This rig is simulated: it has no devices");
    assert!(!shows(&console, "never run"));
    pick(&mut console, "Calibrate gravity…");
    read(&mut console, "release it: nothing may touch the tool");
    pick(&mut console, "Back to the monitor");
    assert!(!shows(&console, "never run"), "a wizard of the panel returns to the panel");
}
