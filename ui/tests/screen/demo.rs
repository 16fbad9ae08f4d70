//! Tests of the demonstration over a running loop: its chapters, its timing, its faults, and a stop by a person.

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::Duration,
};

use egui::Key;
use egui_kittest::{Harness, kittest::Queryable as _};
use nima_console::console::ConsoleApp;
use nima_core::{impedance::Mode, safety::ChainSettings};
use nima_machine::{
    config::SchedulingClass,
    messages::{LoopState, Tick},
    rig::{Inputs, Outputs, Rig, SIDES},
    runtime::{self, Assembly, RuntimeClock},
};
use nima_tests::plan;

use crate::bench::{Console, console_of, press, read, shown_at, until};

const SIZE: [f32; 2] = [1280.0, 720.0];
/// Maximum speed of the loop, as a multiple of real time, in tests that wait for a chapter.
const SPEED: f64 = 8.0;

#[test]
fn the_demonstration_switches_modes_and_puts_back_what_it_found() {
    let mut harness = console_of("peg_transfer", SIZE, |app| app);
    until(&mut harness, "engaged", |tick| tick.state == LoopState::Engaged);
    let (mode, delay_s) = harness.state().tick().map(|tick| (tick.mode, tick.delay_s)).unwrap();
    press(&mut harness, "Demo");
    press(&mut harness, "2. Direct reflection");
    until(&mut harness, "direct, 300 ms", |tick| tick.mode == Mode::Dfr && (tick.delay_s - 0.3).abs() < 1e-9);
    press(&mut harness, "4. Nonlinear, as in the paper");
    until(&mut harness, "literal", |tick| tick.mode == Mode::Literal);
    harness.key_press(Key::F2);
    harness.step();
    until(&mut harness, "as before", |tick| tick.mode == mode && (tick.delay_s - delay_s).abs() < 1e-9);
}

#[test]
fn the_demonstration_goes_on_by_itself_and_stands_while_the_loop_is_stopped() {
    let mut harness = shown_at(SPEED, &plan("peg_transfer"), SIZE, |app| app);
    press(&mut harness, "Demo");
    until(&mut harness, "engaged", |tick| tick.state == LoopState::Engaged);
    press(&mut harness, "Stop");
    until(&mut harness, "stopped", |tick| tick.state == LoopState::Stopped);
    read(&mut harness, "waits until you press Release stop, then Engage");
    let stopped_s = harness.state().tick().unwrap().t_s;
    // Far longer than a chapter, or than the explanation of a fault.
    until(&mut harness, "later", |tick| tick.t_s > stopped_s + 40.0);
    let tick = harness.state().tick().unwrap();
    assert_eq!((tick.mode, tick.state), (Mode::Best, LoopState::Stopped));
    press(&mut harness, "Release stop");
    press(&mut harness, "Engage");
    until(&mut harness, "engaged again", |tick| tick.state == LoopState::Engaged);
    until(&mut harness, "the second chapter", |tick| tick.mode == Mode::Dfr);
}

/// Returns the duration of the second chapter on the loop's clock, and longest time between two frames, s, for a window
/// that rests for this time after each frame.
fn second_chapter_s(rest: Duration) -> [f64; 2] {
    let mut harness = shown_at(SPEED, &plan("peg_transfer"), SIZE, |app| app);
    press(&mut harness, "Demo");
    until(&mut harness, "engaged", |tick| tick.state == LoopState::Engaged);
    press(&mut harness, "2. Direct reflection");
    let mut began_s = None;
    let mut last_s = f64::INFINITY;
    let mut gap_s = 0.0_f64;
    loop {
        thread::sleep(rest);
        harness.step();
        let Tick { t_s, mode, .. } = *harness.state().tick().unwrap();
        gap_s = gap_s.max(t_s - last_s);
        last_s = t_s;
        match (mode, began_s) {
            (Mode::Dfr, None) => began_s = Some(t_s),
            (Mode::Linear, Some(began_s)) => return [t_s - began_s, gap_s],
            _ => assert!(t_s < 100.0, "{mode} at {t_s} s"),
        }
    }
}

