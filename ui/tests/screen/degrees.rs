//! The Degrees panel: the loop computes what it shows while it is on the screen, and the operator's choice stays.

use egui::accesskit::{Role, Toggled};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use nima_core::impedance::Mode;
use nima_machine::messages::Tick;
use nima_panels::tiles::PanelId;

use crate::bench::{Console, console_of, press, read, shows, texts, toured, until, wait};

fn computes_all(tick: &Tick) -> bool {
    Mode::ALL.into_iter().all(|mode| tick.identification.modes.contains(mode))
}

fn compares(console: &Console) -> bool {
    let choice = console.get_by_role_and_label(Role::CheckBox, "Compare all modes");
    choice.accesskit_node().toggled() == Some(Toggled::True)
}

fn toggle(console: &mut Console) {
    console.state_mut().settings_mut().layout.toggle(PanelId::Degrees);
    console.run_steps(3);
}

#[test]
fn the_loop_computes_what_the_panel_shows_and_the_operators_choice_stays() {
    let mut console = console_of("peg_transfer", [1600.0, 1000.0], |app| app);
    until(&mut console, "all modes for the panel", computes_all);
    assert!(!compares(&console), "the operator did not choose it");
    assert!(!shows(&console, "Error Literal"), "the list of modes goes by the operator's choice");
    toggle(&mut console);
    until(&mut console, "only the mode in use", |tick| !computes_all(tick));
    console.get_by_role_and_label(Role::CheckBox, "Compare all modes").click();
    until(&mut console, "all modes by choice", computes_all);
    toggle(&mut console);
    console.run_steps(5);
    toggle(&mut console);
    console.run_steps(10);
    assert!(compares(&console) && console.state().tick().is_some_and(computes_all), "the choice outlives the panel");
}

#[test]
fn every_row_is_computed_with_its_cost() {
    let mut console = console_of("peg_transfer", [1600.0, 1000.0], |app| app);
    until(&mut console, "all modes", computes_all);
    let measured = |words: &str| words.starts_with('+') && words.ends_with("µs") && !words.contains('–');
    wait(&mut console, "the cost", |console| texts(console).iter().any(|words| measured(words)));
    read(&mut console, "columns");
    read(&mut console, "mm/s");
    wait(&mut console, "a full window", |console| !shows(console, "– / – / –"));
}

#[test]
fn what_is_shown_is_saved_as_tables() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().to_path_buf();
    let mut console = console_of("peg_transfer", [1600.0, 1000.0], move |app| app.with_settings(toured(&path)));
    until(&mut console, "all modes", computes_all);
    until(&mut console, "some of them", |tick| tick.t_s > 3.0);
    press(&mut console, "CSV");
    read(&mut console, "Saved as");
    let mut tables: Vec<_> =
        std::fs::read_dir(folder.path().join("plots")).unwrap().map(|file| file.unwrap().path()).collect();
    tables.sort();
    let [fractions, course] = [0, 1].map(|place: usize| std::fs::read_to_string(&tables[place]).unwrap());
    let (fractions, course) = if fractions.starts_with("degree") { (fractions, course) } else { (course, fractions) };
    let sum: f64 = fractions.lines().skip(1).map(|row| row.split(',').nth(1).unwrap().parse::<f64>().unwrap()).sum();
    assert!((sum - 1.0).abs() < 1e-9, "{fractions}");
    assert!(course.starts_with("time_s,console_mean_degree,paper_mean_degree,x_mean_degree"), "{course}");
    assert!(course.lines().count() > 3, "{course}");
}
