//! Tests of whole studies.

mod files;
mod journal;
mod orders;
mod questionnaires;
mod rules;
mod sealing;

use std::path::Path;

use nima_core::{
    Side,
    task::{TaskEvent, TimedTaskEvent},
};
use nima_score::{HandSample, Score, ScoreSample, Scorer, TaskFile};

use crate::{StudyFile, StudyStep, TrialEnding, UserStudy};

pub(super) const AT: &str = "2026-01-01T09:00:00Z";

/// Two conditions whose names and numbers occur nowhere else.
pub(super) const TWO: &str = "
name = 'Touching'
scene = 'rings'
primary = 'completion_time_s'
participants = 4
trials = 3
seed = 5
[[conditions]]
name = 'Zebra'
mode = 'anchored'
gain = 0.8125
delay_ms = 137.5
[[conditions]]
name = 'Yak'
no_force = true
";

pub(super) fn file(text: &str) -> StudyFile {
    StudyFile::from_toml(text).unwrap()
}

pub(super) fn made(folder: &Path, text: &str) -> UserStudy {
    UserStudy::create(&folder.join("study"), &file(text), "name = 'scene'", AT).unwrap()
}

pub(super) fn again(folder: &Path) -> UserStudy {
    UserStudy::open(&folder.join("study"), AT).unwrap()
}

/// Returns a score of a trial with this duration and a force in the hand.
pub(super) fn score(seconds: u32) -> Score {
    score_with(seconds, 1.625)
}

/// Returns the same with this force in the hand, N.
pub(super) fn score_with(seconds: u32, force_n: f64) -> Score {
    let mut scorer = Scorer::new(&TaskFile::from_toml("name = 'x'\nkind = 'peg_transfer'").unwrap());
    scorer.happening(&TimedTaskEvent { t_s: 0.0, event: TaskEvent::Begun });
    for tick in 0..=seconds * 10 {
        let t_s = f64::from(tick) * 0.1;
        let right = HandSample {
            tip_m: vector([0.01 * t_s, 0.0, 0.0]),
            rendered_n: vector([force_n, 0.0, 0.0]),
            engaged: true,
            ..HandSample::default()
        };
        scorer.sample(&ScoreSample { t_s, hands: Side::Right.alone(right) });
    }
    scorer.happening(&TimedTaskEvent { t_s: f64::from(seconds), event: TaskEvent::Ended });
    scorer.finish()
}

fn vector<V: From<[f64; 3]>>(values: [f64; 3]) -> V {
    V::from(values)
}

/// Does the next trial in this many seconds.
pub(super) fn trial(study: &mut UserStudy, participant: &str, seconds: u32) {
    let running = study.begin_trial(participant, true, AT).unwrap();
    study.end_trial(running, TrialEnding::Completed, &score(seconds), AT).unwrap();
}

pub(super) fn next(study: &UserStudy, participant: &str) -> String {
    study.next(participant).unwrap().to_string()
}

/// Returns the number and attempt of the next trial.
pub(super) fn due(study: &UserStudy, participant: &str) -> (u32, u32) {
    match study.next(participant).unwrap() {
        StudyStep::Trial { number, attempt, .. } | StudyStep::Practice { number, attempt } => (number, attempt),
        other => panic!("{other}"),
    }
}
