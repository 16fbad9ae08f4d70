//! One tick of the whole loop for one arm pair: measurements in, force and motion out.
//!
//! Takes [`Inputs`] (m, N, workspace frame) and the time (s); gives [`Outputs`] and fills a [`Tick`] for the screen.
//! The same code runs on the real and on the virtual clock. Pure and deterministic; nothing is allocated after
//! construction. Bad input (missing or not finite) means no force at once and a fault if it lasts.

mod accuracy;
mod force_path;
mod link;
mod state;
mod tracking;

use nalgebra::Vector3;

pub use accuracy::{Accuracy, ErrorStats};
pub use force_path::{Calibrations, ForcePath, ForceReport, ForceSource};
pub use link::Link;
pub use state::LoopState;
pub use tracking::Tracking;

use crate::{
    config::Rig as RigConfig,
    device::{Inputs, Outputs, Prompt, Sensed},
    impedance::{Identifier, MAX_DELAY_S, Mode, Rendered, Renderer, Sample, SettingsError},
    runtime::{Command, Event, Fault, Tick},
    safety::{Chain, Request},
};

/// Rig silent for longer than this, s: fault.
const SILENT_AFTER_S: f64 = 0.020;
/// Missed periods in a row that make a fault, as time, s.
const STALLED_AFTER_S: f64 = 0.050;
/// Farthest from the middle of the workspace that the screen may lead the handle, on each axis, m.
pub const GUIDE_MAX_M: f64 = 0.1;
/// Most events told in one tick; more in one tick is not possible.
pub const EVENTS_PER_TICK_MAX: usize = 4;

/// When a tick ran: handed in, never asked for.
#[derive(Clone, Copy, Debug, Default)]
pub struct Timing {
    /// Loop time of this tick, s.
    pub now_s: f64,
    /// How late the tick woke after its deadline, s.
    pub wake_s: f64,
    /// How long the tick before worked, s.
    pub work_s: f64,
    /// Periods missed just before this tick.
    pub missed_now: u64,
}

/// The loop's whole memory.
#[derive(Debug)]
pub struct Loop {
    state: LoopState,
    mode: Mode,
    delay_s: f64,
    rate_hz: f64,
    follower_step_max_m: f64,
    identifier: Identifier,
    renderer: Renderer,
    force_path: ForcePath,
    force: ForceReport,
    prompt: Prompt,
    guide_m: Option<Vector3<f64>>,
    link: Link,
    tracking: Tracking,
    chain: Chain,
    last_inputs: Option<Inputs>,
    last_input_s: f64,
    command_m: Option<Vector3<f64>>,
    hand_speed_m_s: f64,
    accuracy: Accuracy,
    ticks: u64,
    missed: u64,
    events: [Option<Event>; EVENTS_PER_TICK_MAX],
}

impl Loop {
    /// A loop for this rig, idle. Everything is allocated here.
    pub fn new(rig: &RigConfig, calibrations: &Calibrations) -> Result<Self, SettingsError> {
        let settings = rig.settings();
        let mut this = Self {
            state: LoopState::Idle,
            mode: rig.mode,
            delay_s: rig.delay_s,
            rate_hz: rig.rate_hz,
            follower_step_max_m: rig.follower_speed_max_m_s / rig.rate_hz,
            identifier: Identifier::new(&settings)?,
            renderer: Renderer::new(&settings)?,
            force_path: ForcePath::new(calibrations, 1.0 / rig.rate_hz),
            force: NO_FORCE_YET,
            prompt: Prompt::Rest,
            guide_m: None,
            link: Link::new(rig.rate_hz, rig.delay_s),
            tracking: Tracking::new(rig.rate_hz),
            chain: Chain::new(rig.gates, 1.0 / rig.rate_hz),
            last_inputs: None,
            last_input_s: 0.0,
            command_m: None,
            hand_speed_m_s: 0.0,
            accuracy: Accuracy::default(),
            ticks: 0,
            missed: 0,
            events: [None; EVENTS_PER_TICK_MAX],
        };
        this.set_delay(rig.delay_s);
        Ok(this)
    }

    /// State now.
    pub const fn state(&self) -> LoopState {
        self.state
    }

    /// Errors per mode since construction.
    pub const fn accuracy(&self) -> &Accuracy {
        &self.accuracy
    }

    /// Periods missed since construction.
    pub const fn missed(&self) -> u64 {
        self.missed
    }

    /// What happened in the last tick, oldest first.
    pub fn events(&self) -> impl Iterator<Item = &Event> {
        self.events.iter().flatten()
    }

    /// Forgets the events of the last tick; call before handling commands of the next.
    pub fn clear_events(&mut self) {
        self.events = [None; EVENTS_PER_TICK_MAX];
    }

    fn tell(&mut self, event: Event) {
        if let Some(free) = self.events.iter_mut().find(|slot| slot.is_none()) {
            *free = Some(event);
        }
    }

