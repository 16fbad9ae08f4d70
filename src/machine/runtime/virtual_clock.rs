//! Runs the loop on the virtual clock: the same code as on the real clock, without waiting, and deterministic.

use std::time::Instant;

use super::{
    Assembly, Summary,
    summary::Meters,
    tap::{Operation, Tap},
    thread::tell,
};
use crate::{
    messages::{Command, Scheduling, Tick},
    rig::{Rig, SIDES},
    teleop::{Link, Loop, Timing},
};

/// Runs the loop for `seconds` of loop time. `each` is called with every tick of every side; it may return a command
/// for the next tick, and ends the run by returning [`Command::Shutdown`].
pub fn run_virtual(assembly: Assembly, seconds: f64, mut each: impl FnMut(&Tick) -> Option<Command>) -> Summary {
    run(assembly, seconds, &mut each)
}

/// Built once, here, whatever is called with each tick.
fn run(assembly: Assembly, seconds: f64, each: &mut dyn FnMut(&Tick) -> Option<Command>) -> Summary {
    let Assembly { mut control, mut rig, rate_hz, engage, tap, .. } = assembly;
    let mut tap = tap.map(Tap::waiting);
    let period_s = 1.0 / rate_hz;
    let ticks = (seconds * rate_hz).round() as u64;
    let mut meters = Meters::default();
    let mut command = engage.then_some(Command::Engage);
    let mut work_s = 0.0;
    let start = Instant::now();
    while meters.ticks < ticks && command != Some(Command::Shutdown) {
        let now_s = meters.ticks as f64 * period_s;
        let before = Instant::now();
        let inputs = rig.read(now_s);
        let read = Instant::now();
        control.clear_events();
        if let Some(command) = command.take() {
            tell(&mut tap, Operation::Command { command, t_s: now_s });
            control.obey(command, now_s);
        }
        while let Some(command) = rig.command() {
            tell(&mut tap, Operation::Command { command, t_s: now_s });
            control.obey(command, now_s);
        }
        let timing = Timing { now_s, work_s, ..Timing::default() };
        let (outputs, ticks) = control.step(inputs, &timing);
        work_s = read.elapsed().as_secs_f64();
        rig.write(now_s, &outputs);
        rig.hear(now_s, &control.bulletins());
        if let Some(tap) = &mut tap {
            tap.tick(control.events(), &timing, &inputs, &outputs, &ticks);
        }
        meters.rig.record((read - before).as_secs_f64());
        meters.work.record(work_s);
        meters.ticks += 1;
        for tick in ticks.iter().flatten() {
            command = each(tick).or(command);
        }
    }
    let loop_s = meters.ticks as f64 * period_s;
    meters.summary("virtual", &control, loop_s, start.elapsed().as_secs_f64(), Scheduling::default())
}

/// One tick of a loop with its rig at `now_s`, for several loops on one clock. Its events stay in the loop until the next one.
pub fn tick<L: Link>(
    control: &mut Loop<L>,
    rig: &mut impl Rig,
    now_s: f64,
    command: Option<Command>,
) -> [Option<Tick>; SIDES] {
    let inputs = rig.read(now_s);
    control.clear_events();
    for command in command.into_iter().chain(std::iter::from_fn(|| rig.command())) {
        control.obey(command, now_s);
    }
    let (outputs, ticks) = control.step(inputs, &Timing { now_s, ..Timing::default() });
    rig.write(now_s, &outputs);
    rig.hear(now_s, &control.bulletins());
    ticks
}