#[test]
fn a_chapter_takes_as_long_in_a_window_that_draws_rarely() {
    for rest_ms in [2, 40, 100] {
        let [took_s, gap_s] = second_chapter_s(Duration::from_millis(rest_ms));
        println!("{rest_ms} ms between frames: {took_s:.2} s, frames at most {gap_s:.2} s of the loop apart");
        assert!((took_s - 14.0).abs() < 2.0 * gap_s + 0.1, "{took_s} s, frames at most {gap_s} s apart");
    }
}

/// A simulated world whose data can be withheld.
struct Silent {
    rig: Box<dyn Rig>,
    is_silent: Arc<AtomicBool>,
}

impl Rig for Silent {
    fn read(&mut self, now_s: f64) -> [Option<Inputs>; SIDES] {
        let inputs = self.rig.read(now_s);
        if self.is_silent.load(Ordering::Relaxed) { [None; SIDES] } else { inputs }
    }

    fn write(&mut self, now_s: f64, outputs: &[Outputs; SIDES]) {
        self.rig.write(now_s, outputs);
    }
}

/// Returns a console on a simulated rig that falls silent on request.
fn of_silent(speed: f64) -> (Console, Arc<AtomicBool>) {
    let plan = plan("peg_transfer");
    let is_silent = Arc::<AtomicBool>::default();
    let Assembly { rig, .. } = plan.simulated().unwrap();
    let rig = Box::new(Silent { rig, is_silent: Arc::clone(&is_silent) });
    let clock = RuntimeClock::Simulated { speed };
    let scheduling = SchedulingClass::Ordinary;
    let handle = runtime::start(Assembly { rig, clock, scheduling, ..plan.simulated().unwrap() }).unwrap();
    let console = Harness::builder()
        .with_size(SIZE)
        .with_step_dt(1.0 / 30.0)
        .build_eframe(move |cc| ConsoleApp::new(cc, handle, plan.rig, plan.scene).with_simulated_time(speed));
    (console, is_silent)
}

/// Makes the loop fault, because its rig is silent for a moment.
fn fault(console: &mut Console, is_silent: &AtomicBool) {
    is_silent.store(true, Ordering::Relaxed);
    until(console, "a fault", |tick| matches!(tick.state, LoopState::Faulted(_)));
    is_silent.store(false, Ordering::Relaxed);
}

#[test]
fn a_fault_in_each_chapter_is_explained_and_the_chapter_restarts() {
    let (mut console, is_silent) = of_silent(SPEED);
    press(&mut console, "Demo");
    until(&mut console, "engaged", |tick| tick.state == LoopState::Engaged);
    press(&mut console, "Pause demo");
    for (chapter, mode, delay_s) in [
        ("1. What you see", Mode::Best, 0.05),
        ("2. Direct reflection", Mode::Dfr, 0.3),
        ("3. Linear impedance", Mode::Linear, 0.3),
        ("4. Nonlinear, as in the paper", Mode::Literal, 0.3),
        ("5. Anchored", Mode::Anchored, 0.3),
        ("6. Matched", Mode::Matched, 0.3),
        ("7. Letting go", Mode::Dfr, 0.3),
        ("8. The governor", Mode::Dfr, 0.3),
        ("9. Your turn", Mode::Best, 0.05),
    ] {
        press(&mut console, chapter);
        let plays = |tick: &Tick| tick.mode == mode && (tick.delay_s - delay_s).abs() < 1e-9;
        until(&mut console, chapter, |tick| plays(tick) && tick.state == LoopState::Engaged);
        fault(&mut console, &is_silent);
        let faulted_s = console.state().tick().unwrap().t_s;
        read(&mut console, "Fault: The rig sent no valid data for 20 ms. The loop removed force and motion at once.");
        until(&mut console, "engaged again", |tick| tick.state == LoopState::Engaged && plays(tick));
        let explained_s = console.state().tick().unwrap().t_s - faulted_s;
        assert!(explained_s > 6.0, "{chapter}: explained for {explained_s} s");
    }
}

