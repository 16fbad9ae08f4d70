//! The console on a real running loop, stepped by a test.

use std::time::{Duration, Instant};

use egui::accesskit::Role;
use egui_kittest::{
    Harness,
    kittest::{NodeT as _, Queryable as _},
};
use nima_console::console::ConsoleApp;
use nima_machine::{config::RigConfig, messages::Tick};
use nima_world::{Plan, scene::Scene, start_simulated};

/// Far longer than anything takes, also on a busy machine.
pub(crate) const TIMEOUT: Duration = Duration::from_mins(3);
/// How much faster than real time a simulated person works in a wizard.
pub(crate) const WIZARD_SPEED: f64 = 4.0;

/// The console on the simulated rig in this scene, made ready by `prepare`; both hands of a scene that has two.
pub(crate) fn console_of(
    scene: &str,
    size: [f32; 2],
    prepare: impl FnOnce(ConsoleApp) -> ConsoleApp + 'static,
) -> Harness<'static, ConsoleApp> {
    let rig = RigConfig::load("simulated").unwrap();
    let scene = Scene::load(scene).unwrap();
    shown(&Plan { rig, scene, calibrations: Default::default(), engage: true }, size, prepare)
}

/// The console on a loop that is started by this plan, made ready by `prepare`. In simulated time: a busy machine faults no loop.
pub(crate) fn shown(
    plan: &Plan,
    size: [f32; 2],
    prepare: impl FnOnce(ConsoleApp) -> ConsoleApp + 'static,
) -> Harness<'static, ConsoleApp> {
    shown_at(1.0, plan, size, prepare)
}

/// The same with a loop that is `speed` times as fast, for what takes minutes.
pub(crate) fn shown_at(
    speed: f64,
    plan: &Plan,
    size: [f32; 2],
    prepare: impl FnOnce(ConsoleApp) -> ConsoleApp + 'static,
) -> Harness<'static, ConsoleApp> {
    let handle = start_simulated(plan, speed).unwrap();
    let (rig, scene) = (plan.rig.clone(), plan.scene.clone());
    Harness::builder()
        .with_size(size)
        .with_step_dt(1.0 / 30.0)
        .build_eframe(move |cc| prepare(ConsoleApp::new(cc, handle, rig, scene).with_simulated_time(speed)))
}

/// As a window that draws fifty times a second: drawing all the time would only slow down what it waits for.
const FRAME: Duration = Duration::from_millis(20);

/// Steps the window until the newest tick on the screen is as wanted. The window never settles, so `run` is of no use.
pub(crate) fn until(harness: &mut Harness<'_, ConsoleApp>, what: &str, good: impl Fn(&Tick) -> bool) {
    let began = Instant::now();
    while !harness.state().tick().is_some_and(&good) {
        assert!(began.elapsed() < TIMEOUT, "the loop never was: {what}");
        std::thread::sleep(FRAME);
        harness.step();
    }
}

/// A button that must first become ready.
pub(crate) fn press(harness: &mut Harness<'_, ConsoleApp>, label: &str) {
    let began = Instant::now();
    loop {
        harness.step();
        if let Some(button) = harness.query_by_role_and_label(Role::Button, label)
            && !button.accesskit_node().is_disabled()
        {
            button.click();
            break;
        }
        assert!(began.elapsed() < TIMEOUT, "no button \"{label}\" that can be pressed");
        std::thread::sleep(FRAME);
    }
    harness.step();
    harness.step();
}
