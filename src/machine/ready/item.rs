//! Interface of every check in the list.

use std::fmt::Debug;

use super::{PersonRequest, ReadyCause, ReadyFigure};
use crate::{
    messages::{Command, Refusal, Tick},
    rig::{Gauges, Healths},
};

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum PointProgress {
    /// In progress, waiting for this action.
    Asking(PersonRequest),
    Passed(ReadyFigure),
    Failed(ReadyCause),
}

/// Time for a person to do what is requested, s. Without a limit, a check that was left alone would keep the loop idle
/// for ever.
/// Half a minute: an instruction has to be read, and a person may be at the other arm.
const PATIENCE_S: f64 = 30.0;

/// A check while it runs. Times are the session's, s.
pub(super) trait Item: Debug + Send {
    fn tick(&mut self, _tick: &Tick) {}
    fn gauges(&mut self, _gauges: &Gauges) {}
    fn healths(&mut self, _healths: &Healths) {}
    /// Handles the refusal of a command that the check sent.
    fn refused(&mut self, _why: Refusal) {}
    /// Returns the progress at this time.
    fn look(&mut self, now_s: f64) -> PointProgress;
    /// Returns the reason for failure when the time is over.
    fn late(&self) -> ReadyCause;
    fn patience_s(&self) -> f64 {
        PATIENCE_S
    }
    /// Returns a command to send, once.
    fn command(&mut self) -> Option<Command> {
        None
    }
    /// Returns whether the check involves stops and faults; for every other check they are released first.
    fn expects_latch(&self) -> bool {
        false
    }
}
