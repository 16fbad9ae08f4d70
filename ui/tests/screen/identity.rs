//! A control keeps its id while alarms and messages appear and disappear around it: a press or drag in that frame must not be
//! lost.

use std::collections::BTreeMap;

use eframe::App as _;
use egui::{
    Key,
    accesskit::{NodeId, Role},
};
use egui_kittest::{
    Harness,
    kittest::{NodeT as _, Queryable as _},
};
use nima_console::console::ConsoleApp;
use nima_machine::messages::LoopState;

use crate::bench::{console_of, press, read, until};

const SIZE: [f32; 2] = [1600.0, 1000.0];
const CONTROLS: [Role; 5] = [Role::Button, Role::Slider, Role::CheckBox, Role::SpinButton, Role::TextInput];

/// Returns the controls of a frame by name; duplicate names are left out.
fn controls(harness: &Harness<'_, ConsoleApp>) -> BTreeMap<String, NodeId> {
    let mut named: BTreeMap<String, Vec<NodeId>> = BTreeMap::new();
    for role in CONTROLS {
        for node in harness.query_all_by_role(role) {
            let node = node.accesskit_node();
            if let Some(label) = node.label() {
                named.entry(format!("{role:?} {label}")).or_default().push(node.locate().0);
            }
        }
    }
    named.into_iter().filter_map(|(name, ids)| (ids.len() == 1).then(|| (name, ids[0]))).collect()
}

/// Returns the controls whose id has changed.
fn changed(before: &BTreeMap<String, NodeId>, harness: &Harness<'_, ConsoleApp>) -> Vec<String> {
    let now = controls(harness);
    before
        .iter()
        .filter(|(name, id)| now.get(*name).is_some_and(|now| now != *id))
        .map(|(name, _)| name.clone())
        .collect()
}

#[test]
fn what_comes_and_goes_on_the_screen_takes_no_control_out_of_a_hand() {
    for role in [Key::F1, Key::F2, Key::F3, Key::F6] {
        let mut harness = console_of("peg_transfer", SIZE, |app| app);
        harness.key_press(role);
        until(&mut harness, "engaged", |tick| tick.state == LoopState::Engaged);
        harness.run_steps(3);
        let engaged = controls(&harness);
        assert!(engaged.len() >= 5, "{role:?}: {engaged:?}");
        // Check without contact, with contact, and without again.
        for contact in [false, true, false] {
            until(&mut harness, "contact or none", |tick| (tick.measured_n.norm() > 0.5) == contact);
            harness.run_steps(10);
            assert_eq!(changed(&engaged, &harness), [""; 0], "{role:?}: contact: {contact}");
        }
        press(&mut harness, "Stop");
        until(&mut harness, "stopped", |tick| tick.state == LoopState::Stopped);
        harness.run_steps(3);
        assert_eq!(changed(&engaged, &harness), [""; 0], "{role:?}: stopped");
        harness.state_mut().on_exit(None);
        read(&mut harness, "The control loop has stopped sending data");
        assert_eq!(changed(&engaged, &harness), [""; 0], "{role:?}: an alarm");
        harness.key_press(Key::A);
        harness.run_steps(3);
        assert_eq!(changed(&engaged, &harness), [""; 0], "{role:?}: an alarm that was acknowledged");
    }
}
