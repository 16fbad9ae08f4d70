//! Why the loop did not carry out a command.

use nima_core::safety::Implausible;

use super::{Fault, LoopState};
use crate::rig::Obstacle;

/// Why a command was refused, or an engagement given up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Refusal {
    /// Not in this state: a stop or a fault is latched, a device is missing, or it is so already.
    State(LoopState),
    /// The cause of a fault is still present.
    StillPresent(Fault),
    /// The force at the tip is not known.
    ForceUnknown,
    /// A measurement is not plausible.
    Implausible(Implausible),
    /// The arm cannot start from where it is.
    Obstacle(Obstacle),
    /// The tracker does not see the endoscope.
    EndoscopeUnseen,
    /// The drives were switched on and did not obey in time.
    DrivesOff,
    /// The arm moved until the time was up.
    Moving,
    /// Nobody held the handle until the time was up.
    HandAbsent,
    /// The clutch was pressed until the time was up.
    ClutchPressed,
    /// The value is outside its range.
    OutOfRange,
    /// The rig has no arm on this side.
    NoSuchArm,
}

impl Refusal {
    /// It only says that an arm is already as it was asked to be, which is no news where the other arm obeyed.
    pub(crate) const fn is_already_so(self) -> bool {
        matches!(self, Self::State(LoopState::Idle | LoopState::Ready | LoopState::Engaged | LoopState::Clutched))
    }
}
