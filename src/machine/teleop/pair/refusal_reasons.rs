//! Objections to an engagement or a release, reported to the requester.

use nima_core::safety::InterlockInput;

use super::Pair;
use crate::{
    messages::{Fault, LoopState, Refusal},
    rig::{EngageBlocker, Inputs, ViewOrientation},
    teleop::Link,
};

impl<L: Link> Pair<L> {
    /// Returns the current objection to engaging; the interlock checks the state.
    pub(super) fn may_engage(&self) -> Result<(), Refusal> {
        // Neither idle nor after a short stall: the interlock itself refuses, with the state as its reason.
        if self.state() != LoopState::Idle && !self.has_short_stall() {
            return Ok(());
        }
        if self.checked == Some(false) {
            return Err(Refusal::NotChecked);
        }
        // A force that consists mostly of weight and bias must never be rendered.
        if !self.may_know_force() {
            return Err(Refusal::ForceUnknown(self.follower.force.source));
        }
        if let Some(what) = self.plausibility.doubt() {
            return Err(Refusal::Implausible(what));
        }
        // A stop at the other machine would end the engagement in its first tick.
        if let Some(fault) = self.far_fault() {
            return Err(Refusal::StillPresent(fault));
        }
        match self.samples.last.and_then(|seen| seen.obstacle) {
            Some(obstacle) => Err(Refusal::Obstacle(obstacle)),
            None => Ok(()),
        }
    }

    /// Returns whether the only fault is a stall that was so short that a person may engage directly.
    pub(super) fn has_short_stall(&self) -> bool {
        matches!(self.state(), LoopState::Faulted(fault) if fault.is_short_stall(self.settings.rate_hz))
    }

    /// Returns the local fault that follows from the other machine's stop.
    pub(super) fn far_fault(&self) -> Option<Fault> {
        self.link.far_stop().map(|stop| Fault::FarEnd { stop })
    }

    /// Returns whether an engagement would be refused now because a device has not reported yet.
    pub(in crate::teleop) fn is_waiting(&self) -> bool {
        matches!(self.samples.last.and_then(|seen| seen.obstacle), Some(EngageBlocker::Waiting(_)))
    }

    /// Refuses the release of a stop or a fault while a cause of a fault is present.
    pub(super) fn may_release(&self, t_s: f64) -> Result<(), Refusal> {
        // Nothing to release is not an error: the command goes to both arms.
        if !self.state().is_latched() {
            return Ok(());
        }
        // A fault that is still present would return at once, so the release is refused with its name.
        if self.samples.are_silent(t_s) {
            return Err(Refusal::StillPresent(Fault::SourceSilent));
        }
        self.plausibility.doubt().map_or(Ok(()), |what| Err(Refusal::StillPresent(Fault::Implausible { what })))
    }

    /// Returns the condition for which an engagement in progress is waiting.
    pub(super) fn waits_for(&self, seen: InterlockInput, inputs: Option<&Inputs>) -> Refusal {
        // Same order as the checks in `step_interlock`, so that the first unmet condition is reported.
        if !seen.powered {
            Refusal::DrivesOff
        } else if inputs.is_none_or(|inputs| inputs.view == ViewOrientation::Unseen) {
            Refusal::EndoscopeUnseen
        } else if !self.follower.force.source.is_usable() {
            Refusal::ForceUnknown(self.follower.force.source)
        } else if self.link.is_old() {
            Refusal::StillPresent(Fault::LinkSilent)
        } else if !seen.present {
            Refusal::HandAbsent
        } else if seen.clutch {
            Refusal::ClutchPressed
        } else {
            Refusal::Moving
        }
    }
}
