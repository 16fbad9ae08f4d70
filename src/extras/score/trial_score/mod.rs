//! The score of a trial: motion and force of the hands while they were engaged, and events of the scene's objects.
//!
//! [`LiveTrial`] computes it from the ticks of a running loop, [`score`] from a recorded session, with the same results
//! to the last bit.

mod live;

use std::{
    collections::{BTreeMap, VecDeque},
    ops::Range,
    path::Path,
};

use nalgebra::Vector3;
use nima_core::task::{TaskEvent, TimedTaskEvent};
use nima_machine::{
    messages::LoopState,
    rig::{SIDES, Side},
};
use nima_recording::session::SessionReader;
use nima_session::{
    objects,
    plot_channels::{self, PlottedError, PlottedTick},
};

pub use self::live::LiveTrial;
use crate::{HandSample, Score, ScoreSample, Scorer, TaskFile};

/// A session is read in parts of this length, ns.
const STRETCH_NS: u64 = 2_000_000_000;

/// A trial, from the first tick in which an arm is engaged to the last one. Events of a time must be added before the
/// sample of that time.
#[derive(Debug)]
struct ScoredTrial {
    scorer: Scorer,
    begun_s: Option<f64>,
    engaged_s: f64,
    /// The scorer at the time when an arm was last engaged, while none is.
    before_pause: Option<Scorer>,
    openings: [VecDeque<(f64, f64)>; SIDES],
    happenings: VecDeque<TimedTaskEvent>,
    /// Current opening of the jaws of each side, rad.
    open_rad: [Option<f64>; SIDES],
}

impl ScoredTrial {
    /// Creates a trial of this task.
    fn new(task: &TaskFile) -> Self {
        Self {
            scorer: Scorer::new(task),
            begun_s: None,
            engaged_s: 0.0,
            before_pause: None,
            openings: Default::default(),
            happenings: VecDeque::new(),
            open_rad: [None; SIDES],
        }
    }

    /// Sets the opening of this side's jaws from this time of the loop (s) on, rad.
    fn opening(&mut self, side: Side, t_s: f64, opening_rad: f64) {
        self.openings[side.index()].push_back((as_recorded(t_s), opening_rad));
    }

    /// Adds an event of the objects.
    fn happening(&mut self, happening: &TimedTaskEvent) {
        self.happenings.push_back(TimedTaskEvent { t_s: as_recorded(happening.t_s), ..*happening });
    }

    /// Adds both hands at the next time of the loop, with the openings set before.
    fn sample(&mut self, sample: &ScoreSample) {
        let mut sample = ScoreSample { t_s: as_recorded(sample.t_s), ..*sample };
        self.move_jaws(&mut sample);
        let t_s = sample.t_s;
        let engaged = sample.hands.iter().flatten().any(|hand| hand.engaged);
        if engaged && self.begun_s.is_none() {
            self.begun_s = Some(t_s);
            self.scorer.happening(&TimedTaskEvent { t_s, event: TaskEvent::Begun });
        }
        if engaged {
            self.engaged_s = t_s;
            self.before_pause = None;
        } else if self.begun_s.is_some() && self.before_pause.is_none() {
            self.before_pause = Some(self.scorer.clone());
        }
        while let Some(happening) = self.happenings.pop_front_if(|happening| happening.t_s <= t_s) {
            if self.begun_s.is_none_or(|begun_s| happening.t_s < begun_s) {
                continue;
            }
            self.scorer.happening(&happening);
            // A task may be completed shortly after the hand has released the handle.
            if happening.event == TaskEvent::Ended {
                self.before_pause = None;
            }
        }
        if self.begun_s.is_some() {
            self.scorer.sample(&sample);
        }
    }

    /// Returns the score; `None` if no arm was engaged. With `is_done` the trial counts as completed when an arm was
    /// last engaged: for sessions without a report of the completion.
    fn end(self, is_done: bool) -> Option<Score> {
        self.begun_s?;
        let mut scorer = self.before_pause.unwrap_or(self.scorer);
        if is_done {
            scorer.happening(&TimedTaskEvent { t_s: self.engaged_s, event: TaskEvent::Ended });
        }
        Some(scorer.finish())
    }

    fn move_jaws(&mut self, sample: &mut ScoreSample) {
        for side in Side::ALL {
            let open_rad = &mut self.open_rad[side.index()];
            while let Some((_, opening_rad)) = self.openings[side.index()].pop_front_if(|(t_s, _)| *t_s <= sample.t_s) {
                *open_rad = Some(opening_rad);
            }
            if let Some(hand) = &mut sample.hands[side.index()] {
                hand.jaw_rad = *open_rad;
            }
        }
    }
}

/// Converts a time of the loop (s) to its form in a session, which has whole ns, so that a running loop has the same
/// results as its recording.
fn as_recorded(t_s: f64) -> f64 {
    (t_s.max(0.0) * 1e9).round() / 1e9
}

