//! The score of a run in a scene with a task.

use nima_machine::{
    messages::{LoopState, Tick},
    rig::Side,
};
use nima_score::{Event, HandSample, Sample, Score, TaskFile, TaskKind};
use nima_session::scored::{Trial, side_of};
use nima_world::Watched;

/// Scores from the first tick in which an arm is engaged.
#[derive(Debug)]
pub(crate) struct Scoring {
    trial: Trial,
    watched: Option<Watched>,
    /// The tick of both hands that is not yet complete.
    sample: Option<Sample>,
    begun_s: Option<f64>,
    newest_s: f64,
    ended: bool,
    limit_s: f64,
    /// Only the instruments of a peg transfer have jaws.
    has_jaws: bool,
}

impl Scoring {
    /// For this task; `watched` tells what happens to the objects.
    pub(crate) fn new(task: &TaskFile, watched: Option<Watched>) -> Self {
        Self {
            trial: Trial::new(task),
            watched,
            sample: None,
            begun_s: None,
            newest_s: 0.0,
            ended: false,
            limit_s: task.time_limit_s,
            has_jaws: task.kind == TaskKind::PegTransfer,
        }
    }

    /// Takes the next tick of a side.
    pub(crate) fn tick(&mut self, tick: &Tick) {
        if self.sample.is_some_and(|sample| tick.t_s > sample.t_s) {
            self.pass_on();
        }
        let engaged = tick.state == LoopState::Engaged;
        if engaged {
            self.begun_s.get_or_insert(tick.t_s);
        }
        self.newest_s = tick.t_s;
        let sample = self.sample.get_or_insert(Sample { t_s: tick.t_s, ..Sample::default() });
        sample.hands[side_of(tick.side).index()] = Some(HandSample {
            tip_m: tick.tip_m,
            jaw_rad: None,
            force_n: tick.measured_n,
            rendered_n: tick.rendered_n,
            engaged,
            in_view: true,
        });
    }

    /// Whether the task is done, or its time is over: what follows does not count.
    pub(crate) fn is_over(&self) -> bool {
        self.ended || self.begun_s.is_some_and(|begun_s| self.newest_s - begun_s > self.limit_s)
    }

    /// Time since the first tick in which an arm was engaged, s.
    pub(crate) fn elapsed_s(&self) -> f64 {
        self.begun_s.map_or(0.0, |begun_s| self.newest_s - begun_s)
    }

    fn pass_on(&mut self) {
        if let Some(watched) = &self.watched {
            for moment in watched.moments().filter(|_| self.has_jaws) {
                for side in Side::ALL {
                    self.trial.opening(side, moment.t_s, moment.opening_rad[side.index()]);
                }
            }
            for happening in watched.happenings() {
                self.ended |= happening.event == Event::Ended;
                self.trial.happening(&happening);
            }
        }
        if let Some(sample) = self.sample.take() {
            self.trial.sample(&sample);
        }
    }

    /// The score, if anything was engaged.
    pub(crate) fn end(mut self) -> Option<Score> {
        self.pass_on();
        // Without objects nobody tells when the task is done.
        self.trial.end(self.watched.is_none())
    }
}
