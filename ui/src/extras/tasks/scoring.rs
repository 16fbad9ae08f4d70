//! The score of a run in a scene with a task.

use nima_machine::messages::Tick;
use nima_score::{Score, TaskFile, scored::LiveTrial};
use nima_simulation::Watched;

use crate::scoring::Scorer;

/// Scores from the first tick in which an arm is engaged.
#[derive(Debug)]
pub(crate) struct Scoring {
    pub(in crate::extras) trial: LiveTrial,
    watched: Option<Watched>,
}

impl Scoring {
    /// For this task; `watched` tells what happens to the objects.
    pub(crate) fn new(task: &TaskFile, watched: Option<Watched>) -> Self {
        Self { trial: LiveTrial::new(task), watched }
    }

    /// Takes the next tick of a side.
    pub(crate) fn tick(&mut self, tick: &Tick) {
        self.hear();
        self.trial.tick(tick);
    }

    fn hear(&mut self) {
        let Some(watched) = &self.watched else { return };
        for moment in watched.moments() {
            self.trial.opening(moment.t_s, moment.opening_rad);
        }
        for happening in watched.happenings() {
            self.trial.happening(&happening);
        }
    }

    /// The score, if anything was engaged.
    pub(crate) fn end(mut self) -> Option<Score> {
        self.hear();
        // Without objects nobody tells when the task is done.
        self.trial.end(self.watched.is_none())
    }
}

impl Scorer for Scoring {
    fn tick(&mut self, tick: &Tick) {
        self.tick(tick);
    }

    fn end(self: Box<Self>) -> Option<serde_json::Value> {
        serde_json::to_value((*self).end()?).ok()
    }
}