    fn go(&mut self, to: LoopState, t_s: f64) {
        if self.state != to {
            self.tell(Event::StateChanged { t_s, from: self.state, to });
            self.state = to;
            // Entering any state starts from no force; only an engaged loop builds it up again, under the slew limit.
            self.chain.reset();
            self.command_m = None;
            self.prompt = Prompt::Rest;
            if matches!(to, LoopState::Stopped | LoopState::Faulted(_)) {
                self.guide_m = None;
            }
        }
    }

    fn set_delay(&mut self, delay_s: f64) {
        // The delay is exact to one sample, and the screen shows what is in force.
        let samples = (delay_s * self.rate_hz).round();
        self.delay_s = samples / self.rate_hz;
        self.link.set_delay(self.delay_s);
        self.identifier.set_delay(self.delay_s);
        self.renderer.set_delay(self.delay_s);
    }

    /// Carries out one command, or tells that it was refused. [`Command::Shutdown`] is the runtime's.
    pub fn obey(&mut self, command: Command, t_s: f64) {
        let done = match command {
            Command::SetMode(mode) => {
                self.mode = mode;
                true
            }
            Command::SetGain(gain) if (0.0..=1.0).contains(&gain) => {
                self.chain.set_gain(gain);
                true
            }
            Command::SetGainAboveOne(gain) if (0.0..=crate::safety::MAX_GAIN).contains(&gain) => {
                self.chain.set_gain(gain);
                true
            }
            Command::SetDelay(delay_s) if (0.0..=MAX_DELAY_S).contains(&delay_s) => {
                self.set_delay(delay_s);
                true
            }
            Command::SetDeadBand(speed_m_s) if (0.0..=0.1).contains(&speed_m_s) => {
                self.chain.set_dead_band(speed_m_s);
                true
            }
            Command::SetStaticHold(hold) => {
                self.chain.set_static_hold(hold);
                true
            }
            // Whoever is asked to handle the arm must be safe from it.
            Command::Prompt(prompt) if self.state == LoopState::Idle && prompt.is_finite() => {
                self.prompt = prompt;
                true
            }
            Command::Guide(guide_m)
                if !matches!(self.state, LoopState::Stopped | LoopState::Faulted(_))
                    && guide_m.is_none_or(|at_m| at_m.iter().all(|x| x.abs() <= GUIDE_MAX_M)) =>
            {
                self.guide_m = guide_m;
                true
            }
            // A force that is mostly weight and bias must never reach a hand.
            Command::Engage if !self.force.source.is_usable() => false,
            // A fault is not released while its cause lives.
            Command::ReleaseStop if self.is_silent(t_s) => false,
            Command::Engage | Command::Stop | Command::ReleaseStop => match self.state.after(command) {
                Some(next) => {
                    self.go(next, t_s);
                    true
                }
                None => false,
            },
            Command::Shutdown => true,
            _ => false,
        };
        if !done {
            self.tell(Event::CommandRefused { t_s, command });
        }
    }

    fn fail(&mut self, fault: Fault, t_s: f64) {
        // The first fault is kept; a stop stays a stop.
        if matches!(self.state, LoopState::Idle | LoopState::Engaged) {
            self.tell(Event::FaultRaised { t_s, fault });
            self.go(LoopState::Faulted(fault), t_s);
        }
    }

    /// One tick: measurements in, commands out, everything about it in the [`Tick`].
    pub fn step(&mut self, inputs: Option<Inputs>, timing: &Timing) -> (Outputs, Tick) {
        let now_s = timing.now_s;
        self.missed += timing.missed_now;
        self.watch(inputs.as_ref(), timing);
        let seen = match inputs.filter(Inputs::is_finite) {
            Some(inputs) => {
                self.measure_speed(&inputs, now_s);
                self.force = self.force_path.step(now_s, &inputs.sensed);
                self.identifier.step(&Sample { t_s: now_s, position_m: inputs.tip_m, force_n: self.force.tip_n });
                self.link.send(self.identifier.parcel());
                self.last_inputs = Some(inputs);
                self.last_input_s = now_s;
                if self.state == LoopState::Engaged && !self.force.source.is_usable() {
                    self.fail(Fault::ForceUnknown, now_s);
                }
                inputs
            }
            // Nothing new: the link keeps delivering what is on its way, ever older; the age gate takes the force away.
            None => self.last_inputs.unwrap_or(NOTHING_YET),
        };
        let tip_command_m = self.follow(&seen);
        let motion_m = self.motion_at_leader(&seen, tip_command_m);
        let parcel = self.link.receive(now_s);
        let rendered = self.renderer.step(&motion_m, parcel);
        let delayed_n = parcel.map_or_else(Vector3::zeros, |parcel| parcel.force_n);
        let age_s = parcel.map_or(f64::INFINITY, |parcel| now_s - parcel.t_s - self.delay_s);
        let (hand_force_n, gates) = self.chain.step(&Request {
            force_n: rendered.force(self.mode),
            age_s,
            speed_m_s: self.hand_speed_m_s,
            hand_m: inputs.map(|inputs| inputs.leader_m),
            permitted: self.state == LoopState::Engaged && self.force.source.is_usable(),
        });
        if inputs.is_some() {
            self.accuracy.add(&rendered, &self.force.tip_n);
        }
        let outputs = Outputs { tip_command_m, hand_force_n, prompt: self.prompt, guide_m: self.guide_m };
        let tick = self.tick(&seen, &rendered, delayed_n, hand_force_n, gates, timing);
        self.ticks += 1;
        (outputs, tick)
    }

