//! The window for users without sight or mouse: every control has a name, the keyboard visits controls in reading order, and
//! plots have a text.

use egui::{Key, Modifiers, Rect, accesskit::Role as Kind};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use nima_console::console::ConsoleOptions;
use nima_machine::messages::LoopState;
use nima_panels::{
    roles::Role,
    tiles::{PanelId, PanelLayout},
};
use nima_wizards::WizardKind;

use crate::{
    bench::{Console, console_of, pick, press, toured, until, wait},
    playback, studies,
    walk::VIEWS,
};

const SIZE: [f32; 2] = [1600.0, 1000.0];

fn begin(scene: &str, folder: &std::path::Path) -> Console {
    let folder = folder.to_path_buf();
    let mut console = console_of(scene, SIZE, move |app| app.with_settings(toured(&folder)));
    until(&mut console, "any tick", |_| true);
    console.run_steps(3);
    console
}

/// Nodes with an action or focus and without a name; a scroll bar is identified by its content.
fn nameless(console: &Console) -> Vec<String> {
    use egui::accesskit::Action::{Click, Focus, Increment, SetValue};
    let is_operated =
        |node: &egui::accesskit::Node| [Click, Focus, Increment, SetValue].iter().any(|it| node.supports_action(*it));
    let mut count = 0;
    let mut wrong = Vec::new();
    for node in console.query_all_by(|_| true) {
        let node = node.accesskit_node();
        if !is_operated(node.data())
            || matches!(node.role(), Kind::Window | Kind::Unknown | Kind::GenericContainer | Kind::ScrollBar)
        {
            continue;
        }
        count += 1;
        let named = |text: Option<String>| text.is_some_and(|text| !text.trim().is_empty());
        let has_hint = node.data().placeholder().is_some_and(|hint| !hint.trim().is_empty());
        if !named(node.label()) && !has_hint {
            wrong.push(format!("{:?} at {:?}", node.role(), node.raw_bounds()));
        }
    }
    // A trial has the fewest controls: abort, engage and stop.
    assert!(count >= 3, "only {count} nodes can be operated");
    wrong
}

/// Controls without a name are reported with their place.
fn look(console: &mut Console, place: &str, all: &mut Vec<String>) {
    console.run_steps(3);
    all.extend(nameless(console).into_iter().map(|node| format!("{place}: {node}")));
}

fn report(all: &[String]) {
    assert!(all.is_empty(), "{} without a name:\n{}", all.len(), all.join("\n"));
}

#[test]
fn everything_in_every_view_has_a_name() {
    let folder = tempfile::tempdir().unwrap();
    let mut all = Vec::new();
    for scene in ["bimanual", "rings"] {
        let mut console = begin(scene, folder.path());
        for (role, front) in VIEWS {
            let settings = console.state_mut().settings_mut();
            settings.role = role;
            settings.layout = PanelLayout { front: front.to_vec(), ..PanelLayout::default() };
            look(&mut console, &format!("{role:?} {front:?}"), &mut all);
        }
    }
    report(&all);
}

#[test]
fn everything_on_every_page_and_in_every_list_has_a_name() {
    let folder = tempfile::tempdir().unwrap();
    studies::make(folder.path(), "trials = 1", 6.0, "");
    let mut console = studies::console(folder.path(), ConsoleOptions::default());
    until(&mut console, "any tick", |_| true);
    let mut all = Vec::new();
    for role in Role::ALL {
        console.state_mut().settings_mut().role = role;
        for key in [Key::F4, Key::F5, Key::F6, Key::F7, Key::F8] {
            console.key_press(key);
            look(&mut console, &format!("{role:?} {key:?}"), &mut all);
            console.key_press(key);
            console.run_steps(2);
        }
        press(&mut console, "View");
        look(&mut console, &format!("{role:?} menu"), &mut all);
        press(&mut console, "View");
        console.key_press_modifiers(Modifiers::COMMAND, Key::P);
        look(&mut console, &format!("{role:?} palette"), &mut all);
        console.key_press_modifiers(Modifiers::COMMAND, Key::P);
        console.run_steps(2);
    }
    console.key_press(Key::F8);
    console.run_steps(2);
    pick(&mut console, "New study");
    look(&mut console, "form of a study", &mut all);
    pick(&mut console, "Back");
    console.run_steps(2);
    console.key_press(Key::F8);
    console.run_steps(2);
    studies::open(&mut console);
    look(&mut console, "study", &mut all);
    studies::begin(&mut console, "Start the trial");
    look(&mut console, "trial", &mut all);
    wait(&mut console, "its end", |console| !console.state().in_trial());
    report(&all);
}

#[test]
fn everything_in_every_wizard_and_in_the_past_has_a_name() {
    let folder = tempfile::tempdir().unwrap();
    let mut all = Vec::new();
    for which in WizardKind::ALL {
        let path = folder.path().to_path_buf();
        let options = ConsoleOptions { wizard: Some(which), ..ConsoleOptions::default() };
        let mut console = console_of(which.scene().unwrap_or("peg_transfer"), SIZE, move |app| {
            app.with_store(&path).with_options(options)
        });
        until(&mut console, "any tick", |_| true);
        look(&mut console, &format!("{which:?}"), &mut all);
    }
    let mut console = begin("peg_transfer", folder.path());
    for page in ["Ready check…", "Set-up…"] {
        pick(&mut console, page);
        look(&mut console, page, &mut all);
        pick(&mut console, "Back to the monitor");
    }
    let path = folder.path().join("session.mcap");
    playback::record(&path, "bimanual", "3");
    let mut console = console_of("peg_transfer", SIZE, move |app| app.with_session(&path));
    playback::until_whole(&mut console);
    look(&mut console, "past", &mut all);
    report(&all);
}

