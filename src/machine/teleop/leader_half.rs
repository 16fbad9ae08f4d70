//! The leader's half of a pair: hand → command, packets and motion → rendering → gates → handle.

use nalgebra::{UnitQuaternion, Vector1, Vector3};
use nima_core::{
    impedance::{ImpedanceSettings, Mode, ModeSet, OwnMotion, RenderedForces, Renderer, SettingsError},
    kinematics::{HandEyeCoupling, TipTarget},
    safety::{ForceRequest, Gate, GateReport, GripperChain, Reason, SafetyChain},
    signal::Speed,
};

use super::{
    Link, Timing, TrackingLag,
    even::{Between, deadlines, stacked},
    far_link::PairLink,
};
use crate::{
    config::{RigConfig, Teleoperation},
    rig::Inputs,
};

/// Distance from the gripper's hinge to the finger, m (omega.7).
/// Converts the opening angle into a travel, whose product with the force is the energy.
const GRIPPER_ARM_M: f64 = 0.048;
/// Duration of the force ramp after each engagement, s: a force must not begin as a step in the hand. Design choice.
/// Shorter ramps are felt as a knock, longer ones hide the first contact.
const RAMP_S: f64 = 0.2;
/// Maximum distance between the command and the planned tip ([`PlannedTip`](crate::rig::PlannedTip)), m, where a plan is
/// known. Without it, an arm that is slowed down by its limits would be far from the position from which the force is
/// computed. Half of the distance at which the plausibility check reports an arm as lost.
const AHEAD_MAX_M: f64 = 0.01;

#[derive(Clone, Debug)]
pub(super) struct LeaderHalf {
    teleoperation: Teleoperation,
    pub(super) hand_eye: HandEyeCoupling,
    /// Maximum travel of the command in a tick, m.
    step_max_m: f64,
    pub(super) command_m: Option<Vector3<f64>>,
    pub(super) modes: Modes,
    pub(super) renderer: Renderer,
    own_motion: OwnMotion,
    pub(super) tracking: TrackingLag,
    /// Command, handle mapped to the tip, and tip (m) in the last tick, for even spacing.
    led: Between<9>,
    /// Forces rendered at the newest deadline.
    rendered: RenderedForces,
    pub(super) gates: HandGates,
    /// Force on the handle in the last tick, N, on the axes of its device.
    pub(super) hand_force_n: Vector3<f64>,
    rate_hz: f64,
}

/// Command that the hand gives to the instrument.
#[derive(Clone, Copy, Debug)]
pub(super) struct TipLead {
    pub(super) target: TipTarget,
    /// Command to the follower, m; only while engaged.
    pub(super) tip_m: Option<Vector3<f64>>,
}

impl LeaderHalf {
    pub(super) fn new(rig: &RigConfig, settings: &ImpedanceSettings) -> Result<Self, SettingsError> {
        let at_rest = TipTarget { tip_m: Vector3::zeros(), world_from_jaws: UnitQuaternion::identity() };
        Ok(Self {
            teleoperation: rig.teleoperation,
            hand_eye: HandEyeCoupling::new(rig.teleoperation.mapping(), at_rest),
            // Per tick, so that no change of the mapping or jump of the hand can exceed the arm's speed.
            step_max_m: rig.follower_speed_max_m_s / rig.rate_hz,
            command_m: None,
            modes: Modes {
                available: settings.modes,
                mode: rig.mode,
                before: None,
                compares: rig.identification.compare,
            },
            renderer: Renderer::new(settings)?,
            own_motion: settings.own_motion,
            tracking: TrackingLag::new(rig.rate_hz, rig.identification.earlier_forces),
            led: Between::default(),
            rendered: RenderedForces::default(),
            gates: HandGates::new(rig),
            hand_force_n: Vector3::zeros(),
            rate_hz: rig.rate_hz,
        })
    }

