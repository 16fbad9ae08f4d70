//! Three roles of one loop: the content of each view, and that switching changes nothing but the view.

use egui::{Key, accesskit};
use egui_kittest::kittest::Queryable as _;
use nima_console::console::ConsoleOptions;
use nima_machine::messages::LoopState;
use nima_panels::{roles::Role, settings::SettingsStore};

use crate::{
    bench::{can_press, console_of, press, read, shows, until},
    playback,
};

const SIZE: [f32; 2] = [1280.0, 720.0];

#[test]
fn one_click_or_one_key_changes_the_role_and_the_stop_stays_where_it_is() {
    let mut harness = console_of("bimanual", SIZE, |app| app);
    until(&mut harness, "engaged", |tick| tick.state == LoopState::Engaged);
    let stop = harness.get_by_role_and_label(accesskit::Role::Button, "Stop").rect();
    for (key, name, role) in
        [(Key::F1, "Surgeon", Role::Surgeon), (Key::F3, "Demo", Role::Demo), (Key::F2, "Technician", Role::Technician)]
    {
        harness.key_press(key);
        harness.step();
        assert_eq!(harness.state().role(), role, "by key");
        press(&mut harness, if role == Role::Technician { "Demo" } else { "Technician" });
        press(&mut harness, name);
        assert_eq!(harness.state().role(), role, "by click");
        harness.step();
        let now = harness.get_by_role_and_label(accesskit::Role::Button, "Stop").rect();
        assert_eq!(now, stop, "a hand that reaches for the stop must find it");
    }
    assert_eq!(harness.state().tick().unwrap().state, LoopState::Engaged);
}

#[test]
fn the_button_of_the_present_view_leads_back_to_it() {
    let mut harness = console_of("peg_transfer", SIZE, |app| app);
    press(&mut harness, "Rig");
    harness.get_by_label_contains("Choose a scene");
    press(&mut harness, "Technician");
    assert!(!shows(&harness, "Choose a scene"));
}

#[test]
fn the_gain_of_a_recorded_session_says_why_it_cannot_be_set() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("session.mcap");
    playback::record(&path, "peg_transfer", "2");
    let mut harness = console_of("peg_transfer", SIZE, move |app| app.with_session(&path));
    playback::until_whole(&mut harness);
    harness.state_mut().settings_mut().role = Role::Surgeon;
    harness.run_steps(3);
    assert!(!can_press(&harness, "Raise the gain"));
    let place = harness.get_by_role_and_label(accesskit::Role::Button, "Raise the gain").rect();
    harness.hover_at(place.center());
    read(&mut harness, "Not during playback: press L first");
}

#[test]
fn the_first_step_of_the_tour_says_why_there_is_no_step_back() {
    let folder = tempfile::tempdir().unwrap();
    let settings = SettingsStore::open(folder.path());
    let mut harness = console_of("peg_transfer", SIZE, move |app| app.with_settings(settings));
    press(&mut harness, "Continue with the simulated rig");
    harness.run_steps(3);
    assert!(!can_press(&harness, "Step back"));
    let place = harness.get_by_role_and_label(accesskit::Role::Button, "Step back").rect();
    harness.hover_at(place.center());
    read(&mut harness, "This is the first step");
}

#[test]
fn the_surgeon_sees_both_hands_and_sets_the_gain_and_nothing_can_raise_it_above_one() {
    let mut harness = console_of("bimanual", SIZE, |app| app);
    harness.key_press(Key::F1);
    until(&mut harness, "engaged", |tick| tick.state == LoopState::Engaged);
    harness.step();
    harness.get_by_label_contains("Left hand: measured");
    harness.get_by_label_contains("Right hand: measured");
    press(&mut harness, "Lower the gain");
    until(&mut harness, "gain 0.9", |tick| (tick.gates.gain - 0.9).abs() < 1e-6);
    for _ in 0..3 {
        press(&mut harness, "Raise the gain");
    }
    until(&mut harness, "gain 1", |tick| (tick.gates.gain - 1.0).abs() < 1e-6);
    harness.get_by_role_and_label(accesskit::Role::Slider, "Gain").set_value_accesskit(0.4);
    harness.step();
    until(&mut harness, "gain 0.4", |tick| (tick.gates.gain - 0.4).abs() < 1e-6);
}

/// Without a haptic device, the surgeon drives by mouse and keys too, also after a stop.
#[test]
fn the_instrument_is_driven_in_the_surgeon_view_again_after_a_stop() {
    let mut harness = console_of("peg_transfer", SIZE, |app| app);
    until(&mut harness, "engaged", |tick| tick.state == LoopState::Engaged);
    harness.key_press(Key::F1);
    harness.run_steps(2);
    for _ in 0..2 {
        harness.key_press(Key::M);
        harness.step();
        until(&mut harness, "driven", |tick| tick.guidance.guide_m.is_some());
        press(&mut harness, "Stop");
        until(&mut harness, "stopped", |tick| tick.state == LoopState::Stopped && tick.guidance.guide_m.is_none());
        press(&mut harness, "Release stop");
        press(&mut harness, "Engage");
        until(&mut harness, "engaged", |tick| tick.state == LoopState::Engaged);
    }
}

#[test]
fn an_open_menu_closes_when_another_view_is_chosen() {
    let mut harness = console_of("free_motion", SIZE, |app| app);
    press(&mut harness, "View");
    harness.run_steps(3);
    let is_open = |harness: &egui_kittest::Harness<'_, nima_console::console::ConsoleApp>| {
        harness.query_by_label("Colours").is_some()
    };
    assert!(is_open(&harness));
    harness.key_press(Key::F1);
    harness.run_steps(3);
    assert!(!is_open(&harness));
}

#[test]
fn a_new_user_is_welcomed_once_and_never_over_a_view_that_was_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let begin = |role: Option<Role>| {
        let path = folder.path().to_path_buf();
        let options = ConsoleOptions { role, ..ConsoleOptions::default() };
        let mut harness = console_of("free_motion", SIZE, move |app| {
            app.with_settings(SettingsStore::open(&path)).with_options(options)
        });
        harness.run_steps(3);
        harness.query_by_label("Continue with the simulated rig").is_some()
    };
    assert!(!begin(Some(Role::Demo)));
    assert!(begin(None));
    assert!(!begin(None), "the second start");
}

#[test]
fn the_role_is_remembered() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().to_path_buf();
    let begin = |path: std::path::PathBuf| {
        console_of("free_motion", SIZE, move |app| app.with_settings(SettingsStore::open(&path)))
    };
    let mut harness = begin(path.clone());
    press(&mut harness, "Surgeon");
    drop(harness);
    assert_eq!(begin(path).state().role(), Role::Surgeon);
}
