//! Every role, panel, page and first page of a wizard looks like its stored image. Tests that go through the wizards
//! compare their later pages.

use std::{path::Path, time::Duration};

use egui::{Key, Modifiers};
use nima_console::console::ConsoleOptions;
use nima_panels::{roles::Role, settings::SettingsStore, tiles::PanelLayout};
use nima_simulation::SimulationPlan;
use nima_tests::plan;
use nima_wizards::WizardKind;

use crate::{
    bench::{Console, comes, console_of, pick, press, read, shown, shows, toured, until, wait},
    faults::none,
    image, playback,
    walk::VIEWS,
};

const SIZE: [f32; 2] = [1600.0, 1000.0];
/// The moment of the recorded session, s: late enough that the traces extend beyond their plots.
const SHOWN_S: f64 = 12.5;

/// A moment of a session on the virtual clock, which is the same on every computer.
#[test]
fn every_role_and_panel_looks_as_stored() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("session.mcap");
    playback::record(&path, "bimanual", "13");
    let mut console = console_of("bimanual", SIZE, move |app| app.with_session(&path));
    playback::until_whole(&mut console);
    wait(&mut console, "the session is read", |console| !shows(console, "% read"));
    console.state_mut().show_past(SHOWN_S);
    console.step();
    wait(&mut console, "the moment", |console| {
        console.state().past().is_some_and(|(_, t_s)| (t_s - SHOWN_S).abs() < 1e-9)
    });
    playback::until_whole(&mut console);
    // Parts that were first drawn from recorded plots are later drawn from the replay.
    comes(&mut console, Duration::from_secs(1), |_| false);
    let mut all = Vec::new();
    for (role, front) in VIEWS {
        for light in [false, true] {
            let settings = console.state_mut().settings_mut();
            settings.role = role;
            settings.light = light;
            settings.layout = PanelLayout { front: front.to_vec(), ..PanelLayout::default() };
            console.run_steps(4);
            let panels: Vec<_> = front.iter().map(|panel| format!("-{panel:?}")).collect();
            let name = format!("{role:?}{}{}", panels.concat(), if light { "-light" } else { "" });
            // One image in light colours is enough for a role.
            if !light || front.is_empty() {
                all.extend(image::differs(&mut console, &name.to_lowercase()));
            }
        }
    }
    none(&all);
}

#[test]
fn the_first_page_of_every_wizard_looks_as_stored() {
    let mut all = Vec::new();
    for which in WizardKind::ALL {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().to_path_buf();
        let options = ConsoleOptions { wizard: Some(which), ..ConsoleOptions::default() };
        let plan = SimulationPlan { engage: false, ..plan(which.scene().unwrap_or("peg_transfer")) };
        let mut console = shown(&plan, SIZE, move |app| app.with_store(&path).with_options(options));
        until(&mut console, "a second", |tick| tick.t_s > 1.0);
        console.run_steps(4);
        let name = format!("wizard-{which:?}").replace(['(', ')'], "-").to_lowercase();
        all.extend(image::differs(&mut console, name.trim_end_matches('-')));
    }
    none(&all);
}

fn idle(folder: &Path) -> Console {
    let folder = folder.to_path_buf();
    let plan = SimulationPlan { engage: false, ..plan("peg_transfer") };
    // The Surgeon view is the calmest background for windows that open over it.
    let options = ConsoleOptions { role: Some(Role::Surgeon), ..ConsoleOptions::default() };
    let mut console = shown(&plan, SIZE, move |app| app.with_settings(toured(&folder)).with_options(options));
    until(&mut console, "a second", |tick| tick.t_s > 1.0);
    console
}

#[test]
fn every_page_and_list_looks_as_stored() {
    let folder = tempfile::tempdir().unwrap();
    let mut console = idle(folder.path());
    let mut all = Vec::new();
    for (key, modifiers, name) in [
        (Key::F4, Modifiers::NONE, "glossary"),
        (Key::F7, Modifiers::NONE, "sessions"),
        (Key::F8, Modifiers::NONE, "studies"),
        (Key::P, Modifiers::COMMAND, "palette"),
    ] {
        console.key_press_modifiers(modifiers, key);
        console.run_steps(4);
        if name == "sessions" {
            read(&mut console, "No session has been recorded yet");
        }
        all.extend(image::differs(&mut console, name));
        console.key_press_modifiers(modifiers, key);
        console.run_steps(2);
    }
    console.state_mut().settings_mut().role = Role::Technician;
    console.run_steps(2);
    for (page, name) in [("Ready check\u{2026}", "ready-check"), ("Set-up\u{2026}", "calibrations")] {
        pick(&mut console, page);
        if name == "ready-check" {
            read(&mut console, "the wrist sensor is not calibrated");
        }
        console.run_steps(4);
        all.extend(image::differs(&mut console, name));
        pick(&mut console, "Back to the monitor");
    }
    press(&mut console, "Rig");
    console.run_steps(4);
    all.extend(image::differs(&mut console, "start"));
    none(&all);
}

#[test]
fn the_first_page_looks_as_stored() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().to_path_buf();
    let plan = SimulationPlan { engage: false, ..plan("peg_transfer") };
    let options = ConsoleOptions { role: Some(Role::Surgeon), ..ConsoleOptions::default() };
    let mut console =
        shown(&plan, SIZE, move |app| app.with_settings(SettingsStore::open(&path)).with_options(options));
    until(&mut console, "a second", |tick| tick.t_s > 1.0);
    image::same(&mut console, "welcome");
}
