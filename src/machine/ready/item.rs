//! What every point of the list is.

use std::fmt::Debug;

use super::{Ask, Cause, Figure};
use crate::{
    messages::{Command, Refusal, Tick},
    rig::{Gauges, Healths},
};

/// How a point stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Progress {
    /// It goes on, and needs this.
    Asking(Ask),
    Passed(Figure),
    Failed(Cause),
}

/// Time that a person has for what is asked, s.
const PATIENCE_S: f64 = 30.0;

/// One point of the list while it is looked at. Times are those that the session is given, s.
pub(super) trait Item: Debug + Send {
    fn tick(&mut self, _tick: &Tick) {}
    fn gauges(&mut self, _gauges: &Gauges) {}
    fn healths(&mut self, _healths: &Healths) {}
    /// A command that it sent was refused.
    fn refused(&mut self, _why: Refusal) {}
    /// How it stands at this time.
    fn look(&mut self, now_s: f64) -> Progress;
    /// Why it has failed when its time is over.
    fn late(&self) -> Cause;
    /// Time that it has, s.
    fn patience_s(&self) -> f64 {
        PATIENCE_S
    }
    /// A command to be sent, once.
    fn command(&mut self) -> Option<Command> {
        None
    }
    /// Whether it has to do with stops and faults; for every other one they are released first.
    fn expects_latch(&self) -> bool {
        false
    }
}
