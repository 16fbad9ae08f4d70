//! The layout of the Technician view by mouse and by names: tiles are dragged, closed, reopened and reset, and the layout is
//! restored at the next start.

use std::path::Path;

use egui::{
    Rect,
    accesskit::{Role, Toggled},
    vec2,
};
use egui_kittest::{
    Harness,
    kittest::{NodeT as _, Queryable as _},
};
use nima_console::console::ConsoleApp;
use nima_machine::messages::LoopState;
use nima_panels::{
    settings::SettingsStore,
    tiles::{Arrangement, LayoutNode, PanelId, PanelLayout},
};

use crate::bench::{console_of, pick, press, toured, until, write_into};

const SIZE: [f32; 2] = [1600.0, 1000.0];

fn console(folder: &Path) -> Harness<'static, ConsoleApp> {
    let path = folder.to_path_buf();
    let mut harness = console_of("peg_transfer", SIZE, move |app| app.with_settings(toured(&path)));
    until(&mut harness, "any tick", |_| true);
    harness.run_steps(3);
    harness
}

fn tab(harness: &Harness<'_, ConsoleApp>, panel: PanelId) -> Rect {
    harness.get_by_role_and_label(Role::Button, panel.title()).rect()
}

fn drag(harness: &mut Harness<'_, ConsoleApp>, from: egui::Pos2, to: egui::Pos2) {
    harness.drag_at(from);
    harness.step();
    for fraction in [0.3, 0.7, 1.0, 1.0] {
        harness.hover_at(from + (to - from) * fraction);
        harness.step();
    }
    harness.drop_at(to);
    harness.run_steps(3);
}

fn layout_of(harness: &mut Harness<'_, ConsoleApp>) -> PanelLayout {
    harness.state_mut().settings_mut().layout.clone()
}

/// Returns the panels in the same group of tabs as this one.
fn beside(node: &LayoutNode, panel: PanelId) -> Option<Vec<PanelId>> {
    match node {
        LayoutNode::Panel(_) => None,
        LayoutNode::Tabs(of) => {
            let panels: Vec<PanelId> = of
                .iter()
                .filter_map(|node| if let LayoutNode::Panel(panel) = node { Some(*panel) } else { None })
                .collect();
            if panels.contains(&panel) { Some(panels) } else { of.iter().find_map(|node| beside(node, panel)) }
        }
        LayoutNode::Row(parts) | LayoutNode::Column(parts) => parts.iter().find_map(|part| beside(&part.of, panel)),
    }
}

#[test]
fn a_dragged_title_joins_other_tabs_and_stays_there_the_next_day() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = console(folder.path());
    let from = tab(&harness, PanelId::Timing);
    let to = tab(&harness, PanelId::Degrees);
    drag(&mut harness, from.center(), to.center() + vec2(0.6 * to.width(), 0.0));
    let places = layout_of(&mut harness).places.unwrap();
    assert!(beside(&places, PanelId::Timing).unwrap().contains(&PanelId::Degrees), "{places:?}");
    assert!(harness.query_by_label_contains("Wake-up histogram: ").is_some(), "what was dragged is in front");
    drop(harness);
    let mut again = console(folder.path());
    assert_eq!(layout_of(&mut again).places, Some(places));
    let timing = tab(&again, PanelId::Timing);
    let degrees = tab(&again, PanelId::Degrees);
    assert!((timing.center().y - degrees.center().y).abs() < 1.0);
}

#[test]
fn an_edge_is_dragged_and_the_default_comes_back() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = console(folder.path());
    let field = |harness: &Harness<'_, ConsoleApp>| harness.get_by_label("Operating field").rect();
    let before = field(&harness);
    let edge = before.left_center() - vec2(3.0, 0.0);
    drag(&mut harness, edge, edge + vec2(120.0, 0.0));
    let after = field(&harness);
    assert!((after.left() - before.left() - 120.0).abs() < 4.0, "{before:?} {after:?}");
    assert!(layout_of(&mut harness).places.is_some());
    press(&mut harness, "View");
    pick(&mut harness, "Reset layout");
    harness.run_steps(2);
    assert_eq!(layout_of(&mut harness).places, None);
    assert!((field(&harness).left() - before.left()).abs() < 1.0);
}

