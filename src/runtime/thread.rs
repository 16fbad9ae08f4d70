//! The loop on the real clock: a thread named `realtime` with absolute deadlines.

use std::{
    io,
    sync::Arc,
    thread::{Builder, JoinHandle},
};

use crossbeam_channel::{Receiver, Sender, TryRecvError, bounded};

use super::{
    Command, Event, Plan, Summary, Tick, os,
    summary::{CpuShare, DeviceFigures, Meters},
    supervisor::{Pulse, Supervisor},
};
use crate::{
    config::SchedulingClass,
    device::{Healths, Outputs, Rig, Roster, SIDES, rig::RigError},
    impedance::SettingsError,
    teleop::{Loop, Timing},
};

/// Ticks that wait for the screen before new ones are dropped: 8 s at 1 kHz.
const TICKS_WAITING_MAX: usize = 8192;
/// Commands that wait for the loop.
const COMMANDS_WAITING_MAX: usize = 64;
/// Events that wait for the screen.
const EVENTS_WAITING_MAX: usize = 256;
/// Ticks between two looks at the health of the devices.
const HEALTH_EVERY: u64 = 100;
/// Devices that may come or go in one tick.
const DEVICE_EVENTS_PER_TICK_MAX: usize = 4;
/// Commands obeyed in one tick; the rest wait for the next.
const COMMANDS_PER_TICK_MAX: usize = 2;

