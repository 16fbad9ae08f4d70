//! Runs the loop on the real clock, in a thread named `realtime` that wakes at absolute deadlines.

use std::{
    io,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread::Builder,
};

use nima_core::impedance::SettingsError;
use rtrb::{Consumer, Producer};

use super::{
    Assembly, LoopHandle, RuntimeClock, RuntimeSummary,
    clock_profile::{TickTime, skip},
    loop_tap::{Operation, Tap},
    os,
    phase::LoopPhase,
    summary::{CpuFraction, DeviceFigures, Meters},
    supervisor::{Pulse, Supervisor},
    wrists::{self, Wrists},
};
use crate::{
    config::SchedulingClass,
    hand_over::{from_loop, to_loop},
    messages::{Command, Event, Tick},
    rig::{Gauges, Healths, Inputs, Outputs, Rig, RigError, SIDES},
    teleop::{Loop, Timing},
};

/// Capacity of the queue of ticks for the screen; further ticks are dropped. 8 s at 1 kHz. A window may be blocked for
/// seconds, for example by a dialog of the system, and the loop must not wait for it.
pub const TICKS_WAITING_MAX: usize = 8192;
/// Capacity of the queue of commands to the loop. A person cannot give more within a tick, so a full queue means that
/// the loop has ended.
const COMMANDS_WAITING_MAX: usize = 64;
/// Capacity of the queue of events for the screen.
pub(super) const EVENTS_WAITING_MAX: usize = 256;
/// Health and deliveries of the devices are published once per this many ticks: ten times per second at 1 kHz; a screen
/// needs no more.
const HEALTH_EVERY: u64 = 100;
/// Capacity of the queue of device deliveries; 4 s at 1 kHz, longer than any pause of the screen.
pub(super) const GAUGES_WAITING_MAX: usize = 40;
/// Maximum number of device events (connected, lost) handled in one tick. A burst of events would otherwise make the
/// tick late.
const DEVICE_EVENTS_PER_TICK_MAX: usize = 4;
/// Maximum number of commands executed in one tick; further ones wait for the next tick. Otherwise a burst of commands
/// would make the tick late.
const COMMANDS_PER_TICK_MAX: usize = 2;

