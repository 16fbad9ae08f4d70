//! The start page: another rig and another scene without leaving the program.

use std::path::Path;

use egui::{Key, accesskit::Role};
use egui_kittest::{Harness, kittest::Queryable as _};
use nima_console::console::ConsoleApp;
use nima_machine::messages::LoopState;
use nima_panels::{rig_choice::RigChoice, settings::SettingsStore};

use crate::{
    bench::{console_of, pick, press, read, toured, until, wait, write_into},
    endoscope_view::camera,
};

const SIZE: [f32; 2] = [1600.0, 1000.0];

fn console(folder: &Path) -> Harness<'static, ConsoleApp> {
    let folder = folder.to_path_buf();
    let mut harness = console_of("peg_transfer", SIZE, move |app| app.with_settings(toured(&folder)));
    until(&mut harness, "engaged", |tick| tick.state == LoopState::Engaged);
    harness
}

fn until_runs(harness: &mut Harness<'_, ConsoleApp>, rig: &str, scene: &str) {
    let wanted = RigChoice { rig: rig.to_owned(), scene: scene.to_owned() };
    wait(harness, &format!("{wanted:?} runs"), |harness| *harness.state().running() == wanted);
}

#[test]
fn another_scene_and_another_rig_start_idle_and_are_offered_again() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = console(folder.path());
    harness.key_press(Key::F6);
    harness.step();
    // Picked by name: the list of connected devices appears a moment later and moves the page under the pointer.
    pick(&mut harness, "Two hands on soft tissue");
    pick(&mut harness, "Start");
    until_runs(&mut harness, "simulated", "bimanual");
    until(&mut harness, "idle: only the operator engages", |tick| tick.state == LoopState::Idle);
    press(&mut harness, "Engage");
    until(&mut harness, "engaged", |tick| tick.state == LoopState::Engaged);

    press(&mut harness, "Rig");
    pick(&mut harness, "Desk rig");
    pick(&mut harness, "Free motion");
    pick(&mut harness, "Start");
    until_runs(&mut harness, "desk", "free_motion");
    assert_eq!(harness.state().rig().name, "Desk rig");
    press(&mut harness, "Rig");
    pick(&mut harness, "Simulated rig, Two hands on soft tissue");
    pick(&mut harness, "Start");
    until_runs(&mut harness, "simulated", "bimanual");

    let recent = SettingsStore::open(folder.path()).now.recent;
    let recent: Vec<_> = recent.iter().map(|choice| (choice.rig.as_str(), choice.scene.as_str())).collect();
    assert_eq!(recent, [("simulated", "bimanual"), ("desk", "free_motion"), ("simulated", "peg_transfer")]);
}

#[test]
fn the_handle_that_leads_a_simulated_rig_is_looked_for_before_it_is_started() {
    let folder = tempfile::tempdir().unwrap();
    let rig = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../config/rigs/haply-desk.toml")).unwrap();
    let rig = rig.replace("/dev/ttyACM0", "/dev/no-such-port").replace("Haply desk", "My handle");
    std::fs::create_dir_all(folder.path().join("rigs")).unwrap();
    std::fs::write(folder.path().join("rigs/my-handle.toml"), rig).unwrap();
    let mut harness = console(folder.path());
    press(&mut harness, "Rig");
    assert!(harness.query_by_label("Check the devices").is_none());
    pick(&mut harness, "My handle");
    pick(&mut harness, "Check the devices");
    wait(&mut harness, "it is missing", |harness| harness.query_by_label_contains("/dev/no-such-port").is_some());
}

#[test]
fn a_rig_is_made_from_another_and_used() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = console(folder.path());
    press(&mut harness, "Rig");
    pick(&mut harness, "Copy the chosen rig");
    harness.get_by_label_contains("Enter a name");
    let field = harness.get_by_role_and_label(Role::TextInput, "Name of a new rig");
    field.focus();
    harness.step();
    harness.get_by_role_and_label(Role::TextInput, "Name of a new rig").type_text("Theatre 3");
    harness.step();
    pick(&mut harness, "Copy the chosen rig");
    let path = folder.path().join("rigs/theatre-3.toml");
    assert!(path.exists());
    pick(&mut harness, "Start");
    until_runs(&mut harness, path.to_str().unwrap(), "peg_transfer");
    assert_eq!(harness.state().rig().name, "Theatre 3");
}

#[test]
fn what_cannot_start_is_told_and_what_ran_before_runs_again() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = console(folder.path());
    // The scene needs a wrist sensor, which this rig does not have.
    let rig = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../config/rigs/simulated.toml")).unwrap();
    let bare = rig.split("[simulated.right]").next().unwrap().replace("Simulated rig", "Bare rig");
    std::fs::create_dir_all(folder.path().join("rigs")).unwrap();
    let path = folder.path().join("rigs/bare.toml");
    std::fs::write(&path, bare).unwrap();
    press(&mut harness, "Rig");
    pick(&mut harness, "Bare rig");
    std::fs::remove_file(&path).unwrap();
    pick(&mut harness, "Start");
    harness.get_by_label_contains("Not started: unknown rig");
    assert_eq!(harness.state().running(), &RigChoice::default());
    pick(&mut harness, "Back");
    until(&mut harness, "it was never ended", |tick| tick.state == LoopState::Engaged);
}

