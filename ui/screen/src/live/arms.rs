//! Facts about each arm.

use nima_core::safety::Gate;
use nima_machine::{messages::LoopState, rig::Side};

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

    /// Returns whether the force ceiling acts on this hand.
    pub fn is_limited(&self, side: Side) -> bool {
        let is_engaged = self.tick_of(side).is_some_and(|tick| tick.state == LoopState::Engaged);
        is_engaged && self.gates[side.index()].closed(Gate::Ceiling)
    }

    /// Returns the stiffness of the stiffer current or last contact of both hands, N/m: the gain is common to both.
    pub fn stiffness_n_m(&self) -> Option<f64> {
        self.stiffness.iter().filter_map(ContactStiffness::n_m).max_by(f64::total_cmp)
    }
}