#[test]
fn a_panel_is_closed_and_opened_from_the_menu_and_its_neighbours_take_the_room() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = console(folder.path());
    let before = harness.get_by_label("Operating field").rect();
    press(&mut harness, "Close Traces");
    press(&mut harness, "Close Force space");
    press(&mut harness, "Close Safety");
    harness.run_steps(2);
    let after = harness.get_by_label("Operating field").rect();
    assert!(after.height() > 1.5 * before.height(), "{before:?} {after:?}");
    press(&mut harness, "View");
    press(&mut harness, "Traces");
    harness.run_steps(2);
    let mut layout = layout_of(&mut harness);
    layout.closed.sort_unstable();
    assert_eq!((layout.places, layout.closed), (None, vec![PanelId::ForceSpace, PanelId::Safety]));
    drop(harness);
    let mut again = console(folder.path());
    assert!(again.query_by_role_and_label(Role::Button, "Close Traces").is_some());
    assert!(again.query_by_role_and_label(Role::Button, "Close Force space").is_none());
    for panel in PanelId::ALL {
        let layout = &mut again.state_mut().settings_mut().layout;
        if layout.is_open(panel) {
            layout.toggle(panel);
        }
    }
    again.run_steps(3);
    again.get_by_label_contains("All panels are closed");
    let stop = again.get_by_role_and_label(Role::Button, "Stop");
    assert!(!stop.accesskit_node().is_disabled());
}

#[test]
fn a_tab_is_brought_to_the_front_by_the_keyboard_and_the_default_still_goes_by_the_window() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = console(folder.path());
    harness.get_by_role_and_label(Role::Button, PanelId::Safety.title()).focus();
    harness.step();
    harness.key_press(egui::Key::Enter);
    harness.run_steps(3);
    harness.get_by_role_and_label(Role::Button, "Close Safety");
    let layout = layout_of(&mut harness);
    assert!(layout.front.contains(&PanelId::Safety) && layout.places.is_none());
    harness.set_size(vec2(1280.0, 720.0));
    harness.run_steps(4);
    harness.get_by_role_and_label(Role::Button, "Close Safety");
    harness.get_by_role_and_label(Role::Button, PanelId::ForceSpace.title());
    let safety = tab(&harness, PanelId::Safety);
    let space = tab(&harness, PanelId::ForceSpace);
    assert!((safety.center().y - space.center().y).abs() < 1.0, "no room next to the traces: a tab");
}

#[test]
fn a_panel_has_a_window_of_its_own_with_stop_and_returns_to_its_place() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = console(folder.path());
    press(&mut harness, "View");
    press(&mut harness, "Timing in its own window");
    harness.run_steps(3);
    assert!(harness.query_by_role_and_label(Role::Button, "Close Timing").is_none(), "it left the main window");
    harness.get_by_label_contains("Wake-up histogram: ");
    let stops = harness.query_all_by_role_and_label(Role::Button, "Stop").count();
    assert_eq!(stops, 2, "the window has its own");
    drop(harness);
    let mut again = console(folder.path());
    again.run_steps(3);
    let back = again.get_by_role_and_label(Role::Button, "Back to the main window").rect();
    let of_window = again.query_all_by_role_and_label(Role::Button, "Stop").map(|stop| stop.rect());
    let of_window = of_window.min_by(|a, b| (a.top() - back.top()).abs().total_cmp(&(b.top() - back.top()).abs()));
    again.drag_at(of_window.unwrap().center());
    again.drop_at(of_window.unwrap().center());
    until(&mut again, "stopped", |tick| tick.state == LoopState::Stopped);
    press(&mut again, "Back to the main window");
    again.run_steps(3);
    assert_eq!(layout_of(&mut again).windows().count(), 0);
    again.get_by_role_and_label(Role::Button, "Close Timing");
}

#[test]
fn the_menu_of_a_title_opens_a_window() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = console(folder.path());
    harness.get_by_role_and_label(Role::Button, PanelId::Traces.title()).click_secondary();
    harness.run_steps(2);
    press(&mut harness, "Open in its own window");
    harness.run_steps(2);
    assert_eq!(layout_of(&mut harness).windows().collect::<Vec<_>>(), [PanelId::Traces]);
}

