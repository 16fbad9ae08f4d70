//! What can be operated in each view, by kind and name, beside what was agreed: a control that is lost, renamed or new is seen in a
//! review. Digits are left out, because numbers move. `UPDATE_SNAPSHOTS=1` writes the files anew.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

mod screen;

use std::{env, fs, path::Path};

use egui::accesskit::Role as Kind;
use egui_kittest::{
    Harness,
    kittest::{NodeT as _, Queryable as _},
};
use nima::teleop::LoopState;
use nima_console::console::{ConsoleApp, Options, roles::Role};
use screen::{console_of, until};

/// Kind and name of everything that can be operated, in the order of the keyboard.
fn controls(harness: &Harness<'_, ConsoleApp>) -> String {
    let operated = |kind: Kind| matches!(kind, Kind::Button | Kind::CheckBox | Kind::RadioButton | Kind::Slider);
    let mut text = String::new();
    for node in harness.get_all_by(move |node| operated(node.role())) {
        let node = node.accesskit_node();
        let name: String = node.label().unwrap_or_default().chars().filter(|letter| !letter.is_ascii_digit()).collect();
        // An alarm depends on the computer: one without the right to a real-time thread has one.
        if !(name.starts_with("All alarms") || name.starts_with("Acknowledge")) {
            text.push_str(&format!("{:?}: {}\n", node.role(), name.lines().next().unwrap_or_default()));
        }
    }
    text
}

#[test]
fn every_view_offers_what_was_agreed() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/snapshots");
    for (role, name) in [(Role::Surgeon, "surgeon"), (Role::Technician, "technician"), (Role::Demo, "demo")] {
        let mut harness = console_of("bimanual", [1600.0, 1000.0], move |app| {
            app.with_options(Options { role: Some(role), ..Options::default() })
        });
        until(&mut harness, "engaged", |tick| tick.state == LoopState::Engaged);
        harness.run_steps(5);
        let (now, path) = (controls(&harness), folder.join(format!("{name}.txt")));
        if env::var_os("UPDATE_SNAPSHOTS").is_some() {
            fs::create_dir_all(&folder).unwrap();
            fs::write(&path, &now).unwrap();
        }
        let agreed = fs::read_to_string(&path).unwrap_or_default();
        assert_eq!(now, agreed, "{}: if this is meant, run with UPDATE_SNAPSHOTS=1", path.display());
    }
}
