//! The console driven by accessible names on a real running loop: input must reach the loop, and its effects must appear on
//! the screen.

use std::time::Duration;

use eframe::App as _;
use egui::{Key, accesskit::Role};
use egui_kittest::{
    Harness,
    kittest::{NodeT as _, Queryable as _},
};
use nima_console::console::ConsoleApp;
use nima_core::{
    impedance::{Baseline, Mode},
    safety::Gate,
};
use nima_machine::{
    messages::{LoopState, Tick},
    rig::Side,
};
use nima_panels::tiles::{PanelId, PanelLayout};
use nima_simulation::SimulationPlan;
use nima_tests::plan;

use crate::bench::{press, read, shown, until, wait};

fn console_of(scene: &str, size: [f32; 2], engage: bool) -> Harness<'static, ConsoleApp> {
    shown(&SimulationPlan { engage, ..plan(scene) }, size, |app| app)
}

fn console() -> Harness<'static, ConsoleApp> {
    let mut harness = console_of("peg_transfer", [1600.0, 1000.0], true);
    until(&mut harness, "engaged", |tick| tick.state == LoopState::Engaged);
    harness
}

/// Returns whether such a tick arrives within this loop time (one peg takes less than 3 s).
fn ever(harness: &mut Harness<'_, ConsoleApp>, seconds: f64, good: impl Fn(&Tick) -> bool) -> bool {
    let t_s = |harness: &Harness<'_, ConsoleApp>| harness.state().tick().map_or(0.0, |tick| tick.t_s);
    let from_s = t_s(harness);
    while t_s(harness) < from_s + seconds {
        std::thread::sleep(Duration::from_millis(5));
        harness.step();
        if harness.state().tick().is_some_and(&good) {
            return true;
        }
    }
    false
}

/// Returns whether the dead band acts in any tick of this time, whichever ticks a frame shows.
fn closes_within(harness: &mut Harness<'_, ConsoleApp>, seconds: f64) -> bool {
    let acted = |tick: &Tick| tick.gates.counts.acted[Gate::DeadBand.index()];
    let before = harness.state().tick().map_or(0, acted);
    ever(harness, seconds, |tick| acted(tick) > before)
}

fn set_slider(harness: &mut Harness<'_, ConsoleApp>, label: &str, value: f64) {
    harness.get_by_role_and_label(Role::Slider, label).set_value_accesskit(value);
    harness.step();
    harness.step();
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-6
}

#[test]
fn stop_release_and_engage_are_three_deliberate_steps() {
    let mut harness = console();
    harness.get_by_label("Loop state: Engaged");
    assert!(harness.query_by_label("Engage").is_none() && harness.query_by_label("Release stop").is_none());
    press(&mut harness, "Stop");
    until(&mut harness, "stopped", |tick| tick.state == LoopState::Stopped && tick.rendering.rendered_n.norm() < 1e-12);
    harness.step();
    harness.get_by_label("Loop state: Stopped");
    let release = harness.get_by_role_and_label(Role::Button, "Release stop");
    assert!(release.accesskit_node().is_disabled(), "a double click on stop must not release it");
    press(&mut harness, "Release stop");
    until(&mut harness, "idle", |tick| tick.state == LoopState::Idle);
    press(&mut harness, "Engage");
    until(&mut harness, "engaged again", |tick| tick.state == LoopState::Engaged);
    harness.step();
    harness.get_by_label("Loop state: Engaged");
}

#[test]
fn space_and_escape_stop_even_when_another_button_has_the_focus() {
    for key in [Key::Space, Key::Escape] {
        let mut harness = console();
        harness.get_by_role_and_label(Role::Button, "Pause").focus();
        harness.step();
        harness.key_press(key);
        harness.step();
        until(&mut harness, "stopped by key", |tick| tick.state == LoopState::Stopped);
        harness.step();
        assert!(harness.query_by_role_and_label(Role::Button, "Pause").is_some(), "the key must press nothing else");
    }
}

#[test]
fn a_console_that_was_not_engaged_begins_idle_and_without_force() {
    let mut harness = console_of("peg_transfer", [1600.0, 1000.0], false);
    until(&mut harness, "idle", |tick| tick.state == LoopState::Idle && tick.rendering.rendered_n.norm() < 1e-12);
    harness.step();
    harness.get_by_label("Loop state: Idle");
    press(&mut harness, "Engage");
    until(&mut harness, "engaged", |tick| tick.state == LoopState::Engaged);
}

#[test]
fn every_mode_can_be_chosen_and_comes_back() {
    let mut harness = console();
    assert!(harness.query_by_role_and_label(Role::Button, "Linear").is_none(), "modes for comparison are folded away");
    harness.get_by_label("Research modes").click();
    harness.run_steps(12);
    for (label, mode) in [
        ("Direct (DFR)", Mode::Dfr),
        ("Linear", Mode::Linear),
        ("Literal", Mode::Literal),
        ("Matched", Mode::Matched),
        ("Best of both", Mode::Best),
        ("NIMA", Mode::Nima),
        ("Anchored", Mode::Anchored),
    ] {
        harness.get_by_role_and_label(Role::Button, label).click();
        harness.step();
        until(&mut harness, label, |tick| tick.mode == mode);
    }
}

