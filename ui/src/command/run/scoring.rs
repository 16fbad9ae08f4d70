//! The score of a run in a scene with a task.

use nima_machine::messages::{LoopState, Tick};
use nima_score::{Event, HandSample, Happening, Sample, Score, Scorer, TaskFile, TaskKind};
use nima_session::scored::side_of;
use nima_world::Watched;

/// Scores from the first tick in which an arm is engaged.
pub(super) struct Scoring {
    scorer: Scorer,
    watched: Option<Watched>,
    /// The tick of both hands that is not yet complete.
    sample: Sample,
    newest_s: Option<f64>,
    begun: bool,
    /// Only the instruments of a peg transfer have jaws.
    has_jaws: bool,
    opening_rad: [Option<f64>; 2],
}

impl Scoring {
    /// For this task; `watched` tells what happens to the objects.
    pub(super) fn new(task: &TaskFile, watched: Option<Watched>) -> Self {
        Self {
            scorer: Scorer::new(task),
            watched,
            sample: Sample::default(),
            newest_s: None,
            begun: false,
            has_jaws: task.kind == TaskKind::PegTransfer,
            opening_rad: [None; 2],
        }
    }

    /// Takes the next tick of a side.
    pub(super) fn tick(&mut self, tick: &Tick) {
        let engaged = tick.state == LoopState::Engaged;
        if !self.begun && engaged {
            self.begun = true;
            self.scorer.happening(&Happening { t_s: tick.t_s, event: Event::Begun });
        }
        if !self.begun {
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

    fn pass_on(&mut self) {
        let sample = std::mem::take(&mut self.sample);
        if let Some(watched) = &self.watched {
            if let Some(moment) = watched.newest().filter(|_| self.has_jaws) {
                self.opening_rad = moment.opening_rad.map(Some);
            }
            for happening in watched.happenings() {
                self.scorer.happening(&happening);
            }
        }
        self.scorer.sample(&sample);
    }

    /// The score, if anything was engaged.
    pub(super) fn end(mut self) -> Option<Score> {
        self.newest_s?;
        self.pass_on();
        Some(self.scorer.finish())
    }
}
