//! One arm pair: handle, arm, force sensor, and the loop between them.

mod commands;
mod even;
mod far;
mod objections;
mod told;
mod watch;
mod watchdog_test;

use nalgebra::{UnitQuaternion, Vector1, Vector3};
use nima_core::{
    impedance::{
        Baseline, Identifier, Mode, OwnMotion, Rendered, Renderer, Sample, Settings as IdentifierSettings,
        SettingsError,
    },
    kinematics::{HandEye, Target},
    safety::{Chain, Gate, GripperChain, Interlock, Plausibility, Reason, Request},
    signal::Speed,
};
use nima_devices::Standing;

use self::{
    even::{Between, deadlines, stacked},
    far::Far,
    told::{NO_FORCE, NOWHERE},
};
use super::{Accuracy, Calibrations, ForcePath, Link, ProgrammedLink, Tracking};
use crate::{
    config::{RigConfig, Teleoperation},
    messages::{Event, Fault, ForceReport, LoopState, Tick, UNKNOWN_N, Watchdog},
    rig::{Acts, DeviceEvent, Inputs, Outputs, Prompt, Side},
};

/// No sample from the rig for longer than this, s, is a fault.
const SILENT_AFTER_S: f64 = 0.020;
/// No new parcel from the link for longer than this beyond its delay, s, is a fault. The age gate has removed the force
/// long before.
const LINK_SILENT_AFTER_S: f64 = 0.1;
/// Consecutive missed periods that make a fault while drives are on, as time, s.
const STALLED_AFTER_S: f64 = 0.050;
/// Most events of one tick; no more are possible.
pub const EVENTS_PER_TICK_MAX: usize = 6;
/// Distance from the gripper's hinge to the finger, m (omega.7).
const GRIPPER_ARM_M: f64 = 0.048;
/// Duration of the force ramp after each engagement, s.
const RAMP_S: f64 = 0.2;
/// A tip that moved more than this within a tick is not at rest, and the pair is not engaged, m.
const AT_REST_M: f64 = 0.2e-3;

/// Times measured by the caller: the pair never reads a clock.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Timing {
    /// Loop time of this tick, s.
    pub now_s: f64,
    /// How late the tick woke after its deadline, s.
    pub wake_s: f64,
    /// Duration of the work of the previous tick, s.
    pub work_s: f64,
    /// Time from the arrival of the oldest measurement of the previous tick until its force was given to the device, s;
    /// `None` without a measurement.
    pub sample_to_force_s: Option<f64>,
    /// Periods missed just before this tick.
    pub missed_now: u64,
}

/// The state of an arm pair.
#[derive(Clone, Debug)]
pub struct Pair<L: Link = ProgrammedLink> {
    side: Side,
    interlock: Interlock<Fault>,
    teleoperation: Teleoperation,
    hand_eye: HandEye,
    engaged_s: f64,
    mode: Mode,
    /// The mode that is rendered until the new one has something to render.
    before: Option<Mode>,
    compares: bool,
    delay_s: f64,
    rate_hz: f64,
    /// Settings of the identification; the conversion of a delay to ticks is defined there only.
    settings: IdentifierSettings,
    follower_step_max_m: f64,
    identifier: Identifier,
    renderer: Renderer,
    force_path: ForcePath,
    force: ForceReport,
    prompt: Prompt,
    guide_m: Option<Vector3<f64>>,
    grip_rad: Option<f64>,
    /// What the screen did in a training task.
    acts: Acts,
    /// Whether the simulated hand has let go of the handle; `None` where the handle is a device, which a person may hold.
    lets_go: Option<bool>,
    link: L,
    /// What the machine at the other end of a network tells.
    far: Box<Far>,
    tracking: Tracking,
    /// Tip (m) and its force (N), handle mapped to the tip and command (m): of the last tick, for even spacing.
    measured: Between<6>,
    led: Between<9>,
    /// What was rendered at the newest deadline.
    rendered: Rendered,
    plausibility: Plausibility,
    chain: Chain,
    /// The governor found that nobody holds the handle: as good as a hand that is told absent.
    hand_is_gone: bool,
    gripper_chain: GripperChain,
    last_inputs: Option<Inputs>,
    last_input_s: f64,
    last_now_s: Option<f64>,
    /// Share of samples missing lately, and whether the last one was present.
    gaps: f64,
    was_there: bool,
    /// Age, beyond its delay, of what the link within this process delivers, s.
    link_age_s: f64,
    hand_force_n: Vector3<f64>,
    command_m: Option<Vector3<f64>>,
    speed: Speed<3>,
    hand_speed_m_s: f64,
    accuracy: Accuracy,
    ticks: u64,
    missed: u64,
    /// Whether a ready check has passed; `None` where none is required.
    checked: Option<bool>,
    /// How often a stop was released.
    releases: u8,
    /// A watchdog is being fired on purpose.
    watchdog_test: Option<watchdog_test::WatchdogTest>,
    events: [Option<Event>; EVENTS_PER_TICK_MAX],
}

