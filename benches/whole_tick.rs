//! The whole tick of two arm pairs with all stages, without devices, simulation and queues: time and allocations.
//!
//! `./dev bench`. The bimanual scene is recorded once with the loop's own outputs and replayed into loops of each mode.
#![expect(clippy::unwrap_used, reason = "a benchmark fails by panicking")]

#[path = "../tests/allocation/counting.rs"]
mod counting;

use std::{hint::black_box, time::Instant};

use counting::calls;
use nima_core::impedance::Mode;
use nima_machine::{
    config::RigConfig,
    messages::{Command, LoopState},
    rig::{Inputs, Rig as _, SIDES},
    teleop::{Calibrations, Loop, Timing},
};
use nima_simulation::{Worlds, scene::Scene};

const TICKS: usize = 60_000;

fn control(rig: &RigConfig) -> Loop {
    let mut control = Loop::new(rig, &[Some(Calibrations::default()), Some(Calibrations::default())]).unwrap();
    control.obey(Command::Engage, 0.0);
    control
}

fn timing(tick: usize) -> Timing {
    Timing { now_s: tick as f64 * 1e-3, ..Timing::default() }
}

fn recorded(rig: &RigConfig) -> Vec<[Option<Inputs>; SIDES]> {
    let mut worlds = Worlds::new(&Scene::load("bimanual").unwrap(), rig.rate_hz);
    let mut control = control(rig);
    (0..TICKS)
        .map(|tick| {
            let inputs = worlds.read(timing(tick).now_s);
            let (outputs, _) = control.step(inputs, &timing(tick));
            worlds.write(timing(tick).now_s, &outputs);
            inputs
        })
        .collect()
}

fn main() {
    for mode in Mode::ALL {
        let mut rig = RigConfig::load("simulated").unwrap();
        rig.mode = mode;
        let inputs = recorded(&rig);
        let mut control = control(&rig);
        let mut times_us = Vec::with_capacity(TICKS);
        let before = calls();
        for (tick, inputs) in inputs.iter().enumerate() {
            control.clear_events();
            let start = Instant::now();
            black_box(control.step(black_box(*inputs), &timing(tick)));
            times_us.push(1e6 * start.elapsed().as_secs_f64());
        }
        let allocations = calls() - before;
        let engaged = control.pairs().all(|pair| pair.state() == LoopState::Engaged);
        assert!(engaged, "{mode}: the replay did not engage");
        times_us.sort_by(f64::total_cmp);
        let at = |fraction: f64| times_us[(fraction * (TICKS - 1) as f64) as usize];
        println!(
            "whole tick, two arms, {mode}: p50 {:.1} us, p99 {:.1} us, p99.9 {:.1} us, max {:.1} us, {allocations} allocations in {TICKS} ticks",
            at(0.5),
            at(0.99),
            at(0.999),
            at(1.0)
        );
    }
}