    /// Returns the command to the follower: the hand's position, limited to the follower's maximum speed and, if the arm
    /// is planned here, to a distance from the plan.
    pub(super) fn lead(&mut self, seen: &Inputs) -> TipLead {
        let target = self.hand_eye.step(&seen.hand);
        if !self.hand_eye.is_engaged() {
            return TipLead { target, tip_m: None };
        }
        // Without an earlier command the path starts at the tip, which cannot jump.
        let from_m = self.command_m.unwrap_or(seen.tip_m);
        let wanted_m = match seen.planned.0 {
            Some(planned_m) => planned_m + shortened(target.tip_m - planned_m, AHEAD_MAX_M),
            None => target.tip_m,
        };
        self.command_m = Some(from_m + shortened(wanted_m - from_m, self.step_max_m));
        TipLead { target, tip_m: self.command_m }
    }

    /// Returns the command that was active when the tip was measured, m; `None` without a current measurement.
    pub(super) fn command_behind_m(&self, behind: usize, silent_s: f64) -> Option<Vector3<f64>> {
        // One missing message is normal jitter; beyond that the command and the tip no longer belong together.
        // 1.5: half a tick of rounding beyond one missing message.
        if silent_s * self.rate_hz > 1.5 {
            return None;
        }
        match behind {
            0 => self.command_m,
            // The newest command in the history belongs to the previous tick.
            behind => self.command_m.and_then(|_| self.tracking.command_m(behind - 1)),
        }
    }

    /// Renders at every deadline that has passed, from the motion at that time and the packet that had arrived by then.
    pub(super) fn render<L: Link>(
        &mut self,
        seen: &Inputs,
        lead: &TipLead,
        link: &mut PairLink<L>,
        timing: &Timing,
    ) -> RenderedForces {
        let command_m = lead.tip_m.unwrap_or(seen.tip_m);
        let now = (timing.now_s, stacked([&command_m, &lead.target.tip_m, &seen.tip_m]));
        let behind = link.behind(seen.silent_s);
        for t_s in deadlines(timing, 1.0 / self.rate_hz) {
            let at = self.led.at(t_s, now);
            let [command_m, handle_m, tip_m] = [0, 3, 6].map(|from| at.fixed_rows::<3>(from).into_owned());
            let motion_m = if lead.tip_m.is_some() {
                let follower_m = self.tracking.step(&command_m, &tip_m, behind);
                self.motion_m(follower_m, handle_m)
            } else {
                // Without a command there is nothing to lag behind.
                self.tracking.interrupt();
                tip_m
            };
            self.rendered = self.renderer.step(&motion_m, link.receive(t_s));
        }
        self.led.keep(now);
        self.rendered
    }

    /// Returns the motion from which the force is computed: the follower's as the leader can estimate it (the command,
    /// delayed by the observed lag), or the handle's, mapped to the tip.
    const fn motion_m(&self, follower_m: Vector3<f64>, handle_m: Vector3<f64>) -> Vector3<f64> {
        match self.own_motion {
            OwnMotion::Follower => follower_m,
            OwnMotion::Handle => handle_m,
        }
    }

    /// Couples hand and tip at their current positions, so the first command is the current tip position.
    pub(super) fn engage(&mut self, seen: &Inputs, t_s: f64) {
        // Only at this point: if the endoscope turns while engaged, the mapping must not change the direction of motion
        // under the operator's hand.
        if let Some(world_from_view) = seen.view.world_from_view() {
            let mapping = self.teleoperation.seen(world_from_view, self.hand_eye.mapping().scale());
            self.hand_eye.set_mapping(mapping);
        }
        let world_from_jaws = seen.world_from_jaws.unwrap_or_else(UnitQuaternion::identity);
        self.hand_eye.engage(TipTarget { tip_m: seen.tip_m, world_from_jaws });
        self.gates.engaged_s = t_s;
    }

    /// Resets to no force and a follower at rest.
    pub(super) fn rest(&mut self) {
        self.gates.reset();
        self.command_m = None;
        self.hand_eye.release();
    }
}