/// Returns the names and positions of the controls in the order of the Tab key from the first one.
fn stops(console: &mut Console) -> Vec<(String, Rect)> {
    let focused = |console: &Console| {
        let node = console.query_all_by(|node| node.is_focused() && node.role() != Kind::Window).next()?;
        Some((node.accesskit_node().label().unwrap_or_default(), node.rect()))
    };
    // Remove the previous focus.
    if let Some(id) = console.ctx.memory(egui::Memory::focused) {
        console.ctx.memory_mut(|memory| memory.surrender_focus(id));
    }
    let mut stops: Vec<(String, Rect)> = Vec::new();
    for _ in 0..120 {
        console.key_press(Key::Tab);
        console.run_steps(2);
        let Some(stop) = focused(console) else { continue };
        if stops.first() == Some(&stop) {
            break;
        }
        stops.push(stop);
    }
    stops
}

/// Returns whether `next` may follow: below, at the right in the same row, or at the top of the next column.
fn follows(last: Rect, next: Rect) -> bool {
    const SLACK: f32 = 2.0;
    let above = next.bottom() <= last.top() + SLACK;
    let same_row = next.top() < last.bottom() - SLACK && last.top() < next.bottom() - SLACK;
    let at_the_left = next.right() <= last.left() + SLACK;
    let at_the_right = next.left() >= last.right() - SLACK;
    !(above && !at_the_right || same_row && at_the_left)
}

/// Neighbours in keyboard order that differ from reading order; only within `room`.
fn disorder(stops: &[(String, Rect)], room: Rect) -> Vec<String> {
    let inside: Vec<&(String, Rect)> = stops.iter().filter(|(_, place)| room.contains(place.center())).collect();
    let wrong = inside.windows(2).filter(|pair| !follows(pair[0].1, pair[1].1));
    wrong.map(|pair| format!("{:?} before {:?}", pair[0], pair[1])).collect()
}

#[test]
fn the_keyboard_goes_through_the_top_bar_and_every_panel_as_they_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let mut console = begin("bimanual", folder.path());
    // The step button next to the stop button is enabled only after a stop.
    press(&mut console, "Stop");
    until(&mut console, "stopped", |tick| tick.state == LoopState::Stopped);
    console.run_steps(30);
    let bar = Rect::from_min_max(egui::pos2(0.0, 0.0), egui::pos2(SIZE[0], 72.0));
    let page = Rect::from_min_max(egui::pos2(0.0, 72.0), SIZE.into());
    // The strip below the field in the Surgeon view.
    let strip = Rect::from_min_max(egui::pos2(0.0, 824.0), SIZE.into());
    let mut wrong = Vec::new();
    let mut count = 0;
    for panel in PanelId::ALL {
        // Show it alone, so that everything below the bar belongs to this panel.
        let closed = PanelId::ALL.into_iter().filter(|other| *other != panel).collect();
        console.state_mut().settings_mut().layout = PanelLayout { closed, ..PanelLayout::default() };
        console.run_steps(4);
        let stops = stops(&mut console);
        assert!(stops.iter().any(|(name, _)| *name == format!("Close {}", panel.title())), "{panel:?}: {stops:?}");
        count += stops.len();
        wrong.extend(disorder(&stops, page).into_iter().map(|pair| format!("{panel:?}: {pair}")));
        if panel == PanelId::Field {
            assert!(stops.iter().any(|(name, _)| name == "Release stop"), "{stops:?}");
            wrong.extend(disorder(&stops, bar).into_iter().map(|pair| format!("top bar: {pair}")));
        }
    }
    for role in [Role::Surgeon, Role::Demo] {
        console.state_mut().settings_mut().role = role;
        console.run_steps(4);
        let stops = stops(&mut console);
        count += stops.len();
        if role == Role::Surgeon {
            wrong.extend(disorder(&stops, strip).into_iter().map(|pair| format!("{role:?}: {pair}")));
        }
    }
    assert!(count > 150, "{count} stops");
    assert!(wrong.is_empty(), "{} are read in another order:\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn the_traces_tell_the_forces_in_words() {
    let folder = tempfile::tempdir().unwrap();
    let mut console = begin("peg_transfer", folder.path());
    until(&mut console, "a contact", |tick| tick.t_s > 4.0 && tick.measured_n.z > 0.5);
    press(&mut console, "Pause");
    for axis in ["x", "y", "z"] {
        let name = format!("Force along {axis}, right hand");
        let plot = console.get_by_label(&name).accesskit_node().data().description().map(str::to_owned).unwrap();
        assert!(plot.starts_with("Measured ") && plot.contains("; rendered "), "{plot}");
        let numbers: Vec<f64> = plot
            .split(' ')
            .filter_map(|word| word.trim_start_matches('+').replace('\u{2212}', "-").parse().ok())
            .collect();
        let [now_n, max_n, seconds, rendered_n, rendered_max_n, _] = numbers[..] else { panic!("{plot}") };
        assert!(now_n.abs() <= max_n + 0.06 && rendered_n.abs() <= rendered_max_n + 0.06, "{plot}");
        assert!((seconds - 10.0).abs() < 1e-9, "{plot}");
        if axis == "z" {
            assert!(max_n > 0.4, "it was in contact: {plot}");
        }
    }
}
