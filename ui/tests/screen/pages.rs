//! The pages below the top bar: at most one is open, and a view replaces it.

use egui::Key;
use egui_kittest::Harness;
use nima_console::console::ConsoleApp;
use nima_panels::{
    roles::Role,
    tiles::{PanelId, PanelLayout},
};

use crate::bench::{can_press, console_of, pick, read, shows, toured, until};

const SETUP: &str = "For every arm: devices";
const START: &str = "Restart";

fn console(folder: &std::path::Path) -> Harness<'static, ConsoleApp> {
    let path = folder.to_path_buf();
    let mut console = console_of("peg_transfer", [1600.0, 1000.0], move |app| app.with_settings(toured(&path)));
    until(&mut console, "any tick", |_| true);
    let layout = &mut console.state_mut().settings_mut().layout;
    *layout = PanelLayout { front: vec![PanelId::Calibrations], ..PanelLayout::default() };
    pick(&mut console, "Set-up…");
    read(&mut console, SETUP);
    console
}

#[test]
fn a_view_replaces_the_set_up_page() {
    let folder = tempfile::tempdir().unwrap();
    let mut console = console(folder.path());
    console.key_press(Key::F1);
    console.run_steps(3);
    assert_eq!(console.state().role(), Role::Surgeon);
    assert!(!shows(&console, SETUP), "the page would hide the view");
}

#[test]
fn a_page_replaces_the_one_before_it() {
    let folder = tempfile::tempdir().unwrap();
    let mut console = console(folder.path());
    console.key_press(Key::F6);
    console.run_steps(3);
    assert!(can_press(&console, START) && !shows(&console, SETUP));
    console.key_press(Key::F7);
    console.run_steps(3);
    assert!(!can_press(&console, START));
    console.key_press(Key::F7);
    console.run_steps(3);
    assert!(!shows(&console, SETUP) && !can_press(&console, START), "nothing is left below a page");
}