impl Pair {
    /// The pair of this side, idle, with leader and follower in this process. All memory is allocated here.
    ///
    /// # Errors
    /// [`SettingsError`] if the settings of the identification are invalid.
    pub fn new(rig: &RigConfig, side: Side, calibrations: &Calibrations) -> Result<Self, SettingsError> {
        Self::over(rig, side, calibrations, ProgrammedLink::new(rig.rate_hz, rig.delay_s))
    }
}

impl<L: Link> Pair<L> {
    /// The same with this link.
    ///
    /// # Errors
    /// As [`Pair::new`].
    pub fn over(rig: &RigConfig, side: Side, calibrations: &Calibrations, link: L) -> Result<Self, SettingsError> {
        let settings = rig.settings();
        let at_rest = Target { tip_m: Vector3::zeros(), world_from_jaws: UnitQuaternion::identity() };
        let mut this = Self {
            side,
            interlock: Interlock::default(),
            teleoperation: rig.teleoperation,
            hand_eye: HandEye::new(rig.teleoperation.mapping(), at_rest),
            engaged_s: 0.0,
            mode: rig.mode,
            before: None,
            compares: rig.identification.compare,
            delay_s: rig.delay_s,
            rate_hz: rig.rate_hz,
            follower_step_max_m: rig.follower_speed_max_m_s / rig.rate_hz,
            identifier: Identifier::new(&settings)?,
            renderer: Renderer::new(&settings)?,
            settings,
            force_path: ForcePath::new(calibrations, 1.0 / rig.rate_hz),
            force: NO_FORCE,
            prompt: Prompt::Rest,
            guide_m: None,
            grip_rad: None,
            acts: Acts::NONE,
            lets_go: rig.has_simulated_hand().then_some(false),
            link,
            far: Far::none(),
            tracking: Tracking::new(rig.rate_hz),
            measured: Between::default(),
            led: Between::default(),
            rendered: Rendered::default(),
            plausibility: Plausibility::default(),
            chain: Chain::new(rig.gates, 1.0 / rig.rate_hz),
            hand_is_gone: false,
            gripper_chain: GripperChain::new(rig.gates.without_governor(), 1.0 / rig.rate_hz),
            last_inputs: None,
            last_input_s: 0.0,
            last_now_s: None,
            gaps: 0.0,
            was_there: false,
            link_age_s: 0.0,
            hand_force_n: Vector3::zeros(),
            command_m: None,
            speed: Speed::new(rig.gates.handle_step_m, rig.rate_hz),
            hand_speed_m_s: 0.0,
            accuracy: Accuracy::default(),
            ticks: 0,
            missed: 0,
            checked: rig.requires_check().then_some(false),
            releases: 0,
            watchdog_test: None,
            events: [None; EVENTS_PER_TICK_MAX],
        };
        this.set_delay(rig.delay_s);
        this.compute();
        Ok(this)
    }

