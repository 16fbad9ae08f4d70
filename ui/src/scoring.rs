//! The score of a run in a scene with a task. An extra implements it.

use std::fmt::Debug;

use nima_machine::messages::Tick;

/// Scores a run from its ticks.
pub trait RunScorer: Debug {
    fn tick(&mut self, tick: &Tick);

    /// Returns the score for JSON output; `None` if no arm was engaged.
    fn end(self: Box<Self>) -> Option<serde_json::Value>;
}
