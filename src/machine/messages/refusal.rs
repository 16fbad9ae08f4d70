//! Reasons why the loop did not carry out a command.

use nima_core::safety::Implausible;

use super::{Fault, ForceSource, LoopState};
use crate::rig::EngageBlocker;

/// Reason why a command was refused, or an engagement abandoned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Refusal {
    /// Not possible in this state: a stop or a fault is latched, a device is missing, or the pair is already in the
    /// requested state.
    State(LoopState),
    StillPresent(Fault),
    /// The force at the tip is unknown, for this reason.
    ForceUnknown(ForceSource),
    Implausible(Implausible),
    /// The arm cannot be engaged from its current position.
    Obstacle(EngageBlocker),
    /// The tracker does not detect the endoscope.
    EndoscopeUnseen,
    DrivesOff,
    /// The arm was still moving at the time limit.
    Moving,
    /// No hand held the handle within the time limit.
    HandAbsent,
    /// The clutch was still pressed at the time limit.
    ClutchPressed,
    /// The rig file requires a ready check, and none has passed today.
    NotChecked,
    OutOfRange,
    /// The follower is at the other end of a network, where the delay is measured and cannot be set.
    DelayIsMeasured,
    /// Only possible on simulated rigs, because a person may hold the handle.
    SimulatedOnly,
    NoSuchArm,
}

impl Refusal {
    /// Returns whether the refusal only says that an arm is already in the requested state. It is not reported if the
    /// other arm carried out the command.
    pub(crate) const fn is_already_so(self) -> bool {
        matches!(self, Self::State(LoopState::Idle | LoopState::Ready | LoopState::Engaged | LoopState::Clutched))
    }
}
