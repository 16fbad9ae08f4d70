//! Runs the loop on the virtual clock: the same code as on the real clock, without waiting, and deterministic.

use std::time::Instant;

use super::{
    Assembly, RuntimeSummary,
    clock_profile::{ClockProfile, TickTime, VirtualClock},
    loop_tap::{Operation, Tap},
    summary::Meters,
    supervisor::STALL_MAX_S,
    thread::report,
};
use crate::{
    messages::{Command, Scheduling, Tick},
    rig::{Outputs, Rig, SIDES},
    teleop::{Link, Loop, Timing},
};

/// Runs the loop for `seconds` of loop time. `each` is called with every tick of every side; it may return a command
/// for the next tick, and ends the run by returning [`Command::Shutdown`].
pub fn run_virtual(assembly: Assembly, seconds: f64, each: impl FnMut(&Tick) -> Option<Command>) -> RuntimeSummary {
    run_virtual_on(VirtualClock::PERFECT, assembly, seconds, each)
}

/// Runs the loop as [`run_virtual`] does, with the late ticks of this clock.
pub fn run_virtual_on(
    clock: VirtualClock,
    assembly: Assembly,
    seconds: f64,
    mut each: impl FnMut(&Tick) -> Option<Command>,
) -> RuntimeSummary {
    run(clock, assembly, seconds, &mut each)
}

/// Compiled once, independent of the type of `each`.
fn run(
    clock: VirtualClock,
    assembly: Assembly,
    seconds: f64,
    each: &mut dyn FnMut(&Tick) -> Option<Command>,
) -> RuntimeSummary {
    let Assembly { mut control, mut rig, rate_hz, engage, tap, .. } = assembly;
    let mut tap = tap.map(Tap::waiting);
    let mut times = clock.tick_times(rate_hz);
    let mut supervisor = VirtualSupervisor::default();
    // Half a period before the end, because times are rounded.
    let end_s = ((seconds * rate_hz).round() - 0.5) / rate_hz;
    let mut meters = Meters::default();
    let mut missed = 0;
    let mut command = engage.then_some(Command::Engage);
    let mut timing = Timing::default();
    let start = Instant::now();
    while command != Some(Command::Shutdown) {
        let time = times.advance();
        if time.now_s > end_s {
            break;
        }
        missed += time.missed;
        time.enter(&mut timing);
        let now_s = time.now_s;
        let before = Instant::now();
        let inputs = rig.read(now_s);
        let read = Instant::now();
        control.clear_events();
        if let Some(silent_s) = supervisor.stalled_s(&time) {
            report(&mut tap, Operation::Stall { silent_s, t_s: now_s });
            control.notice_stall(silent_s, now_s);
        }
        for command in command.take().into_iter().chain(std::iter::from_fn(|| rig.command())) {
            report(&mut tap, Operation::Command { command, t_s: now_s });
            control.obey(command, now_s);
        }
        let (outputs, ticks) = control.step(inputs, &timing);
        let work_s = read.elapsed().as_secs_f64();
        rig.write(now_s, &outputs);
        rig.receive_status(now_s, &control.bulletins());
        supervisor.beat(now_s, &outputs);
        if let Some(tap) = &mut tap {
            tap.tick(control.events(), &timing, &inputs, &outputs, &ticks);
        }
        timing.work_s = work_s;
        meters.wake.record(timing.wake_s);
        meters.rig.record((read - before).as_secs_f64());
        meters.work.record(work_s);
        meters.ticks += 1;
        for tick in ticks.iter().flatten() {
            command = each(tick).or(command);
        }
    }
    let loop_s = (meters.ticks + missed) as f64 / rate_hz;
    RuntimeSummary {
        lateness: Some(clock).filter(|clock| clock.profile != ClockProfile::Perfect),
        ..meters.summary("virtual", &control, loop_s, start.elapsed().as_secs_f64(), Scheduling::default())
    }
}

/// Replaces the supervisor of the real clock: a loop that was silent for too long with its drives on loses them.
#[derive(Clone, Copy, Debug, Default)]
pub struct VirtualSupervisor {
    driven_at_s: Option<f64>,
}

impl VirtualSupervisor {
    /// Records that the loop sent these outputs at this time, s.
    pub fn beat(&mut self, now_s: f64, outputs: &[Outputs; SIDES]) {
        self.driven_at_s = outputs.iter().any(|outputs| outputs.drives).then_some(now_s);
    }

    /// Returns how long the loop was silent, s, if it missed periods for too long; for [`Loop::notice_stall`].
    pub fn stalled_s(&self, time: &TickTime) -> Option<f64> {
        let silent_s = self.driven_at_s.filter(|_| time.missed > 0).map(|at_s| time.now_s - at_s);
        silent_s.filter(|silent_s| *silent_s > STALL_MAX_S)
    }
}

/// Executes one tick of a loop with its rig at this time, for several loops on one clock. Its events stay in the loop
/// until the next tick.
pub fn tick<L: Link>(
    control: &mut Loop<L>,
    rig: &mut impl Rig,
    time: impl Into<TickTime>,
    command: Option<Command>,
) -> [Option<Tick>; SIDES] {
    let timing = Timing::from(time.into());
    let now_s = timing.now_s;
    let inputs = rig.read(now_s);
    control.clear_events();
    for command in command.into_iter().chain(std::iter::from_fn(|| rig.command())) {
        control.obey(command, now_s);
    }
    let (outputs, ticks) = control.step(inputs, &timing);
    rig.write(now_s, &outputs);
    rig.receive_status(now_s, &control.bulletins());
    ticks
}
