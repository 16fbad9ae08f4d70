use nalgebra::Vector3;
use nima_core::{
    Side,
    task::{TaskEvent, TimedTaskEvent},
};

use super::{near, of, right, task, trial, value};
use crate::{HandSample, Proficiency, ScoreSample, Scorer, TaskCriterion, TrainingState, TrialOutcome};

const LEFT: Side = Side::Left;
const RIGHT: Side = Side::Right;

fn still(_: f64) -> super::Hands {
    right(Vector3::zeros())
}

#[test]
fn events_of_a_peg_transfer_are_counted() {
    let events = [
        (2.5, TaskEvent::RingGrasped { ring: 0, side: LEFT }),
        (2.7, TaskEvent::RingLifted { ring: 0, side: LEFT }),
        (4.0, TaskEvent::RingTransferred { ring: 0, to: RIGHT }),
        (6.0, TaskEvent::RingPlaced { ring: 0, side: RIGHT, peg: 7 }),
        (7.0, TaskEvent::RingKnockedOff { ring: 3, side: None }),
        (8.0, TaskEvent::RingGrasped { ring: 1, side: LEFT }),
        (9.0, TaskEvent::RingDropped { ring: 1, side: LEFT, in_view: true }),
        (10.0, TaskEvent::RingGrasped { ring: 1, side: LEFT }),
        (11.0, TaskEvent::RingDropped { ring: 1, side: LEFT, in_view: false }),
    ];
    let score = trial(&task("penalty_s = 17.0\nreference_time_s = 40.0"), 60.0, still, &events);
    let counted = [
        ("time_to_first_grasp_s", 2.5),
        ("lifts", 1.0),
        ("transfers", 1.0),
        ("rings_placed", 1.0),
        ("drops", 2.0),
        ("drops_in_view", 1.0),
        ("drops_out_of_view", 1.0),
        ("rings_knocked_off", 1.0),
        ("completion_time_s", 60.0),
        ("trial_time_s", 60.0),
        ("time_over_reference", 1.5),
        ("fls_like_score", 300.0 - 60.0 - 17.0),
        ("samples", 60_001.0),
        ("samples_skipped", 0.0),
        ("happenings_skipped", 0.0),
    ];
    for (id, known) in counted {
        near(id, value(&score, id), known, 1e-9);
    }
    assert_eq!(score.outcome(), TrialOutcome::Completed);
    assert_eq!([score.value("lumps_found"), score.value("wire_touches")], [None; 2], "of other tasks");
}

#[test]
fn the_score_is_zero_at_the_limit_and_when_aborted_and_never_below() {
    let slow = trial(&task("time_limit_s = 5.0"), 8.0, still, &[]);
    assert_eq!((slow.outcome(), slow.value("fls_like_score")), (TrialOutcome::OutOfTime, Some(0.0)));
    assert_eq!((slow.value("completion_time_s"), slow.value("trial_time_s")), (None, Some(5.0)));
    let aborted = trial(&task(""), 8.0, still, &[(3.0, TaskEvent::Aborted)]);
    assert_eq!((aborted.outcome(), aborted.value("fls_like_score")), (TrialOutcome::Aborted, Some(0.0)));
    assert_eq!((aborted.value("completion_time_s"), aborted.value("trial_time_s")), (None, Some(3.0)));
    let drop = TaskEvent::RingDropped { ring: 0, side: LEFT, in_view: false };
    let dropped = trial(&task("time_limit_s = 10.0\npenalty_s = 5.0"), 8.0, still, &[(1.0, drop)]);
    assert_eq!(dropped.value("fls_like_score"), Some(0.0), "10 - 8 - 5 is below zero");
}

#[test]
fn what_was_before_the_beginning_and_after_the_end_is_forgotten() {
    let mut scorer = Scorer::new(&task(""));
    let drop = TaskEvent::RingDropped { ring: 0, side: LEFT, in_view: false };
    let sample = |t_s: f64| ScoreSample { t_s, hands: right(Vector3::x() * 0.1 * t_s) };
    (0..1000).for_each(|tick| scorer.sample(&sample(f64::from(tick) * 1e-3)));
    scorer.happening(&TimedTaskEvent { t_s: 0.5, event: drop });
    scorer.happening(&TimedTaskEvent { t_s: 1.0, event: TaskEvent::Begun });
    (1000..=3000).for_each(|tick| scorer.sample(&sample(f64::from(tick) * 1e-3)));
    scorer.happening(&TimedTaskEvent { t_s: 3.0, event: TaskEvent::Ended });
    scorer.happening(&TimedTaskEvent { t_s: 3.5, event: drop });
    (3001..=4000).for_each(|tick| scorer.sample(&sample(f64::from(tick) * 1e-3)));
    let score = scorer.finish();
    assert_eq!((score.value("drops"), score.value("completion_time_s")), (Some(0.0), Some(2.0)));
    near("2 s of 0.1 m/s: path_length_m", of(&score, "path_length_m"), 0.2, 1e-9);
}

