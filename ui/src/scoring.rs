//! The score of a run in a scene with a task.

use nima_machine::messages::{LoopState, Tick};
use nima_score::{Event, HandSample, Happening, Sample, Score, Scorer, TaskFile, TaskKind};
use nima_session::scored::side_of;
use nima_world::Watched;

/// Scores from the first tick in which an arm is engaged.
pub(crate) struct Scoring {
    scorer: Scorer,
    watched: Option<Watched>,
    /// The tick of both hands that is not yet complete.
    sample: Sample,
    newest_s: Option<f64>,
    begun_s: Option<f64>,
    ended: bool,
    limit_s: f64,
    /// Only the instruments of a peg transfer have jaws.
    has_jaws: bool,
    opening_rad: [Option<f64>; 2],
}

impl Scoring {
    /// For this task; `watched` tells what happens to the objects.
    pub(crate) fn new(task: &TaskFile, watched: Option<Watched>) -> Self {
        Self {
            scorer: Scorer::new(task),
            watched,
            sample: Sample::default(),
            newest_s: None,
            begun_s: None,
            ended: false,
            limit_s: task.time_limit_s,
            has_jaws: task.kind == TaskKind::PegTransfer,
            opening_rad: [None; 2],
        }
    }

    /// Takes the next tick of a side.
    pub(crate) fn tick(&mut self, tick: &Tick) {
        let engaged = tick.state == LoopState::Engaged;
        if self.begun_s.is_none() && engaged {
            self.begun_s = Some(tick.t_s);
            self.scorer.happening(&Happening { t_s: tick.t_s, event: Event::Begun });
        }
        if self.begun_s.is_none() {
            return;
        }
        if self.newest_s.is_some_and(|newest_s| tick.t_s > newest_s) {
            self.pass_on();
        }
        self.newest_s = Some(tick.t_s);
        self.sample.t_s = tick.t_s;
        self.sample.hands[side_of(tick.side).index()] = Some(HandSample {
            tip_m: tick.tip_m,
            jaw_rad: self.opening_rad[tick.side.index()],
            force_n: tick.measured_n,
            rendered_n: tick.rendered_n,
            engaged,
            in_view: true,
        });
    }

    /// Whether the task is done, or its time is over: what follows does not count.
    pub(crate) fn is_over(&self) -> bool {
        let lasts_s = self.begun_s.zip(self.newest_s).map_or(0.0, |(begun_s, newest_s)| newest_s - begun_s);
        self.ended || lasts_s > self.limit_s
    }

    fn pass_on(&mut self) {
        let sample = std::mem::take(&mut self.sample);
        if let Some(watched) = &self.watched {
            if let Some(moment) = watched.newest().filter(|_| self.has_jaws) {
                self.opening_rad = moment.opening_rad.map(Some);
            }
            for happening in watched.happenings() {
                self.ended |= happening.event == Event::Ended;
                self.scorer.happening(&happening);
            }
        }
        self.scorer.sample(&sample);
    }

    /// The score, if anything was engaged.
    pub(crate) fn end(mut self) -> Option<Score> {
        self.newest_s?;
        self.pass_on();
        Some(self.scorer.finish())
    }
}