#[test]
fn a_newcomer_sees_few_panels_and_reaches_every_other_by_one_click() {
    let folder = tempfile::tempdir().unwrap();
    let mut settings = SettingsStore::open(folder.path());
    settings.now.toured = true;
    let mut harness = console_of("peg_transfer", SIZE, move |app| app.with_settings(settings));
    until(&mut harness, "any tick", |_| true);
    for size in [vec2(1280.0, 720.0), vec2(1600.0, 1000.0)] {
        harness.set_size(size);
        harness.run_steps(4);
        let closes = harness.query_all_by_role(Role::Button).filter_map(|button| button.accesskit_node().label());
        let mut shown: Vec<String> = closes.filter(|label| label.starts_with("Close ")).collect();
        shown.sort_unstable();
        assert_eq!(shown, ["Close Feedback", "Close Field", "Close Traces"], "{size:?}");
        for label in ["Gain", "Link delay", "Operating field"] {
            assert!(harness.query_all_by_label(label).next().is_some(), "{label} {size:?}");
        }
        for panel in PanelId::ALL {
            let tab = tab(&harness, panel);
            assert!(tab.right() <= size.x && tab.width() > 20.0, "{panel:?} {size:?} {tab:?}");
        }
    }
    harness.get_by_role_and_label(Role::Button, PanelId::Degrees.title()).click();
    harness.run_steps(3);
    assert!(harness.query_by_role_and_label(Role::Button, "Close Degrees").is_some());
}

#[test]
fn an_own_layout_is_saved_by_name_and_comes_back_the_next_day() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = console(folder.path());
    press(&mut harness, "Close Timing");
    press(&mut harness, "View");
    let save = harness.get_by_role_and_label(Role::Button, "Save").accesskit_node().is_disabled();
    assert!(save, "it has no name yet");
    write_into(&mut harness, "Name of this layout", "Evening");
    press(&mut harness, "Save");
    let mine = layout_of(&mut harness);
    press(&mut harness, "Layout: Simple");
    harness.run_steps(2);
    assert_eq!(layout_of(&mut harness), PanelLayout::built_in(Arrangement::Simple));
    drop(harness);
    let mut again = console(folder.path());
    press(&mut again, "View");
    press(&mut again, "Evening");
    assert!(layout_of(&mut again).looks_like(&mine));
    press(&mut again, "View");
    press(&mut again, "Remove layout Evening");
    assert!(again.state_mut().settings_mut().layouts.is_empty());
}

#[test]
fn the_histograms_tell_how_many_ticks_are_later_than_the_deadline() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = console(folder.path());
    until(&mut harness, "a second", |tick| tick.t_s > 1.0);
    // The histogram is updated four times per second.
    harness.run_steps(12);
    assert!(harness.query_all_by_label_contains("exceeded the deadline of 1000 µs").count() >= 3);
    assert!(harness.query_all_by_label_contains("Missed in the last 2 min: ").next().is_some());
}

#[test]
fn the_gates_of_the_selected_hand_are_shown_and_do_not_move_when_the_answer_gets_longer() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().to_path_buf();
    let mut harness = console_of("bimanual", SIZE, move |app| app.with_settings(toured(&path)));
    until(&mut harness, "engaged", |tick| tick.state == nima_machine::messages::LoopState::Engaged);
    harness.run_steps(3);
    press(&mut harness, "Safety");
    for hand in ["Left hand", "Right hand"] {
        press(&mut harness, hand);
        let chosen = harness.get_by_role_and_label(Role::Button, hand).accesskit_node().toggled();
        assert_eq!(chosen, Some(Toggled::True), "{hand}");
    }
    press(&mut harness, "Left hand");
    let places = |harness: &Harness<'_, ConsoleApp>| {
        let gates = harness.query_all_by_label_contains("Gate ");
        gates.map(|gate| gate.rect()).collect::<Vec<_>>()
    };
    let before = places(&harness);
    assert_eq!(before.len(), nima_core::safety::GATES);
    press(&mut harness, "Stop");
    harness.run_steps(10);
    harness.get_by_label_contains("No force: stopped by the operator");
    assert_eq!(places(&harness), before);
}