    /// Its side.
    pub const fn side(&self) -> Side {
        self.side
    }

    pub(super) const fn force_path(&self) -> &ForcePath {
        &self.force_path
    }

    /// The force at the tip could be rendered in the last tick. Before the first sample nothing is known against it: an engagement
    /// waits for that sample.
    pub(super) const fn may_know_force(&self) -> bool {
        self.force.source.is_usable() || self.last_inputs.is_none()
    }

    /// Ticks per second.
    pub(super) const fn rate_hz(&self) -> f64 {
        self.rate_hz
    }

    /// The baseline that is computed beside the program's own modes, if the rig starts with one.
    pub const fn baseline(&self) -> Option<Baseline> {
        self.settings.modes.baseline()
    }

    /// Present state.
    pub const fn state(&self) -> LoopState {
        self.interlock.state()
    }

    /// The follower's end of the identification.
    pub const fn identifier(&self) -> &Identifier {
        &self.identifier
    }

    /// Errors per mode since construction.
    pub const fn accuracy(&self) -> &Accuracy {
        &self.accuracy
    }

    /// Periods missed since construction.
    pub const fn missed(&self) -> u64 {
        self.missed
    }

    /// Events since [`Pair::clear_events`], oldest first.
    pub fn events(&self) -> impl Iterator<Item = &Event> {
        self.events.iter().flatten()
    }

    /// Removes all events; call before the commands of the next tick are handled.
    pub fn clear_events(&mut self) {
        self.events = [None; EVENTS_PER_TICK_MAX];
    }

    fn tell(&mut self, event: Event) {
        if let Some(free) = self.events.iter_mut().find(|slot| slot.is_none()) {
            *free = Some(event);
        }
    }

    /// The wrist sensor was connected, lost or exchanged.
    pub(super) const fn suspend_calibrations(&mut self) {
        self.force_path.suspend();
    }

    /// Exchanges the force path with `path`; refused while drives are on.
    pub(super) fn exchange_force_path(&mut self, path: &mut ForcePath) -> bool {
        let rests = !self.state().permits().drives;
        if rests {
            std::mem::swap(&mut self.force_path, path);
            self.plausibility.force_is_new();
        }
        rests
    }

    /// Handles the connection or loss of a device of this pair.
    pub(super) fn notice(&mut self, event: &DeviceEvent) {
        if let Standing::Lost(loss) = event.standing {
            self.fail_if_driven(Fault::DeviceLost { device: event.device, loss }, event.t_s);
        }
    }

    /// Whether it has a fault of its own, which takes the other pair out of engagement in the next tick.
    pub fn has_failed(&self) -> bool {
        matches!(self.state(), LoopState::Faulted(fault) if fault != Fault::OtherArm)
    }

