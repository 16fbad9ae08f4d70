//! Checks every view at three sizes, light and dark: no text is cut or overlaps another, nothing leaves the window, no two
//! controls overlap, every control has a name, and the stop button is in its place.

use std::{env, fmt::Write as _, fs, path::Path, time::Duration};

use eframe::App as _;
use egui::{Key, accesskit};
use egui_kittest::{
    Harness,
    kittest::{NodeT as _, Queryable as _},
};
use nima_console::console::{ConsoleApp, ConsoleOptions};
use nima_machine::messages::LoopState;
use nima_panels::{
    roles::Role,
    settings::SettingsStore,
    tiles::{Arrangement, PanelId, PanelLayout},
};
use nima_wizards::WizardKind;

use crate::{
    bench::{self, console_of, toured, until},
    faults::{Page, faults, none},
    playback, studies,
};

/// Points: the smallest window, the sizes of common screens, and with them those screens at a scale of 150 or 200 %.
const SIZES: [[f32; 2]; 4] = [[1100.0, 680.0], [1280.0, 720.0], [1920.0, 1080.0], [3840.0, 2160.0]];
/// A role, and the panels that are brought to the front: every panel is seen once.
pub(crate) const VIEWS: [(Role, &[PanelId]); 6] = [
    (Role::Surgeon, &[]),
    (Role::Technician, &[]),
    (Role::Technician, &[PanelId::Safety, PanelId::Calibrations, PanelId::Timing]),
    (Role::Technician, &[PanelId::ForceSpace, PanelId::Devices, PanelId::Tradeoff]),
    (Role::Technician, &[PanelId::Link, PanelId::Degrees]),
    (Role::Demo, &[]),
];

/// Faults in each view at each size, dark and light.
fn in_each_view(
    harness: &mut Harness<'_, ConsoleApp>,
    find: impl Fn(&mut Harness<'_, ConsoleApp>, Role, [f32; 2]) -> Vec<String>,
) -> Vec<String> {
    let mut all = Vec::new();
    for (role, front) in VIEWS {
        for size in SIZES {
            for light in [false, true] {
                let settings = harness.state_mut().settings_mut();
                settings.role = role;
                settings.light = light;
                settings.layout = PanelLayout { front: front.to_vec(), ..PanelLayout::default() };
                let found = find(harness, role, size);
                all.extend(
                    found.into_iter().map(|fault| format!("{role:?} {front:?} {size:?} light {light}: {fault}")),
                );
            }
        }
    }
    all
}

fn walk(scene: &str) {
    let mut harness = console_of(scene, SIZES[0], |app| app);
    until(&mut harness, "a contact", |tick| tick.t_s > 1.5);
    let all = in_each_view(&mut harness, |harness, role, size| faults(harness, size, Page::of_view(role)));
    none(&all);
}

#[test]
fn nothing_is_cut_or_overlaps_with_one_hand() {
    walk("peg_transfer");
}

#[test]
fn nothing_is_cut_or_overlaps_with_two_hands() {
    walk("bimanual");
}

#[test]
fn nothing_is_cut_or_overlaps_with_large_controls() {
    let mut harness = console_of("peg_transfer", SIZES[1], |app| app);
    let settings = harness.state_mut().settings_mut();
    settings.touch = true;
    settings.layout = PanelLayout::built_in(Arrangement::Simple);
    until(&mut harness, "a contact", |tick| tick.t_s > 1.5);
    let mut all = Vec::new();
    for role in [Role::Surgeon, Role::Technician, Role::Demo] {
        for size in [SIZES[1], SIZES[2]] {
            harness.state_mut().settings_mut().role = role;
            let found = faults(&mut harness, size, Page::of_view(role));
            all.extend(found.into_iter().map(|fault| format!("{role:?} {size:?}: {fault}")));
        }
    }
    none(&all);
}

#[test]
fn nothing_is_cut_or_overlaps_in_the_wizards() {
    let mut all = Vec::new();
    for which in WizardKind::ALL {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().to_path_buf();
        let options = ConsoleOptions { wizard: Some(which), ..ConsoleOptions::default() };
        let mut harness = console_of(which.scene().unwrap_or("peg_transfer"), SIZES[0], move |app| {
            app.with_store(&path).with_options(options)
        });
        until(&mut harness, "any tick", |_| true);
        for size in SIZES {
            let faults = faults(&mut harness, size, Page::Scrolls);
            all.extend(faults.into_iter().map(|fault| format!("{which:?} {size:?}: {fault}")));
        }
    }
    none(&all);
}

#[test]
fn nothing_is_cut_or_overlaps_on_the_start_page() {
    let mut harness = console_of("peg_transfer", SIZES[0], |app| app);
    until(&mut harness, "any tick", |_| true);
    bench::press(&mut harness, "Rig");
    let mut all = Vec::new();
    for size in SIZES {
        let faults = faults(&mut harness, size, Page::Scrolls);
        all.extend(faults.into_iter().map(|fault| format!("{size:?}: {fault}")));
    }
    none(&all);
}

#[test]
fn nothing_is_cut_or_overlaps_on_the_pages_of_a_study_and_in_a_trial() {
    let folder = tempfile::tempdir().unwrap();
    let rest = "[questionnaires]\nafter_condition = ['nasa_tlx_weighted', 'sus']\nat_end = ['free_text']";
    studies::make(folder.path(), "trials = 1", 2.0, rest);
    let mut harness = studies::console(folder.path(), ConsoleOptions::default());
    until(&mut harness, "any tick", |_| true);
    let mut all = Vec::new();
    let look = |harness: &mut Harness<'_, ConsoleApp>, page: &str, all: &mut Vec<String>| {
        for size in SIZES {
            for light in [false, true] {
                harness.state_mut().settings_mut().light = light;
                // The form scrolls, and on a small screen so does a questionnaire; content scrolled out of view has no
                // position.
                let is_form = page == "form" || page == "questionnaire" && size[1] < 1000.0;
                let faults = faults(harness, size, if is_form { Page::Form } else { Page::Scrolls });
                all.extend(faults.into_iter().map(|fault| format!("{page} {size:?} light {light}: {fault}")));
            }
        }
    };
    harness.key_press(Key::F8);
    harness.run_steps(2);
    look(&mut harness, "list", &mut all);
    bench::pick(&mut harness, "New study");
    look(&mut harness, "form", &mut all);
    bench::pick(&mut harness, "Create study");
    look(&mut harness, "new study", &mut all);
    bench::pick(&mut harness, "Close the study");
    bench::pick(&mut harness, "Open Touching");
    bench::pick(&mut harness, "a simulated hand");
    look(&mut harness, "study", &mut all);
    bench::pick(&mut harness, "Start the trial");
    bench::wait(&mut harness, "a trial", |harness| harness.state().in_trial());
    until(&mut harness, "idle", |tick| tick.state == LoopState::Idle);
    look(&mut harness, "trial", &mut all);
    bench::press(&mut harness, "Engage");
    bench::wait(&mut harness, "its end", |harness| !harness.state().in_trial());
    look(&mut harness, "after a trial", &mut all);
    bench::pick(&mut harness, "Fill in the questionnaire");
    look(&mut harness, "questionnaire", &mut all);
    none(&all);
}

