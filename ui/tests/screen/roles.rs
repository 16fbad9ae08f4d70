//! Three roles of one loop: the content of each view, and that switching changes nothing but the view.

use egui::{Key, accesskit};
use egui_kittest::kittest::Queryable as _;
use nima_console::console::{roles::Role, settings::SettingsStore};
use nima_machine::messages::LoopState;

use crate::bench::{console_of, press, until};

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