#[test]
fn the_baseline_that_the_rig_names_is_offered_and_no_other() {
    let kalman = Mode::Baseline(Baseline::Kalman);
    let mut plan = plan("peg_transfer");
    plan.rig.mode = kalman;
    let mut harness = shown(&plan, [1600.0, 1000.0], |app| app);
    until(&mut harness, "engaged", |tick| tick.state == LoopState::Engaged && tick.mode == kalman);
    for (label, mode) in [("Direct (DFR)", Mode::Dfr), ("Kalman", kalman)] {
        harness.get_by_role_and_label(Role::Button, label).click();
        harness.step();
        until(&mut harness, label, |tick| tick.mode == mode);
    }
    assert!(harness.query_by_role_and_label(Role::Button, "Wave variables").is_none());
    assert!(console().query_by_role_and_label(Role::Button, "Kalman").is_none(), "this rig names none");
}

#[test]
fn gain_follows_the_slider_and_needs_a_second_action_above_one() {
    let mut harness = console();
    set_slider(&mut harness, "Gain", 0.4);
    until(&mut harness, "gain 0.4", |tick| near(tick.gates.gain, 0.4));
    assert!(!ever(&mut harness, 3.0, |tick| !near(tick.gates.gain, 0.4)), "showing a value must not change it");
    set_slider(&mut harness, "Gain", 2.0);
    until(&mut harness, "gain 1 at most", |tick| near(tick.gates.gain, 1.0));
    assert!(!ever(&mut harness, 0.5, |tick| tick.gates.gain > 1.0 + 1e-9));
    harness.get_by_role_and_label(Role::CheckBox, "Allow above 1").click();
    harness.step();
    set_slider(&mut harness, "Gain", 2.0);
    until(&mut harness, "gain 2", |tick| near(tick.gates.gain, 2.0));
    harness.get_by_role_and_label(Role::CheckBox, "Allow above 1").click();
    harness.step();
    until(&mut harness, "back to 1", |tick| near(tick.gates.gain, 1.0));
}

#[test]
fn delay_follows_the_slider() {
    let mut harness = console();
    set_slider(&mut harness, "Link delay", 300.0);
    until(&mut harness, "300 ms", |tick| near(tick.delay_s, 0.3));
    set_slider(&mut harness, "Link delay", 0.0);
    until(&mut harness, "0 ms", |tick| near(tick.delay_s, 0.0));
}

/// The tremor of the scene's hand passes the default of 1 mm/s; the widest dead band closes at every peg.
#[test]
fn the_dead_band_closes_for_a_slow_hand_and_can_be_switched_off() {
    let mut harness = console();
    set_slider(&mut harness, "Dead band", 10.0);
    assert!(closes_within(&mut harness, 8.0));
    set_slider(&mut harness, "Dead band", 0.0);
    ever(&mut harness, 0.1, |_| false);
    assert!(!closes_within(&mut harness, 4.0));
}

#[test]
fn static_hold_keeps_the_force_of_a_slow_hand() {
    let mut harness = console();
    set_slider(&mut harness, "Dead band", 10.0);
    assert!(closes_within(&mut harness, 8.0));
    harness.get_by_role_and_label(Role::CheckBox, "Keep force at standstill").click();
    harness.step();
    ever(&mut harness, 0.1, |_| false);
    assert!(!closes_within(&mut harness, 4.0));
}

#[test]
fn traces_pause_while_the_loop_goes_on() {
    let mut harness = console();
    press(&mut harness, "Pause");
    assert!(ever(&mut harness, 1.0, |tick| tick.state == LoopState::Engaged));
    press(&mut harness, "Resume");
    press(&mut harness, "Last 10 s");
    harness.get_by_role_and_label(Role::Button, "Pause");
}

#[test]
fn the_first_screen_says_what_it_is_and_every_control_has_a_name() {
    for (scene, size) in
        [("peg_transfer", [1600.0, 1000.0]), ("free_motion", [1100.0, 680.0]), ("peg_transfer", [3840.0, 2160.0])]
    {
        let mut harness = console_of(scene, size, true);
        until(&mut harness, "any tick", |_| true);
        harness.run_steps(3);
        harness.get_by_label("NIMA Console");
        harness.get_by_label("Research software, not for clinical use");
        harness.get_by_label("Operating field");
        let stop = harness.get_by_role_and_label(Role::Button, "Stop").rect();
        assert!(stop.height() >= 48.0 && stop.width() >= 48.0, "{stop:?}");
        assert!(stop.right() <= size[0] && stop.bottom() <= size[1], "{stop:?}");
        harness.check_accessibility();
    }
}