/// Returns a path of at most this length, m. It keeps its direction, so that the tip moves like the hand.
fn shortened(path_m: Vector3<f64>, max_m: f64) -> Vector3<f64> {
    path_m * (max_m / path_m.norm().max(max_m))
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Modes {
    /// Modes for which memory is allocated.
    pub(super) available: ModeSet,
    pub(super) mode: Mode,
    /// The mode that is rendered until the new one has a force.
    before: Option<Mode>,
    // The mode before is computed until the new one has a force, so that the hand is never without one.
    pub(super) compares: bool,
}

impl Modes {
    pub(super) fn computed(&self) -> ModeSet {
        let chosen = ModeSet::only(self.mode);
        if self.compares { self.available } else { self.before.map_or(chosen, |before| chosen.with(before)) }
    }

    pub(super) fn choose(&mut self, mode: Mode) {
        let last = std::mem::replace(&mut self.mode, mode);
        // Selecting the current mode again must not restart it.
        if last != mode {
            // Only the mode that is left can bridge the time until the new one has learnt.
            self.before = Some(last);
        }
    }

    /// Returns the force of the selected mode; until it has one, the force of the previous mode, so that a change of
    /// mode does not interrupt the force.
    pub(super) fn force_n(&self, rendered: &RenderedForces) -> Option<Vector3<f64>> {
        // Falls back to the former mode while the new one has nothing valid yet.
        rendered.force(self.mode).or_else(|| self.before.and_then(|before| rendered.force(before)))
    }

    /// Drops the previous mode once the selected one has a force; returns whether it did.
    pub(super) fn settle(&mut self, rendered: &RenderedForces) -> bool {
        rendered.force(self.mode).and_then(|_| self.before.take()).is_some()
    }
}

#[derive(Clone, Debug)]
pub(super) struct HandGates {
    pub(super) chain: SafetyChain,
    gripper_chain: GripperChain,
    speed: Speed<3>,
    pub(super) hand_speed_m_s: f64,
    engaged_s: f64,
    /// The governor found that the handle is not held: treated like a hand that is reported absent.
    pub(super) hand_is_gone: bool,
}

impl HandGates {
    fn new(rig: &RigConfig) -> Self {
        let period_s = 1.0 / rig.rate_hz;
        Self {
            chain: SafetyChain::new(rig.gates, period_s),
            // The governor models a hand on the handle; the finger on a gripper has other limits.
            gripper_chain: GripperChain::new(rig.gates.without_governor(), period_s),
            speed: Speed::new(rig.gates.handle_step_m, rig.rate_hz),
            hand_speed_m_s: 0.0,
            engaged_s: 0.0,
            hand_is_gone: false,
        }
    }

    fn reset(&mut self) {
        self.chain.reset();
        self.gripper_chain.reset();
        self.hand_is_gone = false;
    }

    /// Measures the speed of the handle from its position, m, at this time, s.
    pub(super) fn move_hand(&mut self, read_s: f64, hand_m: Vector3<f64>) {
        self.hand_speed_m_s = self.speed.step(read_s, hand_m);
    }

    /// Returns the force on the handle, N, on the axes of the request: the requested force is ramped up after each
    /// engagement.
    pub(super) fn step(&mut self, request: ForceRequest) -> (Vector3<f64>, GateReport) {
        // Before the gates, so that the energy and the slew of the ramp are limited like every other force.
        let ramp = ((request.t_s - self.engaged_s) / RAMP_S).clamp(0.0, 1.0);
        let force_n = request.force_n.map(|force_n| force_n * ramp);
        let (rendered_n, report) = self.chain.step(&ForceRequest { force_n, ..request });
        // Latched until the pair is at rest: a handle that is caught and pushed again must not regain its force by
        // itself.
        self.hand_is_gone |= report.reason(Gate::Governor) == Reason::HandGone;
        (rendered_n, report)
    }

    /// Returns the force on the gripper from the force on the jaws, N, through separate gates.
    pub(super) fn grip(&mut self, inputs: Option<&Inputs>, now_s: f64, age_s: f64, permitted: bool) -> f64 {
        let opening_rad = inputs.and_then(|inputs| inputs.gripper_rad);
        let grip_n = inputs.and_then(|inputs| inputs.grip_n);
        let (force_n, _) = self.gripper_chain.step(&ForceRequest {
            t_s: now_s,
            force_n: grip_n.map(Vector1::new),
            age_s,
            // Faster than the dead band, so that a gripper holding an object still keeps its force.
            speed_m_s: 1.0,
            hand_m: opening_rad.map(|rad| Vector1::new(rad * GRIPPER_ARM_M)),
            hand_age_s: 0.0,
            permitted: permitted && grip_n.is_some(),
        });
        force_n.x
    }
}