#[test]
fn nothing_is_cut_or_overlaps_in_the_past_and_in_the_list_of_sessions() {
    let folder = tempfile::tempdir().unwrap();
    let data = folder.path().to_path_buf();
    let sessions = data.join("sessions");
    fs::create_dir_all(&sessions).unwrap();
    let path = sessions.join("20261123T131415Z-Simulated-rig.mcap");
    playback::record(&path, "bimanual", "3");
    let mut harness = console_of("peg_transfer", SIZES[0], move |app| app.with_settings(toured(&data)));
    until(&mut harness, "any tick", |_| true);
    let mut all = Vec::new();
    bench::press(&mut harness, "Sessions");
    playback::until_listed(&mut harness, "20261123T131415Z-Simulated-rig.mcap");
    for size in SIZES {
        let faults = faults(&mut harness, size, Page::Scrolls);
        all.extend(faults.into_iter().map(|fault| format!("list {size:?}: {fault}")));
    }
    bench::press(&mut harness, "Open 20261123T131415Z-Simulated-rig.mcap");
    playback::until_whole(&mut harness);
    all.extend(in_each_view(&mut harness, |harness, role, size| {
        // On a small screen, the technician's panels scroll more; content scrolled out of view has no position.
        let is_form = role == Role::Technician && size[1] < 1000.0;
        faults(harness, size, if is_form { Page::Form } else { Page::of_view(role) })
    }));
    none(&all);
}

#[test]
fn the_alarm_and_the_stopped_state_fit_too() {
    let mut harness = console_of("bimanual", SIZES[0], |app| app);
    until(&mut harness, "any tick", |_| true);
    bench::press(&mut harness, "Stop");
    let mut all = Vec::new();
    for dead in [false, true] {
        if dead {
            harness.state_mut().on_exit(None);
            std::thread::sleep(Duration::from_millis(600));
            bench::press(&mut harness, "Stop");
            harness.run_steps(3);
        }
        for (role, front) in VIEWS {
            for size in &SIZES[..2] {
                let settings = harness.state_mut().settings_mut();
                settings.role = role;
                settings.layout = PanelLayout { front: front.to_vec(), ..PanelLayout::default() };
                let faults = faults(&mut harness, *size, Page::of_view(role));
                all.extend(faults.into_iter().map(|fault| format!("{role:?} {front:?} dead {dead}: {fault}")));
            }
        }
        for key in [Key::F4, Key::F5] {
            harness.key_press(key);
            let faults = faults(&mut harness, SIZES[0], Page::Over);
            all.extend(faults.into_iter().map(|fault| format!("{key:?} dead {dead}: {fault}")));
            harness.key_press(key);
            harness.run_steps(2);
        }
        bench::press(&mut harness, "View");
        let faults = faults(&mut harness, SIZES[0], Page::Over);
        all.extend(faults.into_iter().map(|fault| format!("menu dead {dead}: {fault}")));
        bench::press(&mut harness, "View");
    }
    assert!(harness.query_by_label_contains("has stopped sending data").is_some());
    none(&all);
}

