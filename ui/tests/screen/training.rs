//! Training tasks in the window: marking lumps, and what the view tells of a trial.

use egui::Key;
use egui_kittest::kittest::Queryable as _;
use nima_console::console::scene3d::extras::{DEPTH, Extras, ROUND, SHADOWS, SHOW};
use nima_machine::messages::LoopState;

use crate::bench::{console_of, press, read, until};

const SIZE: [f32; 2] = [1600.0, 1000.0];

#[test]
fn lumps_are_marked_by_a_key_while_the_instrument_is_led_and_told_at_the_end() {
    let mut harness = console_of("find_lumps", SIZE, |app| app);
    until(&mut harness, "engaged", |tick| tick.state == LoopState::Engaged);
    read(&mut harness, "Places marked: 0");
    harness.key_press(Key::X);
    press(&mut harness, "Drive by mouse (M)");
    until(&mut harness, "led", |tick| tick.guide_m.is_some());
    read(&mut harness, "Places marked: 0 (X marks, D ends the trial, N begins it anew)");
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
}

#[test]
fn the_way_along_the_wire_is_told_and_the_looks_are_switched() {
    let mut harness = console_of("wire", SIZE, |app| app);
    read(&mut harness, "Way to the goal: ");
    assert_eq!(harness.state().extras(), Extras::default());
    press(&mut harness, SHOW);
    for switch in [SHADOWS, DEPTH, ROUND] {
        harness.get_by_label(switch).click();
        harness.run_steps(2);
    }
    let off = Extras { shadows: false, depth: false, round: false, ..Extras::default() };
    assert_eq!(harness.state().extras(), off);
}