    /// Executes one tick: measurements in, commands out, and everything to display or record in the [`Tick`]. That the other pair had
    /// failed after the tick before is all that a pair gets from it.
    pub fn step(&mut self, other_has_failed: bool, inputs: Option<Inputs>, timing: &Timing) -> (Outputs, Tick) {
        let now_s = timing.now_s;
        if other_has_failed {
            self.fail_if_driven(Fault::OtherArm, now_s);
        }
        self.missed += timing.missed_now;
        self.check_clock(timing);
        self.end_late_test(now_s);
        let inputs = inputs.filter(|inputs| inputs.is_finite() && !self.withholds(Watchdog::Source));
        let moved_m = inputs.zip(self.last_inputs).map_or(0.0, |(now, last)| (now.tip_m - last.tip_m).norm());
        let inputs = inputs.map(|inputs| self.take_in(inputs, timing));
        if inputs.is_none() && !self.far.is_there {
            // The identification needs evenly spaced samples: it interpolates a missing one, and no parcel is sent for
            // it.
            for t_s in deadlines(timing, 1.0 / self.rate_hz) {
                self.identifier.step(&Sample { t_s, position_m: NOWHERE, force_n: NOWHERE });
            }
            self.measured.forget();
        }
        self.watch(inputs.as_ref(), moved_m, timing);
        // After the fault of the silence, which is the cause.
        if self.is_silent(now_s) {
            self.force = NO_FORCE;
        }
        // No new sample: the link keeps delivering what is under way, which grows older, and the age gate removes the
        // force.
        let seen = self.last_inputs.unwrap_or(Inputs::NOTHING);
        let target = self.hand_eye.step(&seen.hand);
        let tip_command_m = self.follow(&seen, &target);
        let rendered = self.render(&seen, &target.tip_m, tip_command_m, timing);
        let far = Some(&self.far.parcel).filter(|_| self.force.source.is_usable());
        let parcel = if self.far.is_there { far } else { self.link.receive(now_s) };
        if let Some(parcel) = parcel {
            self.plausibility.delivered(&parcel.force_n, parcel.t_s);
        }
        // Until the first parcel arrives, the delay line is still filling.
        let parcel_is_there = parcel.is_some();
        let age_s = parcel.map_or(f64::INFINITY, |parcel| now_s - parcel.t_s - self.delay_s + seen.age_s);
        // Over a network a parcel may be younger than the delay says; its force still ends with the line.
        let age_s = age_s.max(seen.silent_s);
        let is_known = age_s < self.chain.settings().zero_after_s;
        let delayed_n = parcel.filter(|parcel| is_known && parcel.fresh).map_or(UNKNOWN_N, |parcel| parcel.force_n);
        let is_old = parcel_is_there && age_s > LINK_SILENT_AFTER_S;
        // Right after a silence of the devices the link within this process still delivers what is from before it: an engagement waits for
        // the first new parcel.
        self.link_age_s = if parcel_is_there && !self.far.is_there { age_s } else { 0.0 };
        if is_old && !(self.link_is_old() && self.state() == LoopState::Ready) {
            self.fail_if_driven(Fault::LinkSilent, now_s);
        }
        let permits = self.state().permits();
        let permitted = permits.coupled && self.force.source.is_usable();
        let force_n = self.in_force(&rendered);
        let ramp = ((now_s - self.engaged_s) / RAMP_S).clamp(0.0, 1.0);
        let (rendered_n, gates) = self.chain.step(&Request {
            t_s: now_s,
            force_n: force_n.map(|force_n| force_n * ramp),
            age_s,
            speed_m_s: self.hand_speed_m_s,
            // On the axes of the force. The travel of the hand itself, before scaling. A missing sample hides no
            // travel: the next one contains it.
            hand_m: self.hand_now_m(now_s),
            hand_age_s: now_s - seen.hand_s(now_s),
            permitted,
        });
        self.hand_is_gone |= gates.reason(Gate::Governor) == Reason::HandGone;
        let gripper_n = self.grip(inputs.as_ref(), now_s, age_s, permitted);
        // Over a network the force of now is not known here: the other machine judges.
        if inputs.is_some() && self.force.source.is_known() && !self.far.is_there {
            self.accuracy.add(&rendered, self.identifier.report().modes, &self.force.tip_n);
        }
        let outputs = Outputs {
            drives: permits.drives,
            tip_command_m,
            world_from_jaws: tip_command_m.and(seen.world_from_jaws).map(|_| target.world_from_jaws),
            hand_force_n: self.hand_eye.mapping().force_to_hand(&rendered_n),
            gripper_n,
            prompt: self.prompt,
            guide_m: self.guide_m,
            grip_rad: self.grip_rad,
            acts: self.acts,
            lets_go: self.lets_go.unwrap_or(false),
        };
        self.hand_force_n = outputs.hand_force_n;
        let leader_m = if tip_command_m.is_some() { target.tip_m } else { seen.tip_m };
        let tick = self.tick(&seen, leader_m, &rendered, delayed_n, rendered_n, gates, timing);
        self.ticks += 1;
        (outputs, tick)
    }