#[test]
fn a_scale_is_used_as_far_as_the_window_has_room() {
    let mut harness = console_of("free_motion", SIZES[0], |app| app);
    until(&mut harness, "any tick", |_| true);
    for (size, factor) in [(SIZES[3], 2.0), (SIZES[1], 720.0 / 680.0)] {
        harness.state_mut().settings_mut().scale_percent = 200;
        for _ in 0..4 {
            // The window's points are its pixels divided by the factor.
            let points = egui::Vec2::from(size) / harness.ctx.zoom_factor();
            harness.set_size(points);
            harness.step();
        }
        let now = harness.ctx.zoom_factor();
        assert!((now - factor).abs() < 0.01, "{now} at {size:?}");
    }
}

#[test]
fn tour_and_glossary_fit_and_leave_the_stop_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().to_path_buf();
    let begin = |path: std::path::PathBuf| {
        console_of("peg_transfer", SIZES[0], move |app| app.with_settings(SettingsStore::open(&path)))
    };
    let mut harness = begin(path.clone());
    until(&mut harness, "any tick", |_| true);
    bench::press(&mut harness, "Continue with the simulated rig");
    let back = |harness: &Harness<'_, ConsoleApp>| harness.get_by_label("Step back").rect();
    harness.run_steps(4);
    let place = back(&harness);
    for button in ["Next step", "Next step", "Step back", "Next step", "Next step"] {
        assert!(harness.query_by_role_and_label(accesskit::Role::Button, "Stop").is_some());
        bench::press(&mut harness, button);
        harness.run_steps(4);
        let now = back(&harness);
        assert!(
            (now.center() - place.center()).length() < 1.5,
            "the buttons stay under the pointer: {place:?} {now:?}"
        );
    }
    bench::press(&mut harness, "Stop");
    until(&mut harness, "stopped during the tour", |tick| tick.state == LoopState::Stopped);
    bench::press(&mut harness, "Start");
    assert!(harness.query_by_label("Start").is_none());
    harness.key_press(egui::Key::F4);
    harness.run_steps(3);
    let entry = harness.get_by_label("Prediction horizon").rect();
    let stop = harness.get_by_role_and_label(accesskit::Role::Button, "Stop").rect();
    assert!(entry.top() > stop.bottom());
    harness.key_press(egui::Key::F4);
    harness.run_steps(3);
    assert!(harness.query_by_label("Prediction horizon").is_none());
    drop(harness);
    let mut again = begin(path);
    again.run_steps(3);
    assert!(again.query_by_label("Next step").is_none(), "the tour is for the first time");
}

/// Returns the kind and name of every control, in keyboard order, without digits, because numbers change.
fn controls(harness: &Harness<'_, ConsoleApp>) -> String {
    let operated = |kind: accesskit::Role| {
        matches!(
            kind,
            accesskit::Role::Button
                | accesskit::Role::CheckBox
                | accesskit::Role::RadioButton
                | accesskit::Role::Slider
        )
    };
    let mut text = String::new();
    for node in harness.get_all_by(move |node| operated(node.role())) {
        let node = node.accesskit_node();
        let name: String = node.label().unwrap_or_default().chars().filter(|letter| !letter.is_ascii_digit()).collect();
        // Whether there is an alarm depends on the computer: there is one if a real-time thread is not permitted.
        if !(name.starts_with("All alarms") || name.starts_with("Acknowledge")) {
            writeln!(text, "{:?}: {}", node.role(), name.lines().next().unwrap_or_default()).unwrap();
        }
    }
    text
}

/// A lost, renamed or new control shows up in review. `UPDATE_SNAPSHOTS=1` rewrites the files.
#[test]
fn every_view_offers_what_was_agreed() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/screen/stored");
    for (role, name) in [(Role::Surgeon, "surgeon"), (Role::Technician, "technician"), (Role::Demo, "demo")] {
        let mut harness = console_of("bimanual", [1600.0, 1000.0], move |app| {
            app.with_options(ConsoleOptions { role: Some(role), ..ConsoleOptions::default() })
        });
        until(&mut harness, "engaged", |tick| tick.state == LoopState::Engaged);
        harness.run_steps(5);
        let now = controls(&harness);
        let path = folder.join(format!("{name}.txt"));
        if env::var_os("UPDATE_SNAPSHOTS").is_some() {
            fs::create_dir_all(&folder).unwrap();
            fs::write(&path, &now).unwrap();
        }
        let agreed = fs::read_to_string(&path).unwrap_or_default();
        assert_eq!(now, agreed, "{}: if this is meant, run with UPDATE_SNAPSHOTS=1", path.display());
    }
}