#[test]
fn a_trial_without_an_end_is_unfinished() {
    let mut scorer = Scorer::new(&task(""));
    assert_eq!(scorer.clone().finish().value("trial_time_s"), None, "nothing came");
    scorer.sample(&ScoreSample { t_s: 7.0, hands: [None; 2] });
    scorer.sample(&ScoreSample { t_s: 9.0, hands: [None; 2] });
    let score = scorer.finish();
    assert_eq!((score.outcome(), score.value("trial_time_s")), (TrialOutcome::Unfinished, Some(2.0)));
    assert_eq!((score.value("completion_time_s"), score.value("fls_like_score")), (None, None));
}

#[test]
fn lumps_are_found_missed_and_falsely_marked_with_their_force() {
    let hands = |t_s: f64| {
        let size_n = if (4.0..4.5).contains(&t_s) { 2.5 } else { 0.5 };
        // A much larger force, but long before the first mark.
        let size_n = if t_s < 1.0 { 9.0 } else { size_n };
        Side::Right.alone(HandSample { force_n: Vector3::z() * size_n, ..HandSample::default() })
    };
    let mark = |lump| TaskEvent::LumpMarked { side: RIGHT, lump };
    let events = [(5.0, mark(Some(2))), (6.0, mark(None)), (7.0, mark(Some(2))), (8.0, mark(Some(4)))];
    let score = trial(&task("kind = 'palpation'\nlumps = 5"), 10.0, hands, &events);
    for (id, known) in [("lumps_found", 2.0), ("lumps_false", 1.0), ("lumps_missed", 3.0)] {
        near(id, value(&score, id), known, 1e-12);
    }
    near("lump_peak_force_n", of(&score, "lump_peak_force_n"), 2.5, 1e-12);
    assert_eq!([score.value("drops"), score.value("fls_like_score")], [None; 2], "of other tasks");
}

#[test]
fn touches_of_the_wire_are_counted_and_timed_until_the_end() {
    let events = [
        (1.0, TaskEvent::WireTouched { side: RIGHT }),
        (1.2, TaskEvent::WireTouched { side: RIGHT }),
        (1.5, TaskEvent::WireLeft { side: RIGHT }),
        (2.0, TaskEvent::WireLeft { side: RIGHT }),
        (3.0, TaskEvent::WireTouched { side: RIGHT }),
        (3.25, TaskEvent::WireLeft { side: RIGHT }),
        (9.0, TaskEvent::WireTouched { side: RIGHT }),
    ];
    let score = trial(&task("kind = 'wire_loop'"), 10.0, still, &events);
    near("wire_touches", value(&score, "wire_touches"), 3.0, 0.0);
    near("wire_touch_time_s", value(&score, "wire_touch_time_s"), 0.5 + 0.25 + 1.0, 1e-9);
}

#[test]
fn scores_decide_on_proficiency() {
    let task = task("proficiency = { time_s = 2.0, consecutive = 2, additional = 1, max_trials = 9 }");
    assert_eq!(
        task.proficiency,
        TaskCriterion { time_s: 2.0, additional: 1, max_trials: 9, ..TaskCriterion::default() }
    );
    let drop = (0.5, TaskEvent::RingDropped { ring: 0, side: LEFT, in_view: false });
    let [good, slow, dropped] =
        [(1.5, vec![]), (2.5, vec![]), (1.5, vec![drop])].map(|(end_s, events)| trial(&task, end_s, still, &events));
    let mut proficiency = Proficiency::new(task.proficiency);
    for (score, standing) in [
        (&good, TrainingState::Practising { in_a_row: 1 }),
        (&dropped, TrainingState::Practising { in_a_row: 0 }),
        (&good, TrainingState::Practising { in_a_row: 1 }),
        (&good, TrainingState::Confirming { additional: 0 }),
        (&slow, TrainingState::Confirming { additional: 0 }),
        (&good, TrainingState::Reached { trial: 6 }),
    ] {
        assert_eq!(proficiency.take(score), standing);
    }
}

#[test]
fn a_task_file_that_is_wrong_names_its_key() {
    use crate::{TaskError, TaskFile};
    let read = |more: &str| TaskFile::from_toml(&format!("name = 'a'\nkind = 'wire_loop'\n{more}")).unwrap_err();
    assert!(matches!(read("rigns = 6"), TaskError::Toml { reason } if reason.contains("rigns")));
    for (key, text) in [
        ("time_limit_s", "time_limit_s = 1e9"),
        ("penalty_s", "penalty_s = nan"),
        ("force_threshold_n", "force_threshold_n = 0.0"),
        ("mark_tolerance_m", "mark_tolerance_m = nan"),
        ("proficiency.time_s", "proficiency = { time_s = -1.0 }"),
        ("proficiency.max_trials", "proficiency = { max_trials = 0 }"),
    ] {
        assert!(matches!(read(text), TaskError::Setting { key: named, .. } if named == key), "{text}: {}", read(text));
    }
}