/// Why a loop could not be started.
#[derive(Debug, thiserror::Error)]
pub enum StartError {
    /// The rig's settings are not usable.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// The rig's devices cannot be set up.
    #[error(transparent)]
    Rig(#[from] RigError),
    /// The operating system gave no thread.
    #[error("the real-time thread could not be started")]
    Thread(#[from] io::Error),
}

/// One running loop. Dropping it ends the loop.
#[derive(Debug)]
pub struct Handle {
    commands: Sender<Command>,
    ticks: Receiver<Tick>,
    events: Receiver<Event>,
    healths: Receiver<Healths>,
    roster: Roster,
    thread: Option<JoinHandle<Summary>>,
    /// Outlives the loop: fields are dropped after [`Drop`] has joined its thread.
    _supervisor: Supervisor,
}

/// Starts the loop in its own thread.
pub fn start(plan: &Plan) -> Result<Handle, StartError> {
    let (rig, roster) = plan.assemble()?;
    start_on(plan, rig, roster)
}

/// The same on a rig that the caller made: one with faults in it.
pub fn start_on(plan: &Plan, rig: Box<dyn Rig>, roster: Roster) -> Result<Handle, StartError> {
    let control = plan.control()?;
    let (pulse, levers) = (Arc::new(Pulse::default()), rig.levers());
    let (commands, commands_in) = bounded(COMMANDS_WAITING_MAX);
    let (ticks_out, ticks) = bounded(TICKS_WAITING_MAX);
    let (events_out, events) = bounded(EVENTS_WAITING_MAX);
    let (healths_out, healths) = bounded(1);
    let realtime = Realtime {
        control,
        rig,
        engage: plan.engage,
        scheduling: plan.rig.scheduling,
        names: roster.iter().map(|entry| entry.name.clone()).collect(),
        period_ns: (1e9 / plan.rig.rate_hz).round() as u64,
        commands: commands_in,
        ticks: ticks_out,
        events: events_out,
        healths: healths_out,
        meters: Meters::default(),
        pulse: Arc::clone(&pulse),
    };
    let supervisor = Supervisor::start(pulse, levers, plan.rig.scheduling != SchedulingClass::Ordinary)?;
    let thread = Builder::new().name("realtime".to_owned()).spawn(move || realtime.run())?;
    Ok(Handle { commands, ticks, events, healths, roster, thread: Some(thread), _supervisor: supervisor })
}

impl Handle {
    /// Sends a command; false when the queue is full or the loop has ended.
    pub fn send(&self, command: Command) -> bool {
        self.commands.try_send(command).is_ok()
    }

    /// Hands over every waiting tick, oldest first, without blocking.
    pub fn drain_ticks(&self, mut each: impl FnMut(&Tick)) {
        // Bounded, so that a slow screen cannot be kept here by a fast loop.
        self.ticks.try_iter().take(TICKS_WAITING_MAX).for_each(|tick| each(&tick));
    }

    /// Hands over every waiting event, oldest first, without blocking.
    pub fn drain_events(&self, mut each: impl FnMut(&Event)) {
        self.events.try_iter().take(EVENTS_WAITING_MAX).for_each(|event| each(&event));
    }

    /// The devices of the rig; empty where everything is simulated.
    pub fn roster(&self) -> &Roster {
        &self.roster
    }

    /// How the devices are, if that is newer than the last time.
    pub fn healths(&self) -> Option<Healths> {
        self.healths.try_recv().ok()
    }

    /// The loop's thread is alive.
    pub fn is_running(&self) -> bool {
        self.thread.as_ref().is_some_and(|thread| !thread.is_finished())
    }

    /// Ends the loop and gives its figures; `None` if its thread died.
    pub fn stop_and_join(mut self) -> Option<Summary> {
        self.end()
    }

    fn end(&mut self) -> Option<Summary> {
        let thread = self.thread.take()?;
        // A full queue must not keep a loop alive: wait for room.
        self.commands.send(Command::Shutdown).ok();
        thread.join().ok()
    }
}

impl Drop for Handle {
    fn drop(&mut self) {
        self.end();
    }
}

struct Realtime {
    control: Loop,
    rig: Box<dyn Rig>,
    scheduling: SchedulingClass,
    /// Names of the devices.
    names: Vec<String>,
    /// Engage once, as soon as everything delivers.
    engage: bool,
    period_ns: u64,
    commands: Receiver<Command>,
    ticks: Sender<Tick>,
    events: Sender<Event>,
    healths: Sender<Healths>,
    meters: Meters,
    pulse: Arc<Pulse>,
}

impl Realtime {
    fn run(mut self) -> Summary {
        let scheduling = os::prepare_thread(self.scheduling, self.period_ns);
        self.events.try_send(Event::Scheduling(scheduling)).ok();
        let cpu_s = os::cpu_s();
        let start_ns = os::monotonic_ns();
        let mut deadline_ns = start_ns;
        let mut outputs = [Outputs::SAFE; SIDES];
        let mut timing = Timing::default();
        while self.obey_commands(timing.now_s) {
            deadline_ns += self.period_ns;
            os::sleep_until_ns(deadline_ns);
            let woke_ns = os::monotonic_ns();
            let late_ns = woke_ns.saturating_sub(deadline_ns);
            // Whole periods that passed are counted and skipped, never caught up in a burst.
            timing.missed_now = late_ns / self.period_ns;
            deadline_ns += timing.missed_now * self.period_ns;
            timing.now_s = (deadline_ns - start_ns) as f64 * 1e-9;
            timing.wake_s = late_ns as f64 * 1e-9;
            outputs = self.tick(&outputs, &mut timing, woke_ns);
        }
        // Whatever ends the loop, the hand is left without force and the follower at rest.
        self.rig.exchange(timing.now_s, &[Outputs::SAFE; SIDES]);
        self.pulse.beat(os::monotonic_ns(), false);
        let wall_s = (os::monotonic_ns() - start_ns) as f64 * 1e-9;
        let [realtime, process] = {
            let used_s = os::cpu_s();
            std::array::from_fn(|i| (used_s[i] - cpu_s[i]) / wall_s.max(1e-9))
        };
        let healths = self.rig.health();
        let devices = self.names.iter().zip(healths.devices);
        Summary {
            cpu: CpuShare { realtime, process },
            devices: devices.map(|(name, health)| DeviceFigures { name: name.clone(), health }).collect(),
            ..self.meters.summary("real", &self.control, timing.now_s, wall_s, scheduling)
        }
    }

    /// False when the loop shall end.
    fn obey_commands(&mut self, now_s: f64) -> bool {
        self.control.clear_events();
        for _ in 0..COMMANDS_PER_TICK_MAX {
            match self.commands.try_recv() {
                Ok(Command::Shutdown) | Err(TryRecvError::Disconnected) => return false,
                Ok(command) => self.control.obey(command, now_s),
                Err(TryRecvError::Empty) => break,
            }
        }
        true
    }

    fn tick(&mut self, outputs: &[Outputs; SIDES], timing: &mut Timing, woke_ns: u64) -> [Outputs; SIDES] {
        let inputs = self.rig.exchange(timing.now_s, outputs);
        let exchanged_ns = os::monotonic_ns();
        if let Some(silent_s) = self.pulse.take_pulled() {
            self.control.notice_stall(silent_s, timing.now_s);
        }
        for _ in 0..DEVICE_EVENTS_PER_TICK_MAX {
            let Some(event) = self.rig.event() else { break };
            self.control.notice(&event);
            self.events.try_send(Event::Device(event)).ok();
        }
        if self.engage && self.control.is_idle_with(&inputs) {
            self.engage = false;
            self.control.obey(Command::Engage, timing.now_s);
        }
        let (next, ticks) = self.control.step(inputs, timing);
        let worked_ns = os::monotonic_ns();
        self.rig.apply(timing.now_s, &next);
        let applied_ns = os::monotonic_ns();
        self.pulse.beat(applied_ns, next.iter().any(|outputs| outputs.drives));
        timing.work_s = (worked_ns - exchanged_ns) as f64 * 1e-9;
        self.meters.wake.record(timing.wake_s);
        self.meters.rig.record((exchanged_ns - woke_ns + applied_ns - worked_ns) as f64 * 1e-9);
        self.meters.work.record(timing.work_s);
        timing.sample_to_force_s = inputs.iter().any(Option::is_some).then(|| {
            let age_s = inputs.iter().flatten().map(|inputs| inputs.age_s).fold(0.0, f64::max);
            age_s + (applied_ns - woke_ns) as f64 * 1e-9
        });
        if let Some(seconds) = timing.sample_to_force_s {
            self.meters.sample_to_force.record(seconds);
        }
        self.meters.ticks += 1;
        for event in self.control.events() {
            self.events.try_send(*event).ok();
        }
        if self.meters.ticks.is_multiple_of(HEALTH_EVERY) {
            self.healths.try_send(self.rig.health()).ok();
        }
        for mut tick in ticks.into_iter().flatten() {
            tick.dropped = self.meters.dropped;
            if self.ticks.try_send(tick).is_err() {
                self.meters.dropped += 1;
            }
        }
        next
    }
}

#[cfg(test)]
mod tests {
    use std::time::{Duration, Instant};

    use super::*;
    use crate::{
        config::{Rig, Scene},
        impedance::Mode,
        teleop::{Calibrations, LoopState},
    };

    fn plan() -> Plan {
        Plan {
            rig: Rig::load("simulated").unwrap(),
            scene: Scene::load("peg_transfer").unwrap(),
            calibrations: Calibrations::default(),
            left_calibrations: Calibrations::default(),
            engage: true,
        }
    }

    /// Waits until a tick satisfies `good`; gives it.
    fn wait_for(handle: &Handle, good: impl Fn(&Tick) -> bool) -> Option<Tick> {
        let until = Instant::now() + Duration::from_secs(10);
        let mut found = None;
        while found.is_none() && Instant::now() < until {
            handle.drain_ticks(|tick| {
                if found.is_none() && good(tick) {
                    found = Some(*tick);
                }
            });
            std::thread::sleep(Duration::from_millis(2));
        }
        found
    }

    #[test]
    fn the_loop_runs_obeys_and_ends() {
        let handle = start(&plan()).unwrap();
        assert!(wait_for(&handle, |tick| tick.state == LoopState::Engaged).is_some());
        assert!(handle.send(Command::SetMode(Mode::Dfr)));
        assert!(wait_for(&handle, |tick| tick.mode == Mode::Dfr).is_some());
        assert!(handle.send(Command::Stop));
        let stopped = wait_for(&handle, |tick| tick.state == LoopState::Stopped).unwrap();
        assert!(stopped.rendered_n.norm() < f64::EPSILON);
        assert!(handle.send(Command::Engage));
        assert!(handle.send(Command::ReleaseStop));
        assert!(wait_for(&handle, |tick| tick.state == LoopState::Idle).is_some(), "engaging out of a stop is refused");
        let mut refused = false;
        handle.drain_events(|event| refused |= matches!(event, Event::CommandRefused { command: Command::Engage, .. }));
        assert!(refused);
        let summary = handle.stop_and_join().unwrap();
        assert!(summary.ticks > 0);
        let periods = summary.seconds * 1000.0;
        assert!(
            (periods - (summary.ticks + summary.missed) as f64).abs() < 1.5,
            "every period is a tick or counted as missed"
        );
    }

    #[test]
    fn a_full_screen_queue_is_counted_and_never_waited_for() {
        let handle = start(&plan()).unwrap();
        std::thread::sleep(Duration::from_millis(9500));
        let summary = handle.stop_and_join().unwrap();
        assert_eq!(summary.dropped, summary.ticks.saturating_sub(TICKS_WAITING_MAX as u64));
        assert!(summary.dropped > 0);
    }
}
