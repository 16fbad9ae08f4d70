//! Tests of the frame wizards, operated by accessible names over the interfaces of an emulated rig whose rig file is
//! wrong.
#![cfg(target_os = "linux")]

use std::path::Path;

use egui_kittest::Harness;
use nima_console::console::{ConsoleApp, reader::ScreenReader};
use nima_emulation::emulated::EmulatedRig;
use nima_machine::{
    config::{RigConfig, RigFile},
    rig::{RigSettings, Side},
};
use nima_simulation::{SimulationPlan, scene::Scene, start};
use nima_testing::real_time::{alone, judged};
use nima_tests::emulated::{elsewhere, started};

use crate::{
    bench::{Console, TIMEOUT, can_press, comes, console_of, pick, shows, texts, toured},
    language,
};

const SIZE: [f32; 2] = [1600.0, 1000.0];

/// Returns the built-in emulated rig as a file with the addresses of these devices, and with another shaft.
fn rig_file(folder: &Path, devices: &RigSettings) -> String {
    let mut file = RigFile::of("emulated").unwrap();
    let mut put = |key: &str, value: &dyn std::fmt::Display| file.set(&format!("devices.{key}"), value.to_string());
    for side in Side::ALL {
        let set = devices.arm(side).unwrap();
        let word = side.word();
        put(&format!("{word}.handle.emulator"), &set.handle.force_dimension().unwrap().emulator.unwrap());
        put(&format!("{word}.sensor.port"), &set.sensor.bota().unwrap().port);
        put(&format!("{word}.servos.port"), &set.servos.as_ref().unwrap().port);
    }
    put("tissue_sensor.port", &devices.tissue_sensor.as_ref().unwrap().bota().unwrap().port);
    put("tracker.address", devices.tracker.as_ref().unwrap().address.as_ref().unwrap());
    put("pedal.source", &devices.pedal.as_ref().unwrap().source);
    // No server uses this address.
    file.set("endoscope.url", "http://127.0.0.1:9/");
    for side in Side::ALL {
        let arm = devices.arm(side).unwrap().arm.kinova().unwrap();
        for (key, port) in [("tcp_port", arm.tcp_port), ("udp_port", arm.udp_port)] {
            assert!(file.set_text(&format!("devices.{}.arm.{key}", side.word()), &port.to_string()));
        }
    }
    let tools = &devices.tracker.as_ref().unwrap().tools;
    assert!(file.set_text("devices.tracker.tools", &format!("{tools:?}")));
    // The instrument was replaced by a longer one, but the rig file was not updated.
    let shaft_m = devices.right.as_ref().unwrap().mount.shaft_m - 0.006;
    file.set("devices.right.mount.shaft_m", shaft_m);
    let path = folder.join("theatre.toml");
    file.save(&path).unwrap();
    path.display().to_string()
}

/// Returns the console on the emulated interfaces, and the emulators.
pub(crate) fn console(folder: &Path) -> (Console, EmulatedRig, String) {
    let devices = elsewhere(folder);
    let emulators = started(&devices);
    let name = rig_file(folder, &devices);
    let rig = RigConfig::load(&name).unwrap();
    let scene = Scene::load("peg_transfer").unwrap();
    let plan =
        SimulationPlan { rig: rig.clone(), scene: scene.clone(), calibrations: Default::default(), engage: false };
    let handle = start(&plan).unwrap();
    let technician = emulators.technician();
    let store = folder.join("calibrations");
    let kept = folder.to_path_buf();
    let running = name.clone();
    let console = Harness::builder().with_size(SIZE).with_step_dt(1.0 / 30.0).build_eframe(move |cc| {
        ConsoleApp::new(cc, handle, rig, scene)
            .with_store(&store)
            .with_settings(toured(&kept))
            .with_rig_name(running)
            .with_reader(ScreenReader::new(move |screen| technician.reads(screen)))
    });
    (console, emulators, name)
}

/// Steps the window until the condition holds.
fn until(console: &mut Console, what: &str, wanted: impl Fn(&Console) -> bool) {
    assert!(comes(console, TIMEOUT, wanted), "never: {what}; there is: {:?}", texts(console));
}

fn press(console: &mut Console, label: &str) {
    until(console, label, |console| can_press(console, label));
    pick(console, label);
}

fn shaft_m(rig: &str) -> f64 {
    RigConfig::load(rig).unwrap().devices.unwrap().right.unwrap().mount.shaft_m
}

#[test]
#[ignore = "an emulated rig for half a minute in real time: `./dev walk` runs it"]
fn a_technician_finds_the_tip_sees_the_change_saves_it_and_undoes_it() {
    let _alone = alone();
    judged(|| {
        let folder = tempfile::tempdir().unwrap();
        let (mut console, _emulators, rig) = console(folder.path());
        let wrong_m = shaft_m(&rig);
        press(&mut console, "Calibrate tip…");
        until(&mut console, "the joints", |c| shows(c, "Joints of the arm: passed"));
        assert!(shows(&console, "put its tip into a dimple"));
        press(&mut console, "Next");
        until(&mut console, "some poses", |c| shows(c, "4 poses; still needed: "));
        until(&mut console, "all poses", |c| shows(c, "20 poses; complete"));
        language::fits(&mut console, "poses");
        press(&mut console, "Next");
        until(&mut console, "the verdict", |c| shows(c, "Accurate on held-out data"));
        language::fits(&mut console, "result");
        assert!(shows(&console, "devices.right.mount.shaft_m") && shows(&console, "dashed: now   solid: new"));
        assert_eq!(shaft_m(&rig).to_bits(), wrong_m.to_bits(), "nothing is changed before it is saved");
        press(&mut console, "Next");
        language::fits(&mut console, "save");
        press(&mut console, "Save and use");
        until(&mut console, "saved", |c| shows(c, "Saved: "));
        let found_m = shaft_m(&rig);
        println!("shaft: {wrong_m} m believed, {found_m} m found");
        assert!((found_m - wrong_m - 0.006).abs() < 0.5e-3, "{found_m} m");
        assert!(
            RigFile::of(&rig).unwrap().text().contains("# Mirror image of the right arm's mount."),
            "comments stay"
        );
        let now = console.state().rig().devices.as_ref().unwrap().right.as_ref().unwrap().mount.shaft_m;
        assert!((now - found_m).abs() < 1e-12, "the loop runs with it");
        press(&mut console, "Restore previous values");
        until(&mut console, "undone", |c| shows(c, "The previous values are in the rig file again"));
        assert!((shaft_m(&rig) - wrong_m).abs() < 1e-12);
        press(&mut console, "Next: Right arm, hand-eye");
        assert!(shows(&console, "turn its marker towards the tracker"));
    });
}

#[test]
fn a_rig_without_an_arm_of_joints_says_what_to_do() {
    use nima_console::console::ConsoleOptions;
    use nima_wizards::{FrameKind, WizardKind};
    for which in FrameKind::ALL.map(WizardKind::Frame) {
        let options = ConsoleOptions { wizard: Some(which), ..ConsoleOptions::default() };
        let mut console = console_of("peg_transfer", SIZE, move |app| app.with_options(options));
        console.run_steps(4);
        assert!(shows(&console, "choose a rig with devices on the start page"), "{which:?}: {:?}", texts(&console));
        assert!(!can_press(&console, "Next"));
    }
}
