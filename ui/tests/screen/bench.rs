//! The console on a real running loop, stepped by a test.

use std::{
    path::Path,
    time::{Duration, Instant},
};

use egui::accesskit::Role;
use egui_kittest::{
    Harness, Node,
    kittest::{NodeT as _, Queryable as _},
};
use nima_console::console::ConsoleApp;
use nima_machine::messages::Tick;
use nima_panels::{
    settings::SettingsStore,
    tiles::{Arrangement, PanelLayout},
};
use nima_simulation::{SimulationPlan, start_watched};
use nima_tests::plan;

/// Far longer than any step takes, even on a busy machine.
pub(crate) const TIMEOUT: Duration = Duration::from_mins(3);
/// Speed of a simulated person in a wizard, as a multiple of real time.
pub(crate) const WIZARD_SPEED: f64 = 4.0;

/// A window with the console.
pub(crate) type Console = Harness<'static, ConsoleApp>;

/// Returns the settings in this folder, for a user who has seen the tour; if there are none, with every panel in sight.
pub(crate) fn toured(folder: &Path) -> SettingsStore {
    let mut kept = SettingsStore::open(folder);
    kept.now.toured = true;
    if kept.now.layout == PanelLayout::built_in(Arrangement::Simple) {
        kept.now.layout = PanelLayout::default();
    }
    kept
}

/// Returns the console on the simulated rig in this scene, prepared by `prepare`; with both hands if the scene has two.
pub(crate) fn console_of(
    scene: &str,
    size: [f32; 2],
    prepare: impl FnOnce(ConsoleApp) -> ConsoleApp + 'static,
) -> Console {
    shown(&plan(scene), size, prepare)
}

/// Returns the console on a loop of this plan, prepared by `prepare`. In simulated time, so that a busy machine causes
/// no fault.
pub(crate) fn shown(
    plan: &SimulationPlan,
    size: [f32; 2],
    prepare: impl FnOnce(ConsoleApp) -> ConsoleApp + 'static,
) -> Console {
    shown_at(1.0, plan, size, prepare)
}

/// Like [`shown`], with a loop of this speed, for tests of several minutes.
pub(crate) fn shown_at(
    speed: f64,
    plan: &SimulationPlan,
    size: [f32; 2],
    prepare: impl FnOnce(ConsoleApp) -> ConsoleApp + 'static,
) -> Console {
    let (handle, objects) = start_watched(plan, speed).unwrap();
    let rig = plan.rig.clone();
    let scene = plan.scene.clone();
    Harness::builder().with_size(size).with_step_dt(1.0 / 30.0).build_eframe(move |cc| {
        prepare(ConsoleApp::new(cc, handle, rig, scene).with_objects(objects).with_simulated_time(speed))
    })
}

/// Draws fifty times per second: continuous drawing would only slow down the loop.
const FRAME: Duration = Duration::from_millis(20);

/// Steps the window until the condition holds, up to this time; returns whether it held. The window never settles, so `run`
/// cannot be used.
pub(crate) fn comes<'a, A>(
    window: &mut Harness<'a, A>,
    within: Duration,
    wanted: impl Fn(&Harness<'a, A>) -> bool,
) -> bool {
    let began = Instant::now();
    while !wanted(window) {
        if began.elapsed() > within {
            return false;
        }
        std::thread::sleep(FRAME);
        window.step();
    }
    true
}

/// Steps the window until the condition holds.
pub(crate) fn wait<A>(window: &mut Harness<'_, A>, what: &str, wanted: impl Fn(&Harness<'_, A>) -> bool) {
    assert!(comes(window, TIMEOUT, wanted), "never: {what}; there is: {:?}", texts(window));
}

/// Steps the window until the newest tick on the screen fulfils the condition.
pub(crate) fn until(console: &mut Harness<'_, ConsoleApp>, what: &str, wanted: impl Fn(&Tick) -> bool) {
    wait(console, what, |console| console.state().tick().is_some_and(&wanted));
}

/// Steps the window until this text is on the screen.
pub(crate) fn read<A>(window: &mut Harness<'_, A>, words: &str) {
    wait(window, words, |window| shows(window, words));
}

/// Returns whether this text is on the screen.
pub(crate) fn shows<A>(window: &Harness<'_, A>, words: &str) -> bool {
    window.query_all_by_label_contains(words).next().is_some()
}

/// Returns all visible texts, for failure messages.
pub(crate) fn texts<A>(window: &Harness<'_, A>) -> Vec<String> {
    let words = |node: Node<'_>| node.accesskit_node().value().or_else(|| node.accesskit_node().label());
    window.query_all_by_label_contains("").filter_map(words).collect()
}

/// Returns whether this button exists and can be pressed.
pub(crate) fn can_press<A>(window: &Harness<'_, A>, label: &str) -> bool {
    let button = window.query_by_role_and_label(Role::Button, label);
    button.is_some_and(|button| !button.accesskit_node().is_disabled())
}

/// Clicks a button at its position, after it is enabled.
pub(crate) fn press<A>(window: &mut Harness<'_, A>, label: &str) {
    window.step();
    wait(window, label, |window| can_press(window, label));
    window.get_by_role_and_label(Role::Button, label).click();
    window.run_steps(2);
}

/// Presses a button by its name, after it is enabled: it may be scrolled out of sight.
pub(crate) fn pick<A>(window: &mut Harness<'_, A>, label: &str) {
    wait(window, label, |window| can_press(window, label));
    window.get_by_role_and_label(Role::Button, label).click_accesskit();
    window.run_steps(2);
}

/// Types into a field, of one line or of several.
pub(crate) fn write_into<A>(window: &mut Harness<'_, A>, label: &str, text: &str) {
    let field = |window: &Harness<'_, A>| {
        [Role::TextInput, Role::MultilineTextInput]
            .into_iter()
            .find(|role| window.query_by_role_and_label(*role, label).is_some())
            .unwrap_or_else(|| panic!("no field is called {label}; there is: {:?}", texts(window)))
    };
    let role = field(window);
    window.get_by_role_and_label(role, label).focus();
    window.step();
    window.get_by_role_and_label(role, label).type_text(text);
    window.run_steps(2);
}

/// Replaces the content of a field by typing.
pub(crate) fn write_over<A>(window: &mut Harness<'_, A>, label: &str, text: &str) {
    window.get_by_role_and_label(Role::TextInput, label).focus();
    window.step();
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
    window.get_by_role_and_label(Role::TextInput, label).type_text(text);
    window.run_steps(2);
}
