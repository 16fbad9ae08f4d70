//! The Devices panel on an emulated rig: identification of devices, their test, and other devices for a part.
#![cfg(target_os = "linux")]

use std::{path::Path, time::Duration};

use egui::accesskit::Role;
use egui_kittest::{
    Harness,
    kittest::{NodeT as _, Queryable as _},
};
use nima_console::console::ConsoleApp;
use nima_machine::{
    config::{RigConfig, RigFile},
    messages::LoopState,
    rig::{RigSettings, Side},
};
use nima_panels::tiles::{PanelId, PanelLayout};
use nima_simulation::start_simulated;
use nima_testing::real_time::{alone, judged};
use nima_tests::{
    emulated::{elsewhere, rig_file},
    plan,
};

use crate::bench::{comes, press, toured, until};

const SIZE: [f32; 2] = [1600.0, 1000.0];
/// Far longer than emulators and devices need to start; a slower machine is too busy.
const WITHIN: Duration = Duration::from_secs(40);
const NIMA: &str = env!("CARGO_BIN_EXE_nima");

/// Returns a console with the Devices panel in front, on the simulated rig; its data folder is `folder`.
fn console(folder: &Path) -> Harness<'static, ConsoleApp> {
    let folder = folder.to_path_buf();
    let plan = plan("peg_transfer");
    let handle = start_simulated(&plan, 1.0).unwrap();
    // The loop of an emulated rig runs in real time, like its devices.
    let mut harness = Harness::builder().with_size(SIZE).with_step_dt(1.0 / 30.0).build_eframe(move |cc| {
        let mut kept = toured(&folder);
        kept.now.layout = PanelLayout { front: vec![PanelId::Devices], ..PanelLayout::default() };
        let app = ConsoleApp::new(cc, handle, plan.rig, plan.scene);
        app.with_settings(kept).with_store(&folder).with_program(Path::new(NIMA))
    });
    until(&mut harness, "any tick", |_| true);
    harness
}

/// Returns the emulated rig at its own addresses, as a file in the user's folder, is started from the start page.
fn on_emulated_rig(folder: &Path) -> (Harness<'static, ConsoleApp>, RigFile) {
    let mut file = rig_file(&elsewhere(folder));
    file.set("name", "Bench rig");
    // Emulated handles report which hand they are for, like real ones, so a swap must be explicit.
    file.set("devices.right.handle.hand", "right");
    file.set("devices.left.handle.hand", "left");
    file.save(&folder.join("rigs/bench.toml")).unwrap();
    let mut harness = console(folder);
    press(&mut harness, "Rig");
    press(&mut harness, "Bench rig");
    press(&mut harness, "Start");
    wait(&mut harness, "the rig runs", |harness| harness.state().rig().name == "Bench rig");
    wait(&mut harness, "all are connected", |harness| {
        harness.query_all_by_label_contains("readings per second").count() == 11
    });
    (harness, file)
}

/// Returns the texts of the device rows.
fn report(harness: &Harness<'_, ConsoleApp>) -> Vec<String> {
    let rows = harness.query_all_by_label_contains("per second").chain(harness.query_all_by_label_contains("connect"));
    rows.filter_map(|row| row.accesskit_node().value()).collect()
}

/// Returns the number of tested devices.
fn verdicts(harness: &Harness<'_, ConsoleApp>) -> usize {
    ["Test passed", "Test found a problem"].iter().map(|verdict| harness.query_all_by_label(verdict).count()).sum()
}

fn wait(harness: &mut Harness<'_, ConsoleApp>, what: &str, good: impl Fn(&Harness<'_, ConsoleApp>) -> bool) {
    assert!(comes(harness, WITHIN, good), "never: {what}; {:?}", report(harness));
}

fn state(harness: &Harness<'_, ConsoleApp>) -> Option<LoopState> {
    harness.state().tick().map(|tick| tick.state)
}

fn serials(rig: &RigConfig) -> [Option<u16>; 2] {
    let devices = rig.devices.as_ref().unwrap();
    Side::ALL.map(|side| devices.arm(side).unwrap().handle.force_dimension().unwrap().serial)
}

fn saved(path: &Path) -> RigSettings {
    RigConfig::load(path.to_str().unwrap()).unwrap().devices.unwrap()
}