#[derive(Debug, thiserror::Error)]
pub enum LoopStartError {
    /// The rig's settings are invalid.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// The operating system could not create a thread of the rig.
    #[error(transparent)]
    Rig(#[from] RigError),
    #[error("the real-time thread could not be started")]
    Thread(#[from] io::Error),
}

/// Starts the loop in its own thread.
///
/// # Errors
/// [`LoopStartError::Thread`] if the operating system cannot create the thread.
pub fn start(assembly: Assembly) -> Result<LoopHandle, LoopStartError> {
    let Assembly { control, rig, roster, rate_hz, clock, scheduling, engage, tap } = assembly;
    let pulse = Arc::new(Pulse::default());
    let levers = rig.levers();
    let ends = Arc::new(AtomicBool::new(false));
    let (commands, commands_in) = to_loop(COMMANDS_WAITING_MAX);
    let (ticks_out, ticks) = from_loop(TICKS_WAITING_MAX);
    let (events_out, events) = from_loop(EVENTS_WAITING_MAX);
    let (healths_out, healths) = from_loop(1);
    let (gauges_out, gauges) = from_loop(if roster.is_empty() { 1 } else { GAUGES_WAITING_MAX });
    let (wrists, wrist_door) = wrists::ends(&roster, 1.0 / rate_hz, tap.as_ref().map(Tap::filing));
    let realtime = Realtime {
        control,
        rig,
        wrists,
        engage,
        scheduling,
        names: roster.iter().map(|entry| entry.name().to_owned()).collect(),
        period_ns: (1e9 / rate_hz).round() as u64,
        is_late: false,
        clock,
        commands: commands_in,
        ends: Arc::clone(&ends),
        out: LoopSenders { ticks: ticks_out, events: events_out, healths: healths_out, gauges: gauges_out },
        meters: Meters::default(),
        pulse: Arc::clone(&pulse),
        tap,
    };
    let supervisor = Supervisor::start(pulse, levers, scheduling != SchedulingClass::Ordinary)?;
    let thread = Builder::new().name("realtime".to_owned()).spawn(move || realtime.run())?;
    let wrists = wrist_door;
    Ok(LoopHandle {
        commands,
        ends,
        ticks,
        events,
        healths,
        gauges,
        roster,
        wrists,
        thread: Some(thread),
        _supervisor: supervisor,
    })
}

/// Queues from the real-time thread to the others.
struct LoopSenders {
    ticks: Producer<Tick>,
    events: Producer<Event>,
    healths: Producer<Healths>,
    gauges: Producer<Gauges>,
}

struct Realtime {
    control: Loop,
    rig: Box<dyn Rig>,
    wrists: Wrists,
    scheduling: SchedulingClass,
    names: Vec<String>,
    /// Whether to engage once, as soon as every device delivers data.
    engage: bool,
    period_ns: u64,
    /// Whether a device had no new reading in the last tick.
    is_late: bool,
    clock: RuntimeClock,
    commands: Consumer<Command>,
    /// Set by an [`Ender`]; the loop then ends after the commands that were sent before.
    ends: Arc<AtomicBool>,
    out: LoopSenders,
    meters: Meters,
    pulse: Arc<Pulse>,
    tap: Option<Tap>,
}

impl Realtime {
    fn run(mut self) -> RuntimeSummary {
        let scheduling = os::prepare_thread(self.scheduling, self.period_ns);
        if self.clock == RuntimeClock::Real {
            self.out.events.push(Event::Scheduling(scheduling)).ok();
        }
        let cpu_s = os::cpu_s();
        let start_ns = os::monotonic_ns();
        if let Some(tap) = &self.tap {
            tap.begin(start_ns);
        }
        let mut timing = Timing::default();
        match self.clock {
            RuntimeClock::Real => self.run_in_real_time(start_ns, &mut timing),
            RuntimeClock::Simulated { speed } => self.run_in_simulated_time(start_ns, speed, &mut timing),
        }
        // However the loop ended, leave the hand without force and the follower at rest.
        self.rig.write(timing.now_s, &[Outputs::SAFE; SIDES]);
        self.pulse.beat(os::monotonic_ns(), false);
        let wall_s = (os::monotonic_ns() - start_ns) as f64 * 1e-9;
        let [realtime, process] = {
            let used_s = os::cpu_s();
            std::array::from_fn(|i| (used_s[i] - cpu_s[i]) / wall_s.max(1e-9))
        };
        let healths = self.rig.health();
        let devices = self.names.iter().zip(healths.devices);
        RuntimeSummary {
            cpu: Some(CpuFraction { realtime, process }),
            devices: devices
                .map(|(name, health)| DeviceFigures { name: name.clone(), health, trouble: None })
                .collect(),
            ..self.meters.summary("real", &self.control, timing.now_s, wall_s, scheduling)
        }
    }

    fn run_in_real_time(&mut self, start_ns: u64, timing: &mut Timing) {
        let mut deadline_ns = start_ns;
        let mut phase = LoopPhase::new(self.period_ns);
        while self.obey_commands(timing.now_s) {
            deadline_ns += self.period_ns + phase.step(self.is_late);
            os::sleep_until_ns(deadline_ns);
            let woke_ns = os::monotonic_ns();
            let late_ns = woke_ns.saturating_sub(deadline_ns);
            let (missed, rest_ns) = skip(late_ns, self.period_ns);
            deadline_ns += missed * self.period_ns;
            // Devices are read and the force is sent now, not at the deadline.
            let now_s = (deadline_ns + rest_ns - start_ns) as f64 * 1e-9;
            TickTime { now_s, wake_s: late_ns as f64 * 1e-9, missed }.enter(timing);
            self.tick(timing, woke_ns);
        }
    }

    fn run_in_simulated_time(&mut self, start_ns: u64, speed: f64, timing: &mut Timing) {
        let pace_ns = (self.period_ns as f64 / speed).round() as u64;
        let mut due_ns = start_ns;
        while self.obey_commands(timing.now_s) {
            due_ns += pace_ns;
            os::sleep_until_ns(due_ns);
            let woke_ns = os::monotonic_ns();
            // Do not catch up after a delay, because that would cause a burst of ticks.
            due_ns = due_ns.max(woke_ns.saturating_sub(pace_ns));
            timing.now_s += self.period_ns as f64 * 1e-9;
            self.tick(timing, woke_ns);
        }
    }

    /// Returns false if the loop must end.
    fn obey_commands(&mut self, now_s: f64) -> bool {
        self.control.clear_events();
        for _ in 0..COMMANDS_PER_TICK_MAX {
            // Read before the queue: a command that was sent before the end is then in it.
            let ends = self.ends.load(Ordering::Acquire);
            match self.commands.pop() {
                Ok(Command::Shutdown) => return false,
                Ok(command) => self.obey(command, now_s),
                Err(_) if ends => return false,
                Err(_) => break,
            }
        }
        true
    }

    fn obey(&mut self, command: Command, t_s: f64) {
        report(&mut self.tap, Operation::Command { command, t_s });
        self.control.obey(command, t_s);
    }

    fn tick(&mut self, timing: &mut Timing, woke_ns: u64) {
        let inputs = self.rig.read(timing.now_s);
        let read_ns = os::monotonic_ns();
        if let Some(silent_s) = self.pulse.take_pulled(read_ns) {
            report(&mut self.tap, Operation::Stall { silent_s, t_s: timing.now_s });
            self.control.notice_stall(silent_s, timing.now_s);
        }
        for _ in 0..DEVICE_EVENTS_PER_TICK_MAX {
            let Some(event) = self.rig.event() else { break };
            report(&mut self.tap, Operation::Device(event));
            self.control.notice(&event);
            self.wrists.notice(&event, &mut self.control, &mut self.tap);
            self.out.events.push(Event::Device(event)).ok();
        }
        self.wrists.activate(&mut self.control, &mut self.tap);
        for _ in 0..COMMANDS_PER_TICK_MAX {
            let Some(command) = self.rig.command() else { break };
            self.obey(command, timing.now_s);
        }
        if self.engage && self.control.is_idle_with(&inputs) {
            self.engage = false;
            self.obey(Command::Engage, timing.now_s);
        }
        let (outputs, ticks) = self.control.step(inputs, timing);
        let worked_ns = os::monotonic_ns();
        self.rig.write(timing.now_s, &outputs);
        let written_ns = os::monotonic_ns();
        self.rig.receive_status(timing.now_s, &self.control.bulletins());
        let stalls = self.clock == RuntimeClock::Real;
        if self.control.withholds_beat() {
            self.pulse.withhold();
        } else {
            self.pulse.beat(written_ns, stalls && outputs.iter().any(|outputs| outputs.drives));
        }
        // After the force has been sent to the device, so that the force does not wait for the tap.
        if let Some(tap) = &mut self.tap {
            tap.tick(self.control.events(), timing, &inputs, &outputs, &ticks);
        }
        self.meter(timing, &inputs, [woke_ns, read_ns, worked_ns, written_ns]);
        self.publish(timing.now_s, &ticks);
    }

    /// Adds the times of a tick: after waking up, reading, computing, writing.
    fn meter(&mut self, timing: &mut Timing, inputs: &[Option<Inputs>; SIDES], times_ns: [u64; 4]) {
        let [woke_ns, read_ns, worked_ns, written_ns] = times_ns;
        timing.work_s = (worked_ns - read_ns) as f64 * 1e-9;
        self.meters.wake.record(timing.wake_s);
        self.meters.rig.record((read_ns - woke_ns + written_ns - worked_ns) as f64 * 1e-9);
        self.meters.work.record(timing.work_s);
        let age_s = inputs.iter().flatten().map(|inputs| inputs.age_s).fold(0.0, f64::max);
        self.is_late = age_s * 2e9 > self.period_ns as f64;
        timing.sample_to_force_s =
            inputs.iter().any(Option::is_some).then(|| age_s + (written_ns - woke_ns) as f64 * 1e-9);
        if let Some(seconds) = timing.sample_to_force_s {
            self.meters.sample_to_force.record(seconds);
        }
        self.meters.ticks += 1;
    }

    /// Passes events, health and ticks to the window.
    fn publish(&mut self, now_s: f64, ticks: &[Option<Tick>; SIDES]) {
        for event in self.control.events() {
            self.out.events.push(*event).ok();
        }
        if self.meters.ticks.is_multiple_of(HEALTH_EVERY) {
            self.out.healths.push(self.rig.health()).ok();
            if let Some(gauges) = self.rig.gauges(now_s) {
                self.out.gauges.push(gauges).ok();
            }
        }
        for tick in ticks.iter().flatten() {
            let mut tick = *tick;
            tick.timing.dropped = self.meters.dropped;
            if self.out.ticks.push(tick).is_err() {
                self.meters.dropped += 1;
            }
        }
    }
}

/// Adds an operation to a tap.
pub(super) fn report(tap: &mut Option<Tap>, operation: Operation) {
    if let Some(tap) = tap {
        tap.operation(operation);
    }
}
