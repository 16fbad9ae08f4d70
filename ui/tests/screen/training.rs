//! Training tasks in the window: marking lumps, and the texts about a trial.

use egui::Key;
use egui_kittest::{Harness, kittest::Queryable as _};
use nima_console::console::ConsoleApp;
use nima_core::impedance::Mode;
use nima_machine::{
    messages::LoopState,
    rig::{SIDES, Side},
};
use nima_screen::scene3d::extras::{DEPTH, Extras, ROUND, SHADOWS, SHOW};

use crate::bench::{console_of, press, read, shown, shown_at, shows, texts, until, wait};

const SIZE: [f32; 2] = [1600.0, 1000.0];

#[test]
fn lumps_are_marked_by_a_key_while_the_instrument_is_led_and_told_at_the_end() {
    let mut harness = console_of("find_lumps", SIZE, |app| app);
    until(&mut harness, "engaged", |tick| tick.state == LoopState::Engaged);
    read(&mut harness, "Places marked: 0");
    harness.key_press(Key::X);
    press(&mut harness, "Drive by mouse (M)");
    until(&mut harness, "led", |tick| tick.guidance.guide_m.is_some());
    read(&mut harness, "Places marked: 0 (X marks, D ends the trial, N restarts it)");
    for marked in 1..=2 {
        harness.key_press(Key::X);
        read(&mut harness, &format!("Places marked: {marked}"));
    }
    harness.key_press(Key::N);
    read(&mut harness, "Places marked: 0");
    harness.key_press(Key::X);
    read(&mut harness, "Places marked: 1");
    harness.key_press(Key::D);
    read(&mut harness, "of 5, false marks: ");
    press(&mut harness, "Stop driving (M)");
    harness.key_press(Key::N);
    read(&mut harness, "Places marked: 0");
}

#[test]
fn the_way_along_the_wire_is_told_and_the_looks_are_switched() {
    let mut harness = console_of("wire", SIZE, |app| app);
    read(&mut harness, "Path to the goal: ");
    assert_eq!(harness.state().extras(), Extras::default());
    press(&mut harness, SHOW.get());
    for switch in [SHADOWS, DEPTH, ROUND] {
        harness.get_by_label(switch.get()).click();
        harness.run_steps(2);
    }
    let off = Extras { shadows: false, depth: false, round: false, ..Extras::default() };
    assert_eq!(harness.state().extras(), off);
}

type Window<'a> = Harness<'a, ConsoleApp>;

/// Whether each pair of jaws is open.
fn open(window: &Window<'_>) -> [bool; SIDES] {
    let jaws = window.state().objects().map_or([None; SIDES], |objects| objects.jaws);
    jaws.map(|jaws| jaws.is_some_and(|jaws| jaws.opening_rad > 0.4))
}

#[test]
fn one_person_leads_both_instruments_one_at_a_time() {
    let mut plan = nima_tests::plan("rings");
    plan.rig.mode = Mode::Matched;
    let mut harness = shown(&plan, SIZE, |app| app);
    until(&mut harness, "engaged", |tick| tick.state == LoopState::Engaged);
    read(&mut harness, "passed 0, placed 0, dropped 0");
    press(&mut harness, "Drive by mouse (M)");
    until(&mut harness, "led", |tick| tick.guidance.guide_m.is_some());
    read(&mut harness, "Right instrument");
    let right_m = |harness: &Window<'_>| harness.state().tick().unwrap().guidance.guide_m.unwrap();
    let before_m = right_m(&harness);
    // All within one frame: they are applied in order.
    for key in [Key::PageDown, Key::PageDown, Key::H, Key::PageUp, Key::G] {
        harness.key_press(key);
    }
    read(&mut harness, "Left instrument");
    wait(&mut harness, "the left jaws alone are open", |harness| open(harness) == [false, true]);
    until(&mut harness, "the right one is two steps lower", |tick| {
        tick.guidance.guide_m.is_some_and(|position_m| (position_m.z - before_m.z + 0.002).abs() < 1e-6)
    });
    let held_m = right_m(&harness);
    harness.run_steps(5);
    assert_eq!(right_m(&harness), held_m, "it stays where it was left");
    harness.key_press(Key::H);
    read(&mut harness, "Right instrument");
    harness.key_press(Key::M);
    until(&mut harness, "let go", |tick| tick.guidance.guide_m.is_none());
}

/// Returns the displayed torque about the shaft at the jaws, mNm.
fn torque_mnm(window: &Window<'_>) -> Option<f64> {
    let begins = "Torque about the shaft: ";
    let report = texts(window).into_iter().find(|report| report.starts_with(begins))?;
    report[begins.len()..].split(' ').next()?.parse().ok()
}

#[test]
fn the_torque_about_the_shaft_is_shown_at_the_jaws_and_at_the_wrist() {
    let mut plan = nima_tests::plan("rings");
    plan.rig.mode = Mode::Matched;
    let mut harness = shown_at(2.0, &plan, SIZE, |app| app);
    press(&mut harness, "Left");
    wait(&mut harness, "no torque", |window| torque_mnm(window) == Some(0.0));
    // A ring weighs 15 mN, its centre is 7 mm away from the jaws, and the shaft leans by 40 degrees.
    wait(&mut harness, "the torque of a ring that is carried", |window| {
        let jaws = window.state().objects().and_then(|objects| objects.jaws[Side::Left.index()]);
        let held = jaws.is_some_and(|jaws| jaws.opens_n > 1.0 && !jaws.touched[1] && !jaws.touched[2]);
        held && torque_mnm(window).is_some_and(|mnm| (0.02..0.12).contains(&mnm.abs()))
    });
    drop(harness);
    let mut harness = console_of("palpation", SIZE, |app| app);
    read(&mut harness, "mNm at the wrist sensor");
    let mut harness = console_of("peg_transfer", SIZE, |app| app);
    until(&mut harness, "some time", |tick| tick.t_s > 0.5);
    assert!(!shows(&harness, "Torque about the shaft"), "there it is not known");
}
