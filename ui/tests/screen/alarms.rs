//! Alarms in the window: pinned, folded, acknowledged, listed; and the stop button above all open windows.

use eframe::App as _;
use egui::{Key, accesskit::Role, pos2, vec2};
use egui_kittest::{
    Harness,
    kittest::{NodeT as _, Queryable as _},
};
use nima_console::console::{ConsoleApp, ConsoleOptions};
use nima_machine::{config::RigConfig, messages::LoopState};
use nima_panels::settings::SettingsStore;
use nima_simulation::{SimulationPlan, scene::Scene, start};
use nima_wizards::WizardKind;

use crate::bench::{console_of, press, read, until};

const SIZE: [f32; 2] = [1100.0, 680.0];
const SILENT: &str = "The control loop has stopped sending data";
const STUCK: &str = "The stop has not reached the control loop";

fn reads(harness: &Harness<'_, ConsoleApp>, words: &str) -> usize {
    harness.query_all_by_label_contains(words).count()
}

/// Returns a console whose loop has ended unexpectedly.
fn of_a_dead_loop() -> Harness<'static, ConsoleApp> {
    let mut harness = console_of("free_motion", SIZE, |app| app);
    until(&mut harness, "any tick", |_| true);
    harness.state_mut().on_exit(None);
    read(&mut harness, SILENT);
    harness
}

#[test]
fn an_alarm_moves_no_control_under_the_pointer() {
    let mut harness = console_of("free_motion", SIZE, |app| app);
    until(&mut harness, "engaged", |tick| tick.state == LoopState::Engaged);
    let places = |harness: &Harness<'_, ConsoleApp>| {
        ["Matched", "Compare all modes", "Pause"].map(|label| harness.get_by_label(label).rect())
    };
    let before = places(&harness);
    assert_eq!(reads(&harness, "No active alarms"), 1);
    harness.state_mut().on_exit(None);
    read(&mut harness, SILENT);
    assert_eq!(places(&harness), before);
}

fn can_acknowledge(harness: &Harness<'_, ConsoleApp>) -> bool {
    !harness.get_by_role_and_label(Role::Button, "Acknowledge (A)").accesskit_node().is_disabled()
}

#[test]
fn the_first_alarm_stays_pinned_and_a_new_one_calls_again_after_an_acknowledgement() {
    let mut harness = of_a_dead_loop();
    assert!(can_acknowledge(&harness));
    press(&mut harness, "Acknowledge (A)");
    assert!(!can_acknowledge(&harness), "nothing is left to be acknowledged");
    read(&mut harness, "acknowledged");
    assert_eq!(reads(&harness, SILENT), 1, "its cause is present, and so is the alarm");
    press(&mut harness, "Stop");
    harness.run_steps(3);
    assert_eq!((reads(&harness, SILENT), reads(&harness, "(+1 more)")), (1, 1), "the first stays pinned");
    assert!(can_acknowledge(&harness));
    harness.key_press(Key::A);
    harness.run_steps(2);
    assert!(!can_acknowledge(&harness));
}

#[test]
fn the_list_shows_all_alarms_with_their_times_and_opens_by_key_button_and_click() {
    let mut harness = of_a_dead_loop();
    press(&mut harness, "Stop");
    harness.run_steps(3);
    assert_eq!(reads(&harness, STUCK), 0, "folded under the first");
    harness.key_press(Key::F5);
    harness.run_steps(3);
    assert_eq!((reads(&harness, STUCK), reads(&harness, ", still present")), (1, 2));
    harness.key_press(Key::F5);
    harness.run_steps(3);
    assert_eq!(reads(&harness, STUCK), 0);
    press(&mut harness, "All alarms (F5)");
    assert_eq!(reads(&harness, STUCK), 1);
    harness.key_press(Key::F5);
    harness.run_steps(3);
    let alarm = harness.get_by_label_contains(SILENT).rect().left_center() + vec2(20.0, 0.0);
    click(&mut harness, alarm);
    assert_eq!(reads(&harness, STUCK), 1);
}

fn click(harness: &mut Harness<'_, ConsoleApp>, at: egui::Pos2) {
    harness.hover_at(at);
    harness.step();
    harness.drag_at(at);
    harness.step();
    harness.drop_at(at);
    harness.run_steps(3);
}

/// Windows that may be open over the console.
const OVERLAYS: [&str; 6] = ["tour", "glossary", "glossary dragged to the stop", "view menu", "alarms", "hint"];

fn open(harness: &mut Harness<'_, ConsoleApp>, overlay: &str) {
    match overlay {
        "glossary" | "glossary dragged to the stop" => harness.key_press(Key::F4),
        "alarms" => harness.key_press(Key::F5),
        "view menu" => press(harness, "View"),
        "hint" => {
            let state = harness.get_by_label("Loop state: Engaged").rect().center();
            harness.hover_at(state);
            harness.run_steps(20);
        }
        _ => {}
    }
    harness.run_steps(3);
    if overlay == "glossary dragged to the stop" {
        // The title bar is above the first word.
        let word =
            |harness: &Harness<'_, ConsoleApp>| harness.get_by_role_and_label(Role::Label, "Keys").rect().left_top();
        let before = word(harness);
        let from = before + vec2(150.0, -20.0);
        harness.drag_at(from);
        harness.step();
        harness.hover_at(pos2(SIZE[0] - 60.0, 10.0));
        harness.step();
        harness.drop_at(pos2(SIZE[0] - 60.0, 10.0));
        harness.run_steps(3);
        assert!(word(harness).x > before.x + 50.0, "the window follows the pointer");
    }
}