#[test]
fn a_window_counts_the_seconds_of_an_explanation_although_the_loop_rests() {
    let (mut console, is_silent) = of_silent(1.0);
    press(&mut console, "Demo");
    until(&mut console, "engaged", |tick| tick.state == LoopState::Engaged);
    fault(&mut console, &is_silent);
    let faulted_s = console.state().tick().unwrap().t_s;
    until(&mut console, "engaged again", |tick| tick.state == LoopState::Engaged);
    let explained_s = console.state().tick().unwrap().t_s - faulted_s;
    // The seconds are counted by frames, which come late on a busy machine: 12.7 s were observed there.
    assert!((7.0..20.0).contains(&explained_s), "explained for {explained_s} s");
}

#[test]
fn a_stop_that_is_pressed_under_a_fault_stays() {
    let (mut console, is_silent) = of_silent(SPEED);
    press(&mut console, "Demo");
    until(&mut console, "engaged", |tick| tick.state == LoopState::Engaged);
    fault(&mut console, &is_silent);
    read(&mut console, "the chapter restarts in");
    press(&mut console, "Stop");
    read(&mut console, "Stop was pressed, so the demonstration waits until you press Release stop, then Engage");
    let stopped_s = console.state().tick().unwrap().t_s;
    until(&mut console, "later", |tick| tick.t_s > stopped_s + 40.0);
    assert!(matches!(console.state().tick().unwrap().state, LoopState::Faulted(_)));
    press(&mut console, "Release stop");
    until(&mut console, "idle", |tick| tick.state == LoopState::Idle);
    press(&mut console, "Engage");
    until(&mut console, "engaged", |tick| tick.state == LoopState::Engaged);
}

#[test]
fn the_demonstration_lets_go_with_and_without_the_governor_and_leaves_everything_as_it_was() {
    let mut harness = console_of("peg_transfer", SIZE, |app| app);
    until(&mut harness, "engaged", |tick| tick.state == LoopState::Engaged);
    let (before, mode) = harness.state().tick().map(|tick| (tick.gates.settings, tick.mode)).unwrap();
    press(&mut harness, "Demo");
    press(&mut harness, "7. Letting go");
    until(&mut harness, "without a governor", |tick| tick.gates.settings.handle_kg == 0.0);
    press(&mut harness, "Pause demo");
    until(&mut harness, "the handle flies to where its mechanism ends", |tick| tick.positions.leader_m.z > 0.07);
    harness.get_by_label_contains("The handle moved");
    assert_eq!(harness.state().tick().unwrap().state, LoopState::Engaged, "nothing ends it");
    press(&mut harness, "8. The governor");
    until(&mut harness, "with the governor", |tick| tick.gates.settings == before_with_hold(before));
    until(&mut harness, "no hand holds the handle", |tick| tick.state == LoopState::Idle);
    let went = harness.get_by_label_contains("The handle moved").value().unwrap_or_default();
    // The pressing force at which the hand releases the handle differs between runs, and so does the travel: 0.9 to 2.1
    // mm, and 4.0 mm on a busy machine, where a late frame lets go at a weaker force.
    let few = ["moved 0.", "moved 1.", "moved 2.", "moved 3.", "moved 4."];
    assert!(few.iter().any(|few| went.contains(few)), "{went}");
    until(&mut harness, "engaged again", |tick| tick.state == LoopState::Engaged);
    harness.key_press(Key::F2);
    harness.step();
    until(&mut harness, "as before", |tick| tick.gates.settings == before && tick.mode == mode);
}

/// Returns a force that fades at standstill would leave nothing to release.
fn before_with_hold(before: ChainSettings) -> ChainSettings {
    ChainSettings { static_hold: true, ..before }
}
