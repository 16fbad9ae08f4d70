//! The technician's panels on a running loop: interlock and gates are highlighted, the stable gain is shown, moments are
//! marked.

use egui::{Key, accesskit};
use egui_kittest::{
    Harness,
    kittest::{NodeT as _, Queryable as _},
};
use nima_machine::messages::LoopState;

use crate::bench::{console_of, pick, press, until};

const SIZE: [f32; 2] = [1600.0, 1000.0];
const HANDS: [(&str, &str); 2] = [("Left hand", "left"), ("Right hand", "right")];

#[test]
fn the_interlock_of_each_hand_shows_its_state_and_the_reason() {
    let mut harness = console_of("bimanual", SIZE, |app| app);
    until(&mut harness, "engaged", |tick| tick.state == LoopState::Engaged);
    press(&mut harness, "Safety");
    for (hand, side) in HANDS {
        press(&mut harness, hand);
        harness.get_by_label_contains(&format!("Interlock, {side} hand: engaged, since"));
    }
    press(&mut harness, "Stop");
    until(&mut harness, "stopped", |tick| tick.state == LoopState::Stopped);
    let stopped_s = harness.state().tick().unwrap().t_s;
    // A lamp follows its gate with a delay of some tenths of a second, so that it can be read.
    until(&mut harness, "a moment later", |tick| tick.t_s > stopped_s + 0.5);
    harness.step();
    for (hand, side) in HANDS {
        press(&mut harness, hand);
        let begins = format!("Interlock, {side} hand: stopped, since");
        let report = harness.get_by_label_contains(&begins);
        assert!(report.accesskit_node().value().unwrap().ends_with("requested by the operator"));
        harness.get_by_label_contains(&format!("Gate Engaged, {side} hand: closed"));
    }
}

#[test]
fn the_gain_tells_where_it_is_stable_once_there_was_a_contact() {
    // Without contact, the stiffness never becomes known.
    let mut harness = console_of("free_motion", SIZE, |app| app);
    until(&mut harness, "the first ticks", |tick| tick.t_s > 0.1);
    harness.get_by_label("Highest stable gain: known after the first contact");
    let mut harness = console_of("peg_transfer", SIZE, |app| app);
    until(&mut harness, "the first ticks", |tick| tick.t_s > 0.1);
    let slider = |harness: &Harness<'_, _>| {
        harness.get_by_role_and_label(accesskit::Role::Slider, "Link delay").accesskit_node().id()
    };
    let before = slider(&harness);
    until(&mut harness, "a contact that lasts", |tick| tick.t_s > 3.5);
    harness.step();
    assert!(slider(&harness) == before, "a control below it would move away under the pointer at the first contact");
    let report = harness.get_by_label_contains("stable up to").accesskit_node().value().unwrap();
    // At the pressed place, the scene's phantom has 300 to 500 N/m.
    let n_m: f64 = report.split("at ").last().unwrap().trim_end_matches(" N/m").parse().unwrap();
    assert!((150.0..800.0).contains(&n_m), "{report}");
}

#[test]
fn one_key_marks_a_moment_also_while_the_traces_are_paused() {
    let mut harness = console_of("peg_transfer", SIZE, |app| app);
    until(&mut harness, "any tick", |_| true);
    harness.key_press(Key::E);
    harness.step();
    press(&mut harness, "Pause");
    until(&mut harness, "later", |tick| tick.t_s > 0.5);
    press(&mut harness, "Mark (E)");
    until(&mut harness, "later still", |tick| tick.t_s > 0.7);
    press(&mut harness, "View");
    pick(&mut harness, "Mark this moment (E)");
    harness.step();
    let marks_s: Vec<f64> = harness.state().marks_s().collect();
    assert_eq!(marks_s.len(), 3);
    assert!(marks_s[2] >= 0.7, "{marks_s:?}");
    assert!(marks_s[1] >= 0.5 && marks_s[0] < marks_s[1], "{marks_s:?}");
    harness.get_by_role_and_label(accesskit::Role::Button, "Resume");
    harness.get_by_label_contains("Force space.");
}
