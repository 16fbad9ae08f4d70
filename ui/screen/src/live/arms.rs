//! Facts about each arm.

use nalgebra::Vector3;
use nima_core::{kinematics::Joints, safety::Gate};
use nima_machine::{
    messages::{Fault, LoopState},
    rig::{RigPart, Side},
};
use nima_words::report_text::role_name;

use super::LiveState;
use crate::stiffness::ContactStiffness;

impl LiveState {
    pub fn sides(&self) -> impl Iterator<Item = Side> {
        Side::ALL.into_iter().filter(|&side| side == Side::Right || self.is_bimanual())
    }

    pub const fn is_bimanual(&self) -> bool {
        self.scene.left.is_some() || self.tick_of(Side::Left).is_some()
    }

    /// Returns the state that decides about a calibration of this arm: a device missing at the other arm does not matter.
    pub fn state_for(&self, side: Side) -> LoopState {
        let own = self.tick_of(side).map(|tick| tick.state);
        match self.state() {
            LoopState::Disconnected => own.unwrap_or(LoopState::Disconnected),
            state => state,
        }
    }

    /// Returns the mean magnitude of the rendered force, N; `None` before the first tick of this side.
    pub fn rendered_n(&self, side: Side) -> Option<f64> {
        self.tick_of(side).map(|_| self.figures.rendered_n[side.index()])
    }

    /// Returns the name of the lost device that caused the first fault; `None` for other faults.
    pub(super) fn fault_device(&self) -> Option<String> {
        let Some((_, Fault::DeviceLost { device, .. })) = self.first_fault else { return None };
        self.roster.get(usize::from(device)).map(|entry| role_name(entry.role))
    }

    /// Returns whether the force ceiling acts on this hand.
    pub fn is_limited(&self, side: Side) -> bool {
        let is_engaged = self.tick_of(side).is_some_and(|tick| tick.state == LoopState::Engaged);
        is_engaged && self.gates[side.index()].closed(Gate::Ceiling)
    }

    /// Returns the stiffness of the stiffer current or last contact of both hands, N/m: the gain is common to both.
    pub fn stiffness_n_m(&self) -> Option<f64> {
        self.stiffness.iter().filter_map(ContactStiffness::n_m).max_by(f64::total_cmp)
    }

    /// Returns base, joints, flange and sensor of a robot arm, m (`world`), from its joint angles of the last tenth of a
    /// second; empty while they are unknown.
    pub fn links_m(&self, side: Side) -> Vec<Vector3<f32>> {
        self.measured_links_m(side).unwrap_or_default()
    }

    fn measured_links_m(&self, side: Side) -> Option<Vec<Vector3<f32>>> {
        let arm = self.rig.devices.as_ref()?.arm(side)?.kinematics().ok()?;
        let place = self.roster.iter().position(|entry| entry.part == Some(RigPart::Arm(side)))?;
        let joints = arm.model().joints();
        let angles = &self.blocks.back()?.devices.get(place)?.channels[..joints];
        if angles.iter().any(|angle| angle.count == 0) {
            return None;
        }
        let pose = arm.pose(&Joints::from_fn(|joint, _| angles.get(joint).map_or(0.0, |angle| angle.mean)));
        let joints_m = &pose.chain.origin_m[..joints];
        let ends = [pose.chain.world_from_flange, pose.world_from_s1].map(|end| end.translation.vector);
        let base_m = arm.world_from_base().translation.vector;
        Some(std::iter::once(&base_m).chain(joints_m).chain(&ends).map(|at_m| at_m.cast()).collect())
    }
}
