//! A running trial, scored from the ticks of its loop.

use nima_core::task::{TaskEvent, TaskKind, TimedTaskEvent};
use nima_machine::{
    messages::{LoopState, Tick},
    rig::{SIDES, Side},
};

use crate::{HandSample, Score, ScoreSample, TaskFile};

use super::{ScoredTrial, hand_of};

/// Scores from the first tick in which an arm is engaged. Events of the objects are added before the next tick.
#[derive(Debug)]
pub struct LiveTrial {
    trial: ScoredTrial,
    /// The tick of both hands that is still incomplete.
    sample: Option<ScoreSample>,
    begun_s: Option<f64>,
    newest_s: f64,
    ended: bool,
    limit_s: f64,
    /// Only the instruments of a peg transfer have jaws.
    has_jaws: bool,
}

impl LiveTrial {
    /// Creates a trial of this task.
    pub fn new(task: &TaskFile) -> Self {
        Self {
            trial: ScoredTrial::new(task),
            sample: None,
            begun_s: None,
            newest_s: 0.0,
            ended: false,
            limit_s: task.time_limit_s,
            has_jaws: task.kind == TaskKind::PegTransfer,
        }
    }

    /// Sets the openings of the jaws from this time of the loop (s) on, rad.
    pub fn opening(&mut self, t_s: f64, opening_rad: [f64; SIDES]) {
        if self.has_jaws {
            for side in Side::ALL {
                self.trial.opening(side, t_s, opening_rad[side.index()]);
            }
        }
    }

    /// Adds an event of the objects.
    pub fn happening(&mut self, happening: &TimedTaskEvent) {
        self.ended |= happening.event == TaskEvent::Ended;
        self.trial.happening(happening);
    }

    /// Adds the next tick of a side.
    pub fn tick(&mut self, tick: &Tick) {
        let engaged = tick.state == LoopState::Engaged;
        self.hand(
            tick.side,
            tick.t_s,
            hand_of(tick.positions.tip_m, tick.measured_n, tick.rendering.rendered_n, engaged),
        );
    }

    fn hand(&mut self, side: Side, t_s: f64, hand: HandSample) {
        if let Some(complete) = self.sample.take_if(|sample| t_s > sample.t_s) {
            self.trial.sample(&complete);
        }
        if hand.engaged {
            self.begun_s.get_or_insert(t_s);
        }
        self.newest_s = t_s;
        let sample = self.sample.get_or_insert(ScoreSample { t_s, ..ScoreSample::default() });
        sample.hands[side.index()] = Some(hand);
    }

    /// Returns whether the task is complete or its time is over: later ticks do not count.
    pub fn is_over(&self) -> bool {
        self.ended || self.elapsed_s() > self.limit_s
    }

    /// Returns the time since the first tick in which an arm was engaged, s.
    pub fn elapsed_s(&self) -> f64 {
        self.begun_s.map_or(0.0, |begun_s| self.newest_s - begun_s)
    }

    /// Returns the score; `None` if no arm was engaged. With `is_done` the trial counts as completed when an arm was
    /// last engaged: for scenes without a report of the completion.
    pub fn end(mut self, is_done: bool) -> Option<Score> {
        if let Some(last) = self.sample.take() {
            self.trial.sample(&last);
        }
        self.trial.end(is_done)
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;

    fn live(kind: &str) -> LiveTrial {
        let task = format!("name = 'Rings'\nkind = '{kind}'\ntime_limit_s = 0.5");
        LiveTrial::new(&TaskFile::from_toml(&task).unwrap())
    }

    /// Returns both sides for some ticks from `from` (ms) on; the right hand is engaged and moves by a tenth of a
    /// millimetre in each.
    fn ticks(live: &mut LiveTrial, millis: std::ops::Range<u32>) {
        for millis in millis {
            let t_s = f64::from(millis) * 1e-3;
            let tip_m = Vector3::new(f64::from(millis) * 1e-4, 0.0, 0.0);
            live.hand(Side::Left, t_s, hand_of(Vector3::zeros(), Vector3::zeros(), Vector3::zeros(), false));
            live.hand(Side::Right, t_s, hand_of(tip_m, Vector3::x(), Vector3::zeros(), true));
        }
    }

    #[test]
    fn ticks_of_both_sides_are_one_sample_and_the_last_one_counts() {
        let mut live = live("palpation");
        ticks(&mut live, 100..301);
        let score = live.end(false).unwrap();
        assert_eq!(score.value("samples"), Some(201.0));
        let moved_m = score.of("path_length_m", Side::Right).unwrap();
        assert!((moved_m - 0.02).abs() < 1e-3, "{moved_m}");
    }

    #[test]
    fn it_is_over_when_the_time_is_or_the_task_is_done() {
        let mut late = live("palpation");
        ticks(&mut late, 1000..1501);
        assert!(!late.is_over() && (late.elapsed_s() - 0.5).abs() < 1e-9, "{}", late.elapsed_s());
        ticks(&mut late, 1501..1502);
        assert!(late.is_over());
        let mut done = live("palpation");
        ticks(&mut done, 0..10);
        assert!(!done.is_over());
        done.happening(&TimedTaskEvent { t_s: 0.009, event: TaskEvent::Ended });
        assert!(done.is_over());
    }

    #[test]
    fn only_the_instruments_of_a_peg_transfer_have_jaws() {
        for (kind, openings) in [("peg_transfer", Some(1.0)), ("palpation", None)] {
            let mut live = live(kind);
            for (t_s, opening_rad) in [(0.0, 0.0), (0.1, 0.6), (0.3, 0.0)] {
                let mut both_rad = [0.0; SIDES];
                both_rad[Side::Right.index()] = opening_rad;
                live.opening(t_s, both_rad);
            }
            ticks(&mut live, 0..400);
            let score = live.end(false).unwrap();
            assert_eq!(score.of("jaw_openings", Side::Right), openings, "{kind}");
        }
    }
}
