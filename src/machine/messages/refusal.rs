//! Why the loop did not carry out a command.

use nima_core::safety::Implausible;

use super::{Fault, ForceSource, LoopState};
use crate::rig::Obstacle;

/// Why a command was refused, or an engagement given up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Refusal {
    /// Not possible in this state: a stop or a fault is latched, a device is missing, or the pair is already as
    /// requested.
    State(LoopState),
    /// The cause of a fault is still present.
    StillPresent(Fault),
    /// The force at the tip is not known, for this reason.
    ForceUnknown(ForceSource),
    /// A measurement is not plausible.
    Implausible(Implausible),
    /// The arm cannot be engaged from its present position.
    Obstacle(Obstacle),
    /// The tracker does not see the endoscope.
    EndoscopeUnseen,
    /// The drives did not come on in time.
    DrivesOff,
    /// The arm was still moving when the time limit was reached.
    Moving,
    /// Nobody held the handle until the time limit was reached.
    HandAbsent,
    /// The clutch stayed pressed until the time limit was reached.
    ClutchPressed,
    /// The rig file requires a ready check, and none of today has passed.
    NotChecked,
    /// The value is outside its range.
    OutOfRange,
    /// The follower is at the other end of a network, whose delay is measured and not set.
    DelayIsMeasured,
    /// A person may hold the handle: this is for simulated rigs.
    SimulatedOnly,
    /// The rig has no arm on this side.
    NoSuchArm,
}

impl Refusal {
    /// Whether it only says that an arm is already as requested. This is not reported if the other arm carried out the
    /// command.
    pub(crate) const fn is_already_so(self) -> bool {
        matches!(self, Self::State(LoopState::Idle | LoopState::Ready | LoopState::Engaged | LoopState::Clutched))
    }
}
