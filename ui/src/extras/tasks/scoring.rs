//! The score of a run in a scene with a task.

use nima_machine::messages::Tick;
use nima_score::{Score, TaskFile, trial_score::LiveTrial};
use nima_simulation::ObjectFeed;

use crate::scoring::RunScorer;

/// Scores from the first tick in which an arm is engaged.
#[derive(Debug)]
pub(crate) struct LiveScorer {
    pub(in crate::extras) trial: LiveTrial,
    watched: Option<ObjectFeed>,
}

impl LiveScorer {
    /// `watched` reports the events of the objects.
    pub(crate) fn new(task: &TaskFile, watched: Option<ObjectFeed>) -> Self {
        Self { trial: LiveTrial::new(task), watched }
    }

    pub(crate) fn tick(&mut self, tick: &Tick) {
        self.receive();
        self.trial.tick(tick);
    }

    fn receive(&mut self) {
        let Some(watched) = &self.watched else { return };
        for moment in watched.moments() {
            self.trial.opening(moment.t_s, moment.opening_rad);
        }
        for happening in watched.happenings() {
            self.trial.happening(&happening);
        }
    }

    /// `None` if no arm was engaged.
    pub(crate) fn end(mut self) -> Option<Score> {
        self.receive();
        // If the scene has no objects, the end of the task is not reported.
        self.trial.end(self.watched.is_none())
    }
}

impl RunScorer for LiveScorer {
    fn tick(&mut self, tick: &Tick) {
        self.tick(tick);
    }

    fn end(self: Box<Self>) -> Option<serde_json::Value> {
        serde_json::to_value((*self).end()?).ok()
    }
}