#[test]
#[ignore = "an emulated rig in real time: `./dev test` runs it alone"]
fn another_handle_is_chosen_by_its_serial_number_and_sensors_are_exchanged_by_one_click() {
    let _alone = alone();
    judged(|| {
        let folder = tempfile::tempdir().unwrap();
        let (mut harness, file) = on_emulated_rig(folder.path());
        let was = file.rig().unwrap().devices.unwrap();
        assert_eq!(serials(harness.state().rig()), [Some(4711), Some(4712)]);
        press(&mut harness, "Choose right handle");
        let other = harness.get_by_label_contains("serial number 4712, firmware 3.2: currently the left handle");
        other.click();
        harness.step();
        wait(&mut harness, "exchanged handles", |harness| serials(harness.state().rig()) == [Some(4712), Some(4711)]);
        wait(&mut harness, "idle or waiting for its devices", |harness| {
            matches!(state(harness), Some(LoopState::Idle | LoopState::Disconnected))
        });
        harness.run_steps(2);
        harness.get_by_label_contains("Saved in the rig file");

        press(&mut harness, "Swap sensors");
        let path = folder.path().join("rigs/bench.toml");
        wait(&mut harness, "exchanged sensors", |harness| {
            let of = |devices: &RigSettings, side| devices.arm(side).map(|set| set.sensor.clone());
            let now = harness.state().rig().devices.clone().unwrap();
            of(&now, Side::Right) == of(&was, Side::Left) && of(&now, Side::Left) == of(&was, Side::Right)
        });
        assert_eq!(Some(&saved(&path)), harness.state().rig().devices.as_ref(), "the file says the same");
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(text.contains("# Mirror image of the right arm's mount."), "comments stay");
        assert_eq!(harness.state().running().rig, path.display().to_string());
        wait(&mut harness, "all are connected again", |harness| {
            harness.query_all_by_label_contains("readings per second").count() == 11
        });
        harness.get_by_label_contains("serial number SN000902");
    });
}

#[test]
#[ignore = "an emulated rig in real time: `./dev test` runs it alone"]
fn every_device_is_tested_and_its_figures_are_told() {
    let _alone = alone();
    judged(|| {
        let folder = tempfile::tempdir().unwrap();
        let (mut harness, _) = on_emulated_rig(folder.path());
        press(&mut harness, "Test all");
        assert!(harness.query_all_by_label("testing: keep it at rest").next().is_some());
        wait(&mut harness, "results", |harness| verdicts(harness) == 11);
        // Two sensors with an accelerometer, three with forces.
        assert_eq!(harness.query_all_by_label("Up").count(), 2);
        assert_eq!(harness.query_all_by_label("Noise of force").count(), 3);
        assert_eq!(harness.query_all_by_label("Noise of third marker").count(), 1);
        assert_eq!(harness.query_all_by_label_contains(" of 1000 Hz").count(), 6);
        assert!(harness.query_all_by_label_contains(" m/s\u{b2}").count() >= 2);
        press(&mut harness, "Disconnect pedal");
        press(&mut harness, "Test right arm");
        wait(&mut harness, "the result of one", |harness| {
            verdicts(harness) == 11 && harness.query_all_by_label("testing: keep it at rest").next().is_none()
        });
    });
}

#[test]
#[ignore = "an emulated rig in real time: `./dev test` runs it alone"]
fn nothing_is_changed_while_the_drives_are_on_and_a_rig_without_devices_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let harness = console(folder.path());
    harness.get_by_label("This rig is simulated: it has no devices");
    assert!(harness.query_by_label_contains("Swap").is_none());
    drop(harness);
    let _alone = alone();
    judged(|| {
        let folder = tempfile::tempdir().unwrap();
        let mut file = rig_file(&elsewhere(folder.path()));
        for side in Side::ALL {
            file.set(&format!("devices.{}.sensor_at", side.word()), "tip");
        }
        file.set("name", "Bench rig");
        file.save(&folder.path().join("rigs/bench.toml")).unwrap();
        let mut harness = console(folder.path());
        press(&mut harness, "Rig");
        press(&mut harness, "Bench rig");
        press(&mut harness, "Start");
        wait(&mut harness, "the rig runs", |harness| harness.state().rig().name == "Bench rig");
        press(&mut harness, "Engage");
        wait(&mut harness, "engaged", |harness| state(harness) == Some(LoopState::Engaged));
        harness.run_steps(2);
        harness.get_by_label_contains("Set the loop to idle or press Stop first: the drives are on");
        let button = harness.get_by_role_and_label(Role::Button, "Swap handles");
        assert!(button.accesskit_node().is_disabled());
        press(&mut harness, "Choose left arm");
        let other = harness.get_by_label_contains("currently the right arm; the two will be swapped");
        assert!(other.accesskit_node().is_disabled());
        press(&mut harness, "Stop");
        wait(&mut harness, "stopped", |harness| state(harness) == Some(LoopState::Stopped));
        harness.run_steps(2);
        harness.get_by_label_contains("Press Release stop first");
    });
}