/// Scores a part of a session (ns since 1970); `None` if no arm was engaged in it. In a session without a source of
/// objects, the task counts as done when an arm was last engaged.
///
/// # Errors
/// [`PlottedError`] for a file that cannot be read, or was written by another program.
pub fn score(
    reader: &SessionReader,
    path: &Path,
    times_ns: &Range<u64>,
    task: &TaskFile,
) -> Result<Option<Score>, PlottedError> {
    let arms = plot_channels::arms(reader);
    if arms.is_empty() {
        return Err(PlottedError::NoArms { path: path.to_owned() });
    }
    let mut trial = ScoredTrial::new(task);
    let (first_ns, last_ns) = reader.statistics().times_ns;
    let end_ns = times_ns.end.min(last_ns.saturating_add(1));
    let mut from_ns = times_ns.start.max(first_ns);
    while from_ns < end_ns {
        let stretch_ns = from_ns..from_ns.saturating_add(STRETCH_NS).min(end_ns);
        for side in Side::ALL {
            for (t_s, opening_rad) in objects::openings(reader, side, stretch_ns.clone())? {
                trial.opening(side, t_s, opening_rad);
            }
        }
        for happening in objects::happenings(reader, stretch_ns.clone())? {
            trial.happening(&happening);
        }
        let samples = samples(reader, path, stretch_ns.clone(), &arms)?;
        // Messages may be years apart in a file of another program.
        let next = samples.is_empty().then(|| reader.messages(&[], stretch_ns.end..end_ns).next());
        for sample in samples {
            trial.sample(&sample);
        }
        from_ns = match next.map(Option::transpose).transpose()?.map(|next| next.map(|next| next.log_time_ns())) {
            None => stretch_ns.end,
            Some(Some(time_ns)) => time_ns.max(stretch_ns.end),
            Some(None) => end_ns,
        };
    }
    Ok(trial.end(!objects::are_reported(reader)))
}

/// Returns a hand in a tick. No endoscope reports yet whether it is in view.
const fn hand_of(tip_m: Vector3<f64>, force_n: Vector3<f64>, rendered_n: Vector3<f64>, engaged: bool) -> HandSample {
    HandSample { tip_m, jaw_rad: None, force_n, rendered_n, engaged, in_view: true }
}

/// Returns both hands, tick by tick.
fn samples(
    reader: &SessionReader,
    path: &Path,
    times_ns: Range<u64>,
    arms: &[Side],
) -> Result<Vec<ScoreSample>, PlottedError> {
    let mut samples: BTreeMap<u64, ScoreSample> = BTreeMap::new();
    for arm in arms {
        plot_channels::each_tick(reader, path, *arm, times_ns.clone(), |tick| {
            let PlottedTick { time_ns, t_s, tip_m, measured_n, rendered_n, state, .. } = tick;
            let engaged = state == LoopState::Engaged;
            let hand = hand_of(tip_m, measured_n, rendered_n, engaged);
            let none = || ScoreSample { t_s, ..ScoreSample::default() };
            samples.entry(time_ns).or_insert_with(none).hands[arm.index()] = Some(hand);
            Ok::<_, PlottedError>(())
        })?;
    }
    Ok(samples.into_values().collect())
}

#[cfg(test)]
mod tests {
    use crate::TrialOutcome;

    use super::*;

    const TASK: &str = "name = 'Rings'\nkind = 'peg_transfer'\ntime_limit_s = 60.0";

    fn trial() -> ScoredTrial {
        ScoredTrial::new(&TaskFile::from_toml(TASK).unwrap())
    }

    fn sample(trial: &mut ScoredTrial, millis: u32, engaged: bool) {
        let hand = HandSample { engaged, in_view: true, ..HandSample::default() };
        trial.sample(&ScoreSample { t_s: f64::from(millis) * 1e-3, hands: Side::Right.alone(hand) });
    }

    fn event(trial: &mut ScoredTrial, millis: u32, event: TaskEvent) {
        trial.happening(&TimedTaskEvent { t_s: f64::from(millis) * 1e-3, event });
    }

    const GRASPED: TaskEvent = TaskEvent::RingGrasped { ring: 0, side: Side::Right };
    const LIFTED: TaskEvent = TaskEvent::RingLifted { ring: 0, side: Side::Right };

    #[test]
    fn a_trial_lasts_from_the_first_engaged_tick_to_the_last_one() {
        let mut trial = trial();
        event(&mut trial, 50, LIFTED);
        event(&mut trial, 400, GRASPED);
        event(&mut trial, 700, LIFTED);
        event(&mut trial, 1450, LIFTED);
        for millis in 0..2000 {
            sample(&mut trial, millis, matches!(millis, 100..500 | 600..=1200));
        }
        let score = trial.end(false).unwrap();
        assert_eq!(score.outcome(), TrialOutcome::Unfinished);
        let value = |id: &str| score.value(id).unwrap();
        assert!((value("trial_time_s") - 1.1).abs() < 1e-9 && value("lifts") < 1.5, "{}", value("lifts"));
        assert!((value("time_to_first_grasp_s") - 0.3).abs() < 1e-9);
        assert!((value("samples") - 1101.0).abs() < 1e-9, "the pause within it counts: {}", value("samples"));
        assert!((value("happenings_skipped")).abs() < 1e-9, "data before it are not at fault");
    }

    #[test]
    fn a_task_that_is_done_when_the_hand_has_let_go_is_done() {
        let mut trial = trial();
        event(&mut trial, 1020, TaskEvent::Ended);
        for millis in 0..1500 {
            sample(&mut trial, millis, millis < 1000);
        }
        let score = trial.end(false).unwrap();
        assert_eq!(score.outcome(), TrialOutcome::Completed);
        assert!((score.value("completion_time_s").unwrap() - 1.02).abs() < 1e-9);
    }

    #[test]
    fn jaws_are_counted_as_they_were_told() {
        let mut trial = trial();
        for (millis, opening_rad) in [(0, 0.0), (300, 0.6), (600, 0.0), (800, 0.5), (900, 0.0)] {
            trial.opening(Side::Right, f64::from(millis) * 1e-3, opening_rad);
        }
        for millis in 0..1000 {
            sample(&mut trial, millis, true);
        }
        let score = trial.end(false).unwrap();
        assert_eq!(score.of("jaw_openings", Side::Right), Some(2.0));
    }

    #[test]
    fn without_an_engaged_arm_there_is_no_trial() {
        let mut trial = trial();
        sample(&mut trial, 0, false);
        assert!(trial.end(true).is_none());
    }
}