#[test]
fn closing_the_window_ends_the_loop() {
    let mut harness = console();
    harness.state_mut().on_exit(None);
    let last = harness.state().tick().map(|tick| tick.index);
    std::thread::sleep(Duration::from_millis(50));
    harness.run_steps(2);
    assert_eq!(harness.state().tick().map(|tick| tick.index), last);
}

#[test]
fn the_instrument_is_led_by_mouse_and_keys_and_a_stop_lets_it_go() {
    let mut harness = console();
    press(&mut harness, "Drive by mouse (M)");
    until(&mut harness, "led", |tick| tick.guidance.guide_m.is_some());
    for _ in 0..5 {
        harness.key_press(Key::PageUp);
        harness.step();
    }
    let view = harness.get_by_label("Operating field").rect();
    harness.drag_at(view.center());
    harness.step();
    harness.hover_at(view.center() + egui::vec2(60.0, 0.0));
    harness.step();
    harness.drop_at(view.center() + egui::vec2(60.0, 0.0));
    harness.step();
    let aim_m = harness.state().tick().unwrap().guidance.guide_m.unwrap();
    until(&mut harness, "where it is led", |tick| {
        (tick.positions.leader_m - tick.guidance.guide_m.unwrap_or_default()).norm() < 3e-3
    });
    press(&mut harness, "Stop driving (M)");
    until(&mut harness, "let go", |tick| tick.guidance.guide_m.is_none());
    harness.key_press(Key::M);
    until(&mut harness, "led again", |tick| tick.guidance.guide_m.is_some_and(|position_m| position_m != aim_m));
    press(&mut harness, "Stop");
    until(&mut harness, "stopped and let go", |tick| {
        tick.state == LoopState::Stopped && tick.guidance.guide_m.is_none()
    });
}

#[test]
fn a_key_that_cannot_drive_now_says_why() {
    let mut harness = console();
    press(&mut harness, "Stop");
    until(&mut harness, "stopped", |tick| tick.state == LoopState::Stopped);
    harness.key_press(Key::M);
    read(&mut harness, "Only while the loop is idle or engaged");
    assert!(harness.state().tick().unwrap().guidance.guide_m.is_none());
}

#[test]
fn an_instrument_whose_view_is_hidden_by_a_tab_is_let_go() {
    let mut harness = console();
    press(&mut harness, "Drive by mouse (M)");
    until(&mut harness, "led", |tick| tick.guidance.guide_m.is_some());
    harness.state_mut().settings_mut().layout = PanelLayout { front: vec![PanelId::Devices], ..PanelLayout::default() };
    harness.run_steps(3);
    assert!(harness.query_by_label("Operating field").is_none());
    until(&mut harness, "let go", |tick| tick.guidance.guide_m.is_none());
}

#[test]
fn the_jaws_are_opened_and_closed_by_a_key_while_the_instrument_is_led() {
    let mut plan = plan("rings");
    plan.rig.mode = Mode::Matched;
    let mut harness = shown(&plan, [1600.0, 1000.0], |app| app);
    until(&mut harness, "engaged", |tick| tick.state == LoopState::Engaged);
    let opening = |harness: &Harness<'_, ConsoleApp>| {
        harness.state().objects().and_then(|objects| objects.jaws[Side::Right.index()]).map(|jaws| jaws.opening_rad)
    };
    let opens = |harness: &mut Harness<'_, ConsoleApp>, open: bool| {
        wait(harness, "jaws", |harness| opening(harness).is_some_and(|rad| (rad > 0.4) == open));
    };
    harness.key_press(Key::G);
    harness.run_steps(5);
    assert!(opening(&harness).is_none_or(|rad| rad < 0.1), "only while it is led");
    press(&mut harness, "Drive by mouse (M)");
    until(&mut harness, "led", |tick| tick.guidance.guide_m.is_some());
    for open in [true, false, true] {
        harness.key_press(Key::G);
        harness.step();
        opens(&mut harness, open);
    }
    let rings = harness.state().objects().map_or(0, |objects| objects.rings.iter().flatten().count());
    assert_eq!(rings, 6);
}

#[test]
fn all_modes_are_computed_only_while_they_are_compared() {
    let mut harness = console();
    press(&mut harness, "Close Degrees");
    let all = |tick: &Tick| Mode::ALL.into_iter().all(|mode| tick.identification.modes.contains(mode));
    until(&mut harness, "one mode", |tick| !all(tick));
    assert!(harness.query_by_label_contains("Error Literal").is_none());
    harness.get_by_role_and_label(Role::CheckBox, "Compare all modes").click();
    until(&mut harness, "all modes", all);
    harness.step();
    harness.get_by_label_contains("Error Literal");
    harness.get_by_role_and_label(Role::CheckBox, "Compare all modes").click();
    until(&mut harness, "one mode again", |tick| !all(tick));
}
