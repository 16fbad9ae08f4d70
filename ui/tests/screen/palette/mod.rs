//! The palette: every command of the table is found by its name and has the same effect as its key, menu or button; each
//! person finds the commands available to them, and a single Enter never leads to force.

mod machine;
mod menus;
mod parts;
mod reach;
mod undo;
mod wizards;

use std::path::Path;

use egui::{Key, Modifiers, accesskit::Role as Kind};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use nima_console::console::commands::{Action, CommandEntry, table};
use nima_machine::messages::LoopState;
use nima_panels::roles::Role;

use crate::bench::{Console, console_of, press, shows, texts, toured, until, write_into};

pub(super) const SIZE: [f32; 2] = [1600.0, 1000.0];
pub(super) const FIELD: &str = "Find a command";

pub(super) fn entry(action: Action) -> &'static CommandEntry {
    table().iter().find(|entry| entry.action == action).unwrap()
}

pub(super) fn is_open(console: &Console) -> bool {
    console.query_by_role_and_label(Kind::TextInput, FIELD).is_some()
}

pub(super) fn open(console: &mut Console) {
    console.key_press_modifiers(Modifiers::COMMAND, Key::P);
    console.run_steps(3);
    assert!(is_open(console), "there is: {:?}", texts(console));
}

pub(super) fn close(console: &mut Console) {
    console.key_press_modifiers(Modifiers::COMMAND, Key::P);
    console.run_steps(2);
    assert!(!is_open(console));
}

/// Returns the names of the rows, and whether each can be chosen.
pub(super) fn rows(console: &mut Console) -> Vec<(String, bool)> {
    open(console);
    let rows = console.query_all_by_role(Kind::MenuItem).map(|row| row.accesskit_node());
    let rows = rows.map(|row| (row.label().unwrap_or_default(), !row.is_disabled())).collect();
    close(console);
    rows
}

pub(super) fn titles(console: &mut Console) -> Vec<String> {
    rows(console).into_iter().map(|(title, _)| title).collect()
}

/// Types the name of the command and Enter, twice if it needs confirmation.
pub(super) fn choose(console: &mut Console, action: Action) {
    open(console);
    let title = &entry(action).title;
    write_into(console, FIELD, title);
    let row = console.get_by_role_and_label(Kind::MenuItem, title);
    assert!(!row.accesskit_node().is_disabled(), "{title} is greyed");
    console.key_press(Key::Enter);
    console.run_steps(2);
    if action.leads_to_force() {
        assert!(is_open(console), "{title} asks for confirmation");
        console.key_press(Key::Enter);
        console.run_steps(2);
    }
    console.run_steps(2);
    assert!(!is_open(console), "{title}");
}

/// Presses its first key.
pub(super) fn by_key(console: &mut Console, action: Action) {
    let stroke = entry(action).keys[0];
    console.key_press_modifiers(stroke.with.modifiers(), stroke.key);
    console.run_steps(4);
}

/// Checks that, from the same state, the palette has the same effect as the key or the button.
pub(super) fn alike(
    console: &mut Console,
    action: Action,
    reset: impl Fn(&mut Console),
    other: impl Fn(&mut Console),
    seen: impl Fn(&mut Console) -> String,
) -> Action {
    let again = |console: &mut Console| {
        reset(console);
        console.run_steps(3);
        seen(console)
    };
    let before = again(console);
    other(console);
    let by_other = seen(console);
    assert_ne!(before, by_other, "{action:?} changes nothing");
    assert_eq!(before, again(console), "{action:?}");
    choose(console, action);
    assert_eq!(by_other, seen(console), "{action:?}");
    again(console);
    action
}

pub(super) fn begin(folder: &Path, scene: &str) -> Console {
    let folder = folder.to_path_buf();
    let mut console =
        console_of(scene, SIZE, move |app| app.with_settings(toured(&folder)).with_store(&folder.join("calibrations")));
    until(&mut console, "any tick", |_| true);
    console.run_steps(3);
    console
}

/// Checks that all commands assigned to this test were tried.
pub(super) fn expect(done: &[Action], there: &str) {
    let all = table().iter().filter(|entry| tried_in(entry.action) == there);
    assert!(all.clone().next().is_some(), "nothing is tried in {there}");
    let missing: Vec<&str> =
        all.filter(|entry| !done.contains(&entry.action)).map(|entry| entry.title.as_str()).collect();
    assert!(missing.is_empty(), "not tried: {missing:?}");
}

/// Returns the test of a command. A command added to the table must be added here, or this does not compile.
const fn tried_in(action: Action) -> &'static str {
    match action {
        Action::View(_)
        | Action::Light(_)
        | Action::ColourBlind
        | Action::Touch
        | Action::Language(_)
        | Action::Larger
        | Action::Smaller
        | Action::Size(_)
        | Action::Panel(_)
        | Action::Window(_)
        | Action::Arrange(_)
        | Action::ResetLayout
        | Action::Sound
        | Action::ForcesOfNow
        | Action::RecordsPicture
        | Action::PlainPicture
        | Action::Draws(_) => "the View menu",
        Action::Glossary
        | Action::Alarms
        | Action::Rig
        | Action::Sessions
        | Action::Studies
        | Action::Tour
        | Action::Undo
        | Action::Redo
        | Action::Mark => "the top bar",
        Action::Stop | Action::Release | Action::Engage | Action::Pause | Action::LastTenSeconds => "stop and traces",
        Action::Acknowledge => "an alarm",
        Action::Check | Action::Calibrations | Action::Calibrate(_) | Action::CloseWizard => "the wizards",
        Action::HideForces | Action::Lens => "the endoscope",
        Action::Drive | Action::OtherHand | Action::Jaws => "driving",
        Action::MarkPlace | Action::EndTrial | Action::BeginTrial => "palpation",
        Action::LeavePast | Action::Play | Action::Step(_) => "the past",
        // Every test opens the palette with it.
        Action::Palette => "all",
        // Needs a session that is being recorded, so it is tested next to the code that keeps one.
        Action::Keep => "the console itself",
    }
}

#[test]
fn every_command_of_the_table_is_tried() {
    assert!(table().len() > 60 && table().iter().all(|entry| !tried_in(entry.action).is_empty()));
}

#[test]
fn escape_stops_while_the_palette_is_open_and_closes_it() {
    let folder = tempfile::tempdir().unwrap();
    let mut console = begin(folder.path(), "peg_transfer");
    until(&mut console, "engaged", |tick| tick.state == LoopState::Engaged);
    open(&mut console);
    console.key_press(Key::Escape);
    console.run_steps(2);
    until(&mut console, "stopped", |tick| tick.state == LoopState::Stopped);
    assert!(!is_open(&console));
    open(&mut console);
    press(&mut console, "Rig");
    assert!(!is_open(&console), "a click elsewhere closes it and does what it does");
    assert!(shows(&console, "1. Choose a rig"));
}

#[test]
fn arrows_choose_among_what_can_be_done_and_a_press_takes_it() {
    let folder = tempfile::tempdir().unwrap();
    let mut console = begin(folder.path(), "peg_transfer");
    open(&mut console);
    write_into(&mut console, FIELD, "view");
    console.key_press(Key::ArrowDown);
    console.run_steps(2);
    console.key_press(Key::ArrowDown);
    console.key_press(Key::Enter);
    console.run_steps(3);
    assert_eq!(console.state().role(), Role::Demo, "surgeon, technician, demo");
    open(&mut console);
    console.get_by_role_and_label(Kind::MenuItem, "View: Surgeon").click();
    console.run_steps(3);
    assert_eq!((console.state().role(), is_open(&console)), (Role::Surgeon, false));
}
