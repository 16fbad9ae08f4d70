//! The ready check on its page, walked by accessible names on the simulated rig.

use std::{path::Path, time::Instant};

use egui::accesskit::Role;
use egui_kittest::{
    Harness,
    kittest::{NodeT as _, Queryable as _},
};
use nima_console::console::ConsoleApp;
use nima_machine::{config::RigConfig, messages::LoopState, teleop::Calibrations};
use nima_recording::store::{Outcome, Store};
use nima_tests::gravity::gravity;
use nima_world::{Plan, scene::Scene};

use crate::bench::{TIMEOUT, WIZARD_SPEED, press, shown_at, until};

type Console = Harness<'static, ConsoleApp>;

fn console(store: &Path) -> Console {
    let record = gravity();
    Store::open(store).save(&record).unwrap();
    let calibrations =
        [Calibrations { gravity: Some(record.model), ..Calibrations::default() }, Calibrations::default()];
    let (rig, scene) = (RigConfig::load("simulated").unwrap(), Scene::load("correspondence").unwrap());
    let store = store.to_owned();
    let plan = Plan { rig, scene, calibrations, engage: false };
    shown_at(WIZARD_SPEED, &plan, [1600.0, 1000.0], move |app| app.with_store(&store))
}

fn shows(console: &Console, words: &str) -> bool {
    console.query_all_by_label_contains(words).next().is_some()
}

fn until_shown(console: &mut Console, words: &str) {
    let began = Instant::now();
    while !shows(console, words) {
        let all: Vec<_> =
            console.query_all_by_role(Role::Label).filter_map(|node| node.accesskit_node().value()).collect();
        assert!(began.elapsed() < TIMEOUT, "never came: {words}; there is: {all:?}");
        std::thread::sleep(std::time::Duration::from_millis(5));
        console.step();
    }
}

#[test]
fn the_list_is_gone_through_by_the_person_at_the_screen_and_the_one_at_the_arm() {
    let folder = tempfile::tempdir().unwrap();
    let mut console = console(&folder.path().join("calibrations"));
    until(&mut console, "a tick", |tick| tick.state == LoopState::Idle);
    press(&mut console, "Ready check…");
    until_shown(&mut console, "Who checks");
    until_shown(&mut console, "Devices present and steady: left out, this rig is simulated");
    // The simulated person obeys the instructions at the arm; the stop is pressed here.
    until_shown(&mut console, "Press the stop");
    assert!(shows(&console, "Right arm: direction of the force: "), "the push was made");
    let engage = console.query_by_role_and_label(Role::Button, "Engage");
    assert!(engage.is_none_or(|button| button.accesskit_node().is_disabled()), "nobody engages during the check");
    press(&mut console, "Stop");
    until(&mut console, "stopped", |tick| tick.state == LoopState::Stopped);
    press(&mut console, "Release stop");
    for watchdog in ["Watchdog over the loop", "Watchdog over the measurements", "Watchdog over the link"] {
        until(&mut console, watchdog, |tick| {
            matches!(tick.state, LoopState::Faulted(_)) && tick.rendered_n.norm() == 0.0
        });
        press(&mut console, "Release stop");
        until_shown(&mut console, &format!("{watchdog}: 0."));
    }
    until_shown(&mut console, "Ready: every point is in order");
    until_shown(&mut console, "Kept in ");
    let record = Store::open(folder.path().join("calibrations")).last_check("Simulated rig").unwrap();
    assert!(record.passed && record.items.iter().all(|item| item.outcome != Outcome::Failed), "{record:?}");
    press(&mut console, "Back to the monitor");
    assert!(!shows(&console, "Who checks"));
}

/// A button that may be scrolled out of sight.
fn pick(console: &mut Console, label: &str) {
    let began = Instant::now();
    let ready = |console: &Console| {
        console
            .query_by_role_and_label(Role::Button, label)
            .is_some_and(|button| !button.accesskit_node().is_disabled())
    };
    while !ready(console) {
        assert!(began.elapsed() < TIMEOUT, "no button \"{label}\" that can be pressed");
        std::thread::sleep(std::time::Duration::from_millis(5));
        console.step();
    }
    console.get_by_role_and_label(Role::Button, label).click_accesskit();
    console.step();
    console.step();
}

#[test]
fn all_calibrations_stand_on_one_page_and_each_is_repeated_by_its_button() {
    let folder = tempfile::tempdir().unwrap();
    let mut console = console(&folder.path().join("calibrations"));
    until(&mut console, "a tick", |tick| tick.state == LoopState::Idle);
    pick(&mut console, "All calibrations…");
    until_shown(&mut console, "Right arm: sensor SIM-S1-0001, Simulated grasper");
    assert!(shows(&console, "Accepted, held-out error 0.0") && shows(&console, ", less than a day old"));
    assert!(shows(&console, "not calibrated"), "the correspondence is missing");
    // What the check of the bias finds in the meantime comes without a click.
    until_shown(&mut console, "N without contact, good");
    pick(&mut console, "Redo Right arm, gravity");
    until_shown(&mut console, "let go of it: nothing may touch the tool");
    pick(&mut console, "All calibrations…");
    until_shown(&mut console, "Since then");
    pick(&mut console, "Back to the monitor");
    assert!(!shows(&console, "Since then"));
}
