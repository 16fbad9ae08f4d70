//! The Traces panel and the force space by mouse and by names: cursors, signals, legend, export, and a narrow tile.

use std::path::Path;

use egui::{Modifiers, PointerButton, Pos2, accesskit::Role, vec2};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use nima_panels::tiles::{LayoutNode, LayoutPart, PanelId, PanelLayout};

use crate::bench::{Console, console_of, press, read, shows, toured, until};

const SIZE: [f32; 2] = [1600.0, 1000.0];

fn console(folder: &Path) -> Console {
    let path = folder.to_path_buf();
    let mut console = console_of("peg_transfer", SIZE, move |app| app.with_settings(toured(&path)));
    until(&mut console, "some data", |tick| tick.t_s > 2.0);
    press(&mut console, "Pause");
    console
}

fn plot(console: &Console, axis: &str) -> egui::Rect {
    console.get_by_label(&format!("Force along {axis}, right hand")).rect()
}

fn click(console: &mut Console, place: Pos2, button: PointerButton, modifiers: Modifiers) {
    console.hover_at(place);
    console.step();
    for pressed in [true, false] {
        console.event_modifiers(egui::Event::PointerButton { pos: place, button, pressed, modifiers }, modifiers);
        console.step();
    }
    // Wait, so that the next click does not count as the second of a double click.
    console.run_steps(20);
}

#[test]
fn two_cursors_are_read_with_their_difference_until_the_view_is_reset() {
    let folder = tempfile::tempdir().unwrap();
    let mut console = console(folder.path());
    let z = plot(&console, "z");
    click(&mut console, z.right_center() - vec2(0.1 * z.width(), 0.0), PointerButton::Primary, Modifiers::NONE);
    assert!(!shows(&console, "Between the cursors"), "one cursor has no difference");
    click(&mut console, z.right_center() - vec2(0.05 * z.width(), 0.0), PointerButton::Primary, Modifiers::SHIFT);
    let first = console.get_by_label_contains("Between the cursors, x:").value().unwrap();
    // A twentieth of ten seconds.
    let seconds: f64 = first.split("[1]:").nth(1).unwrap().trim().split(' ').next().unwrap().parse().unwrap();
    assert!((seconds - 0.5).abs() < 0.05, "{first}");
    assert!(first.contains("Hz)") && first.contains("measured") && first.contains("rendered"), "{first}");
    read(&mut console, "Between the cursors, z:");
    click(&mut console, z.center(), PointerButton::Secondary, Modifiers::NONE);
    press(&mut console, "Reset zoom, remove cursors");
    assert!(!shows(&console, "Between the cursors"));
}

#[test]
fn units_are_chosen_for_every_plot_and_remembered() {
    let folder = tempfile::tempdir().unwrap();
    let mut console = console(folder.path());
    press(&mut console, "Signals");
    press(&mut console, "mN");
    press(&mut console, "m, m/s");
    console.get_by_label("Force along x (mN)");
    console.get_by_label("Speed of the tip (m/s)");
    let z =
        console.get_by_label_contains("Force along z, right hand").accesskit_node().description().unwrap_or_default();
    assert!(z.contains(" mN") && !z.contains(" N"), "{z}");
    drop(console);
    let mut again = self::console(folder.path());
    press(&mut again, "Signals");
    again.get_by_label("Force along x (mN)");
}

#[test]
fn signals_are_chosen_hidden_and_saved_as_shown() {
    let folder = tempfile::tempdir().unwrap();
    let mut console = console(folder.path());
    press(&mut console, "Signals");
    for name in ["Force along x (N)", "Force along y (N)", "Degree N", "Speed of the tip (mm/s)"] {
        console.get_by_role_and_label(Role::CheckBox, name).click();
        console.run_steps(2);
    }
    click(&mut console, Pos2::new(800.0, 200.0), PointerButton::Primary, Modifiers::NONE);
    read(&mut console, "Degree N, right hand");
    read(&mut console, "Speed of the tip, right hand");
    assert!(!shows(&console, "Force along x, right hand"));
    {
        let space = console.get_by_label_contains("Force space. ").rect();
        let mut names = console.query_all_by_role_and_label(Role::Button, "measured");
        names.find(|node| !space.contains_rect(node.rect())).unwrap().click();
    }
    console.run_steps(2);
    let z = plot(&console, "z").center();
    click(&mut console, z, PointerButton::Secondary, Modifiers::NONE);
    press(&mut console, "Save as CSV");
    read(&mut console, "Saved as");
    let mut files = std::fs::read_dir(folder.path().join("plots")).unwrap();
    let table = std::fs::read_to_string(files.next().unwrap().unwrap().path()).unwrap();
    let names = table.lines().next().unwrap();
    assert!(names.starts_with("time_s,z_rendered_N_min,z_rendered_N_max,v_speed_mm/s_min"), "{names}");
    assert!(names.contains("N_this_console_min") && !names.contains("measured"), "{names}");
    assert!(table.lines().count() > 100, "{}", table.lines().count());
}

#[test]
fn a_narrow_panel_shows_the_newest_second() {
    let folder = tempfile::tempdir().unwrap();
    let mut console = console(folder.path());
    let tabs = |panels: &[PanelId]| LayoutNode::Tabs(panels.iter().map(|panel| LayoutNode::Panel(*panel)).collect());
    let others: Vec<PanelId> = PanelId::ALL.into_iter().filter(|panel| *panel != PanelId::Traces).collect();
    let parts = vec![
        LayoutPart { fraction: 8000, of: tabs(&others) },
        LayoutPart { fraction: 2000, of: tabs(&[PanelId::Traces]) },
    ];
    console.state_mut().settings_mut().layout =
        PanelLayout { places: Some(LayoutNode::Row(parts)), ..PanelLayout::default() };
    console.run_steps(4);
    let z = plot(&console, "z");
    assert!(z.right() <= SIZE[0] && z.width() > 150.0, "{z:?}");
    for name in ["Resume", "Last 10 s", "Signals"] {
        let button = console.get_by_role_and_label(Role::Button, name).rect();
        assert!(button.right() <= SIZE[0], "{name} {button:?}");
    }
}

#[test]
fn the_force_space_names_both_magnitudes_and_hides_a_curve() {
    let folder = tempfile::tempdir().unwrap();
    let mut console = console(folder.path());
    let of_space = |console: &Console| {
        let place = console.get_by_label_contains("Force space. ").rect();
        let names = console.query_all_by_role_and_label(Role::Button, "rendered");
        names.map(|node| node.rect()).find(|rect| place.contains_rect(*rect)).unwrap().center()
    };
    let place = of_space(&console);
    click(&mut console, place, PointerButton::Primary, Modifiers::NONE);
    let toggled = |console: &Console| {
        let place = console.get_by_label_contains("Force space. ").rect();
        let names = console.query_all_by_role_and_label(Role::Button, "rendered");
        let mut nodes = names.filter(|node| place.contains_rect(node.rect()));
        nodes.next().unwrap().accesskit_node().toggled()
    };
    assert_eq!(toggled(&console), Some(egui::accesskit::Toggled::False));
    press(&mut console, "Reset");
    assert_eq!(toggled(&console), Some(egui::accesskit::Toggled::True));
}