#[test]
fn a_stop_on_the_start_page_stops() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = console(folder.path());
    press(&mut harness, "Rig");
    press(&mut harness, "Stop");
    until(&mut harness, "stopped", |tick| tick.state == LoopState::Stopped);
    harness.key_press(Key::F2);
    harness.run_steps(2);
    assert!(harness.query_by_label("1. Choose a rig").is_none(), "a view's key leaves the page");
}

const ADDRESS: &str = "Address of the endoscope";
const WRITE: &str = "Write this address to the rig";

/// Replaces the address by typing.
fn type_address(harness: &mut Harness<'_, ConsoleApp>, address: &str) {
    harness.get_by_role_and_label(Role::TextInput, ADDRESS).focus();
    harness.step();
    harness.key_press_modifiers(egui::Modifiers::COMMAND, Key::A);
    harness.step();
    write_into(harness, ADDRESS, address);
}

#[test]
fn an_endoscope_is_tried_while_its_address_is_typed_and_written_without_editing_a_file() {
    let (serving, _) = camera();
    let folder = tempfile::tempdir().unwrap();
    let mut harness = console(folder.path());
    press(&mut harness, "Rig");
    harness.get_by_label_contains("None: the Surgeon view draws the field");
    for (address, cause, cure) in [
        ("http://127.0.0.1:1/", "no response from 127.0.0.1:1", "Correct the port"),
        ("/no/such/film.mjpeg", "no such file", "Put the file there"),
        ("ftp://127.0.0.1/", "No image:", "Enter http://HOST:PORT/PATH"),
    ] {
        type_address(&mut harness, address);
        read(&mut harness, cause);
        read(&mut harness, cure);
    }
    type_address(&mut harness, &serving.endpoint);
    read(&mut harness, "Sends 640 x 360 pixels");
    pick(&mut harness, WRITE);
    let path = folder.path().join("rigs/simulated-2.toml");
    read(&mut harness, "simulated-2.toml. Start the rig to use the address.");
    assert!(std::fs::read_to_string(&path).unwrap().contains(&serving.endpoint));
    pick(&mut harness, "Start");
    until_runs(&mut harness, path.to_str().unwrap(), "peg_transfer");
    assert_eq!(harness.state().rig().endoscope.as_ref().unwrap().url, serving.endpoint);
    // The running rig's image is not opened a second time.
    press(&mut harness, "Rig");
    read(&mut harness, "live");
    type_address(&mut harness, " ");
    pick(&mut harness, "Remove the endoscope from the rig");
    assert!(!std::fs::read_to_string(&path).unwrap().contains("endoscope"));
}

/// Returns the console at its first start.
fn newcomer(folder: &Path, size: [f32; 2]) -> Harness<'static, ConsoleApp> {
    let folder = folder.to_path_buf();
    let mut harness = console_of("peg_transfer", size, move |app| app.with_settings(SettingsStore::open(&folder)));
    until(&mut harness, "engaged", |tick| tick.state == LoopState::Engaged);
    harness
}

const WAYS: [(&str, &str); 3] = [
    ("Continue with the simulated rig", "Next step"),
    ("Watch the demonstration", "What you see"),
    ("Choose or create your own rig", "1. Choose a rig"),
];

#[test]
fn the_first_page_says_what_this_is_and_leads_three_ways() {
    for (way, shown) in WAYS {
        let folder = tempfile::tempdir().unwrap();
        let mut harness = newcomer(folder.path(), SIZE);
        for words in ["Haptic teleoperation in laparoscopy", "never use it on patients"] {
            harness.get_by_label_contains(words);
        }
        press(&mut harness, way);
        read(&mut harness, shown);
        assert!(harness.query_by_label(way).is_none(), "{way}: the first page is closed");
        until(&mut harness, "the running loop continues", |tick| tick.state == LoopState::Engaged);
    }
}

#[test]
fn the_first_page_comes_once_and_not_over_another_page() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = newcomer(folder.path(), SIZE);
    harness.key_press(Key::F6);
    harness.run_steps(2);
    assert!(harness.query_by_label(WAYS[0].0).is_none(), "not over the start page");
    harness.key_press(Key::F6);
    harness.run_steps(2);
    press(&mut harness, "Watch the demonstration");
    harness.run_steps(2);
    drop(harness);
    let harness = newcomer(folder.path(), SIZE);
    assert!(WAYS.iter().all(|(way, _)| harness.query_by_label(way).is_none()));
}

#[test]
fn the_first_page_is_closed_by_the_start_of_another_rig() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = newcomer(folder.path(), SIZE);
    harness.key_press(Key::F6);
    harness.step();
    pick(&mut harness, "Two hands on soft tissue");
    pick(&mut harness, "Start");
    until_runs(&mut harness, "simulated", "bimanual");
    harness.run_steps(3);
    assert!(WAYS.iter().all(|(way, _)| harness.query_by_label(way).is_none()));
}

#[test]
fn the_first_page_fits_the_smallest_window_below_the_stop() {
    let folder = tempfile::tempdir().unwrap();
    let size = [1100.0, 680.0];
    let mut harness = newcomer(folder.path(), size);
    harness.run_steps(3);
    let stop = harness.get_by_role_and_label(Role::Button, "Stop").rect();
    for (way, _) in WAYS {
        let button = harness.get_by_role_and_label(Role::Button, way).rect();
        assert!(button.top() > stop.bottom() && button.bottom() < size[1] && button.left() > 0.0, "{way}: {button:?}");
    }
    press(&mut harness, "Stop");
    until(&mut harness, "stopped", |tick| tick.state == LoopState::Stopped);
}