    /// Last measured position of the hand, m (`world`), if it is recent.
    fn hand_now_m(&self, now_s: f64) -> Option<Vector3<f64>> {
        let seen = self.last_inputs.filter(|_| !self.is_silent(now_s))?;
        Some(self.hand_eye.mapping().world_from_leader() * seen.hand.position_m)
    }

    /// Force on the gripper from the force on the jaws, through gates of its own.
    fn grip(&mut self, inputs: Option<&Inputs>, now_s: f64, age_s: f64, permitted: bool) -> f64 {
        let (opening_rad, grip_n) = (inputs.and_then(|i| i.gripper_rad), inputs.and_then(|i| i.grip_n));
        let (force_n, _) = self.gripper_chain.step(&Request {
            t_s: now_s,
            force_n: grip_n.map(Vector1::new),
            age_s,
            // Above the dead band: a gripper that holds something still must keep its force.
            speed_m_s: 1.0,
            hand_m: opening_rad.map(|rad| Vector1::new(rad * GRIPPER_ARM_M)),
            hand_age_s: 0.0,
            permitted: permitted && grip_n.is_some(),
        });
        force_n.x
    }

    /// The link.
    pub(super) const fn link_mut(&mut self) -> &mut L {
        &mut self.link
    }

    fn is_silent(&self, now_s: f64) -> bool {
        now_s - self.last_input_s > SILENT_AFTER_S - 0.5 / self.rate_hz
    }

    /// Command to the follower: the hand's position, limited to the follower's maximum speed; only while engaged.
    fn follow(&mut self, seen: &Inputs, target: &Target) -> Option<Vector3<f64>> {
        if !self.hand_eye.is_engaged() {
            return None;
        }
        let from = self.command_m.unwrap_or(seen.tip_m);
        let way = target.tip_m - from;
        let share = if way.norm() > self.follower_step_max_m { self.follower_step_max_m / way.norm() } else { 1.0 };
        self.command_m = Some(from + way * share);
        self.command_m
    }

    /// Renders at every deadline that has passed, from the motion at that time and the parcel that had come by then.
    fn render(
        &mut self,
        seen: &Inputs,
        handle_m: &Vector3<f64>,
        tip_command_m: Option<Vector3<f64>>,
        timing: &Timing,
    ) -> Rendered {
        let command_m = tip_command_m.unwrap_or(seen.tip_m);
        let now = (timing.now_s, stacked([&command_m, handle_m, &seen.tip_m]));
        for t_s in deadlines(timing, 1.0 / self.rate_hz) {
            let at = self.led.at(t_s, now);
            let [command_m, handle_m, tip_m] = [0, 3, 6].map(|from| at.fixed_rows::<3>(from).into_owned());
            let motion_m = if tip_command_m.is_some() {
                let follower_m = self.tracking.step(&command_m, &tip_m, self.ticks_behind(seen.silent_s));
                self.motion_at_leader(follower_m, handle_m)
            } else {
                self.tracking.interrupt();
                tip_m
            };
            let far = Some(&self.far.parcel).filter(|_| self.force.source.is_usable());
            let parcel = if self.far.is_there { far } else { self.link.receive(t_s) };
            self.rendered = self.renderer.step(&motion_m, parcel);
        }
        self.led.keep(now);
        self.rendered
    }

    /// The motion from which the force is made: the follower's as the leader can know it (the command, delayed by the
    /// observed lag), or the handle's, mapped to the tip.
    const fn motion_at_leader(&self, follower_m: Vector3<f64>, handle_m: Vector3<f64>) -> Vector3<f64> {
        match self.settings.own_motion {
            OwnMotion::Follower => follower_m,
            OwnMotion::Handle => handle_m,
        }
    }
}