    fn is_silent(&self, now_s: f64) -> bool {
        now_s - self.last_input_s > SILENT_AFTER_S
    }

    fn watch(&mut self, inputs: Option<&Inputs>, timing: &Timing) {
        let silent = !inputs.is_some_and(Inputs::is_finite);
        if silent && self.is_silent(timing.now_s) {
            self.fail(Fault::SourceSilent, timing.now_s);
        }
        if timing.missed_now as f64 / self.rate_hz > STALLED_AFTER_S {
            self.fail(Fault::LoopStalled { periods: timing.missed_now }, timing.now_s);
        }
    }

    /// Hand speed for the dead band, from differences: it rises within 5 ms, so one step of the encoder does not open the gate,
    /// and falls within 40 ms, so a trembling hand does not switch its force on and off twenty times a second.
    fn measure_speed(&mut self, inputs: &Inputs, now_s: f64) {
        const RISE_S: f64 = 0.005;
        const FALL_S: f64 = 0.040;
        if let Some(last) = self.last_inputs {
            let dt_s = (now_s - self.last_input_s).max(0.5 / self.rate_hz);
            let speed = (inputs.leader_m - last.leader_m).norm() / dt_s;
            let smoothing_s = if speed > self.hand_speed_m_s { RISE_S } else { FALL_S };
            self.hand_speed_m_s += (speed - self.hand_speed_m_s) * (dt_s / (smoothing_s + dt_s));
        }
    }

    /// The follower goes to the leader, never faster than its speed limit; only while engaged.
    fn follow(&mut self, seen: &Inputs) -> Option<Vector3<f64>> {
        if self.state != LoopState::Engaged || self.last_inputs.is_none() {
            return None;
        }
        let from = self.command_m.unwrap_or(seen.tip_m);
        let way = seen.leader_m - from;
        let share = if way.norm() > self.follower_step_max_m { self.follower_step_max_m / way.norm() } else { 1.0 };
        self.command_m = Some(from + way * share);
        self.command_m
    }

    /// The follower's motion now as the leader can know it: its command, as late as the follower is observed to be.
    fn motion_at_leader(&mut self, seen: &Inputs, tip_command_m: Option<Vector3<f64>>) -> Vector3<f64> {
        if let Some(command_m) = tip_command_m {
            return self.tracking.step(&command_m, &seen.tip_m);
        }
        self.tracking.interrupt();
        seen.tip_m
    }

    fn tick(
        &self,
        seen: &Inputs,
        rendered: &Rendered,
        delayed_n: Vector3<f64>,
        rendered_n: Vector3<f64>,
        gates: crate::safety::GateReport,
        timing: &Timing,
    ) -> Tick {
        Tick {
            index: self.ticks,
            t_s: timing.now_s,
            state: self.state,
            mode: self.mode,
            delay_s: self.delay_s,
            leader_m: seen.leader_m,
            tip_m: seen.tip_m,
            measured_n: self.force.tip_n,
            force: self.force,
            wrist: match seen.sensed {
                Sensed::AtTip(_) => None,
                Sensed::AtWrist(sample) => Some(sample),
            },
            prompt: self.prompt,
            guide_m: self.guide_m,
            delayed_n,
            asked_n: Mode::ALL.map(|mode| rendered.force(mode).unwrap_or_else(Vector3::zeros)),
            rendered_n,
            gates,
            gate_settings: *self.chain.settings(),
            identification: *self.identifier.report(),
            wake_s: timing.wake_s,
            work_s: timing.work_s,
            missed: self.missed,
            dropped: 0,
        }
    }
}

/// Shown until the rig has delivered its first sample.
const NOTHING_YET: Inputs = Inputs {
    leader_m: Vector3::new(0.0, 0.0, 0.0),
    tip_m: Vector3::new(0.0, 0.0, 0.0),
    sensed: Sensed::AtTip(Vector3::new(0.0, 0.0, 0.0)),
};

/// Until the first sample: an absent force is no usable force, and a rig that measures at the tip shows so at once.
const NO_FORCE_YET: ForceReport = ForceReport::none(ForceSource::AtTip, None);