#[test]
fn the_stop_is_hit_by_a_click_and_by_both_keys_whatever_is_open() {
    for overlay in OVERLAYS {
        for key in [None, Some(Key::Space), Some(Key::Escape)] {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().to_path_buf();
            let mut harness = console_of("free_motion", SIZE, move |app| {
                let mut kept = SettingsStore::open(&path);
                kept.now.toured = overlay != "tour";
                app.with_settings(kept)
            });
            until(&mut harness, "engaged", |tick| tick.state == LoopState::Engaged);
            open(&mut harness, overlay);
            if overlay == "tour" && key == Some(Key::Escape) {
                // Without devices, the first press only closes the window.
                assert_eq!(reads(&harness, "Continue with the simulated rig"), 1);
                harness.key_press(Key::Escape);
                harness.run_steps(3);
                assert_eq!(reads(&harness, "Continue with the simulated rig"), 0);
                assert_eq!(harness.state().tick().unwrap().state, LoopState::Engaged, "closed, not stopped");
            }
            stop_by(&mut harness, key, overlay);
        }
    }
}

#[test]
fn the_stop_is_hit_in_every_wizard() {
    for which in WizardKind::ALL {
        for key in [None, Some(Key::Space), Some(Key::Escape)] {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().to_path_buf();
            let options = ConsoleOptions { wizard: Some(which), ..ConsoleOptions::default() };
            let mut harness = console_of(which.scene().unwrap_or("peg_transfer"), SIZE, move |app| {
                app.with_store(&path).with_options(options)
            });
            until(&mut harness, "any tick", |_| true);
            stop_by(&mut harness, key, which.name());
        }
    }
}

/// Stops by this key, or by a click on the visible button; the loop stays stopped.
fn stop_by(harness: &mut Harness<'_, ConsoleApp>, key: Option<Key>, over: &str) {
    let stop = harness.get_by_role_and_label(Role::Button, "Stop").rect();
    assert!(stop.width() >= 48.0 && stop.height() >= 48.0, "{over}: {stop:?}");
    match key {
        Some(key) => harness.key_press(key),
        None => click(harness, stop.center()),
    }
    harness.step();
    until(harness, &format!("stopped by {key:?} over the {over}"), |tick| tick.state == LoopState::Stopped);
    harness.run_steps(30);
    assert_eq!(harness.state().tick().unwrap().state, LoopState::Stopped, "latched");
}

#[test]
fn an_accepted_stop_is_no_alarm() {
    let mut harness = console_of("free_motion", SIZE, |app| app);
    until(&mut harness, "engaged", |tick| tick.state == LoopState::Engaged);
    stop_by(&mut harness, None, "monitor");
    harness.key_press(Key::F5);
    harness.run_steps(3);
    assert_eq!(reads(&harness, STUCK), 0);
    // A loop that gets no processor time for half a second is correctly reported as silent.
    assert!(reads(&harness, "Alarm: ") <= reads(&harness, SILENT));
}

#[test]
fn a_device_that_is_missing_is_pinned_with_its_cause_and_its_cure() {
    let folder = tempfile::tempdir().unwrap();
    let text = include_str!("../../../config/rigs/emulated.toml")
        .replace("emulated = true", "emulated = false")
        .replace("emulator = \"127.0.0.1:47130\"\n", "")
        .replace("emulator = \"127.0.0.1:47131\"\n", "")
        .replace("= 471", "= 528")
        .replace(":471", ":528")
        .replace("/tmp/nima-emulated", &folder.path().display().to_string());
    let file = folder.path().join("absent.toml");
    std::fs::write(&file, text).unwrap();
    let rig = RigConfig::load(file.to_str().unwrap()).unwrap();
    let scene = Scene::load("peg_transfer").unwrap();
    let handle = start(&SimulationPlan {
        rig: rig.clone(),
        scene: scene.clone(),
        calibrations: Default::default(),
        engage: false,
    })
    .unwrap();
    let mut harness = Harness::builder()
        .with_size(SIZE)
        .with_step_dt(1.0 / 30.0)
        .build_eframe(move |cc| ConsoleApp::new(cc, handle, rig, scene));
    read(&mut harness, "No connection to the ");
    read(&mut harness, "more)");
    harness.run_steps(30);
    assert_eq!(reads(&harness, "No connection to the "), 1, "the first is pinned, the others are folded under it");
    assert_eq!(reads(&harness, "Warning: No connection"), 1);
    harness.key_press(Key::F5);
    read(&mut harness, "No connection to the right arm: no response from 127.0.0.1:52800");
    read(&mut harness, "Correct the port number in the rig file");
}

#[test]
fn a_refused_engagement_says_why() {
    let mut harness = console_of("palpation", SIZE, |app| app);
    until(&mut harness, "idle", |tick| tick.state == LoopState::Idle);
    press(&mut harness, "Engage");
    read(
        &mut harness,
        "Not engaged: the force at the tip is unknown: the wrist sensor is not calibrated. Calibrate gravity for this sensor and tool",
    );
}
