//! Every measure on motions and forces with analytically known results.

mod catalogue;
mod events;
mod force;
mod garbage;
mod scene;
mod tip_motion;
mod two_hands;

use nalgebra::Vector3;
use nima_core::{
    SIDES, Side,
    task::{TaskEvent, TimedTaskEvent},
};

use crate::{HandSample, Score, ScoreSample, Scorer, TaskFile};

type Hands = [Option<HandSample>; SIDES];

fn task(more: &str) -> TaskFile {
    let kind = if more.contains("kind") { "" } else { "kind = 'peg_transfer'\n" };
    TaskFile::from_toml(&format!("name = 'test'\n{kind}{more}")).unwrap()
}

/// Returns a trial at 1 kHz from 0 s to `end_s`, with these events in addition to its beginning and end.
fn trial(task: &TaskFile, end_s: f64, hands: impl Fn(f64) -> Hands, events: &[(f64, TaskEvent)]) -> Score {
    let times_s = (0..=(end_s * 1000.0).round() as u32).map(|tick| f64::from(tick) * 1e-3);
    trial_at(task, times_s, end_s, hands, events)
}

/// Returns the same at any times.
fn trial_at(
    task: &TaskFile,
    times_s: impl Iterator<Item = f64>,
    end_s: f64,
    hands: impl Fn(f64) -> Hands,
    events: &[(f64, TaskEvent)],
) -> Score {
    // Use an offset, so that a clock time cannot be mistaken for a time since the beginning.
    let zero_s = 5000.0;
    let mut scorer = Scorer::new(task);
    scorer.happening(&TimedTaskEvent { t_s: zero_s, event: TaskEvent::Begun });
    let mut waiting = events.iter().peekable();
    for t_s in times_s {
        while let Some((event_s, event)) = waiting.next_if(|(event_s, _)| *event_s < t_s) {
            scorer.happening(&TimedTaskEvent { t_s: zero_s + event_s, event: *event });
        }
        scorer.sample(&ScoreSample { t_s: zero_s + t_s, hands: hands(t_s) });
    }
    for (event_s, event) in waiting {
        scorer.happening(&TimedTaskEvent { t_s: zero_s + event_s, event: *event });
    }
    scorer.happening(&TimedTaskEvent { t_s: zero_s + end_s, event: TaskEvent::Ended });
    scorer.finish()
}

fn tip(tip_m: Vector3<f64>) -> HandSample {
    HandSample { tip_m, ..HandSample::default() }
}

fn right(tip_m: Vector3<f64>) -> Hands {
    Side::Right.alone(tip(tip_m))
}

/// Returns the position, from 0 to 1, of a minimum-jerk reach that takes 1 s (Flash and Hogan 1985).
fn minimum_jerk(s: f64) -> f64 {
    let s = s.clamp(0.0, 1.0);
    s * s * s * (10.0 - 15.0 * s + 6.0 * s * s)
}

/// Returns a measure of the right hand.
fn of(score: &Score, id: &str) -> f64 {
    score.of(id, Side::Right).unwrap_or_else(|| panic!("no {id}"))
}

fn value(score: &Score, id: &str) -> f64 {
    score.value(id).unwrap_or_else(|| panic!("no {id}"))
}

#[track_caller]
fn near(what: &str, ours: f64, known: f64, relative: f64) {
    // `NIMA_SCORE_SHOW` prints every comparison, for docs/results/statistics.md.
    if std::env::var_os("NIMA_SCORE_SHOW").is_some() {
        eprintln!("| {what} | {ours:.9e} | {known:.9e} | {:.1e} |", ((ours - known) / known).abs());
    }
    assert!((ours - known).abs() <= relative * known.abs(), "{what}: {ours}, known {known}");
}
