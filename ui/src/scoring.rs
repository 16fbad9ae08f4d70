//! The score of a run in a scene with a task. What counts is an extra.

use std::fmt::Debug;

use nima_machine::messages::Tick;

/// Scores a run.
pub(crate) trait Scorer: Debug {
    /// Takes the next tick of a side.
    fn tick(&mut self, tick: &Tick);

    /// The score as it is printed, if anything was engaged.
    fn end(self: Box<Self>) -> Option<serde_json::Value>;
}
