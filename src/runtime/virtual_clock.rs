//! The loop on the virtual clock: the same code, no waiting, deterministic.

use std::time::Instant;

use super::{Command, Plan, Scheduling, Summary, Tick, summary::Meters};
use crate::{
    device::{Outputs, Rig as _, SIDES},
    impedance::SettingsError,
    teleop::Timing,
};

/// Runs `plan` for `seconds` of loop time; `each` sees every tick of every side, may give a command for the next and ends the run with
/// [`Command::Shutdown`].
pub fn run_virtual(
    plan: &Plan,
    seconds: f64,
    mut each: impl FnMut(&Tick) -> Option<Command>,
) -> Result<Summary, SettingsError> {
    let (mut control, mut worlds) = (plan.control()?, plan.worlds());
    let period_s = 1.0 / plan.rig.rate_hz;
    let ticks = (seconds * plan.rig.rate_hz).round() as u64;
    let mut meters = Meters::default();
    let mut outputs = [Outputs::SAFE; SIDES];
    let mut command = plan.engage.then_some(Command::Engage);
    let mut work_s = 0.0;
    let start = Instant::now();
    while meters.ticks < ticks && command != Some(Command::Shutdown) {
        let now_s = meters.ticks as f64 * period_s;
        let before = Instant::now();
        let inputs = worlds.exchange(now_s, &outputs);
        let exchanged = Instant::now();
        control.clear_events();
        if let Some(command) = command.take() {
            control.obey(command, now_s);
        }
        let (next, ticks) = control.step(inputs, &Timing { now_s, work_s, ..Timing::default() });
        outputs = next;
        work_s = exchanged.elapsed().as_secs_f64();
        meters.rig.record((exchanged - before).as_secs_f64());
        meters.work.record(work_s);
        meters.ticks += 1;
        for tick in ticks.iter().flatten() {
            command = each(tick).or(command);
        }
    }
    let loop_s = meters.ticks as f64 * period_s;
    Ok(meters.summary("virtual", &control, loop_s, start.elapsed().as_secs_f64(), Scheduling::default()))
}
