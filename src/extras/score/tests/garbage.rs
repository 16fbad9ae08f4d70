use nalgebra::Vector3;
use nima_core::{
    Side,
    task::{TaskEvent, TimedTaskEvent},
};
use proptest::prelude::*;

use super::task;
use crate::{HandSample, Score, ScoreSample, Scorer};

/// Generates any number, often a problematic one.
fn number() -> impl Strategy<Value = f64> {
    let odd = prop_oneof![
        Just(f64::NAN),
        Just(f64::INFINITY),
        Just(f64::MAX),
        Just(f64::MIN_POSITIVE),
        Just(-0.0),
        Just(1e3)
    ];
    prop_oneof![6 => -1.0..1.0, 2 => -500.0..500.0, 1 => any::<f64>(), 1 => odd]
}

fn vector() -> impl Strategy<Value = Vector3<f64>> {
    let even = (-0.1..0.1, -0.1..0.1, -0.1..0.1).prop_map(|(x, y, z)| Vector3::new(x, y, z));
    prop_oneof![3 => even, 1 => (number(), number(), number()).prop_map(|(x, y, z)| Vector3::new(x, y, z))]
}

fn hand() -> impl Strategy<Value = Option<HandSample>> {
    let parts = (vector(), vector(), vector(), proptest::option::of(number()), any::<bool>(), any::<bool>());
    proptest::option::weighted(
        0.8,
        parts.prop_map(|(tip_m, force_n, rendered_n, jaw_rad, engaged, in_view)| HandSample {
            tip_m,
            jaw_rad,
            force_n,
            rendered_n,
            engaged,
            in_view,
        }),
    )
}

fn event() -> impl Strategy<Value = TaskEvent> {
    let side = prop_oneof![Just(Side::Left), Just(Side::Right)];
    (0..13, side, any::<usize>(), any::<bool>()).prop_map(|(kind, side, index, flag)| match kind {
        0 => TaskEvent::Begun,
        1 => TaskEvent::Ended,
        2 => TaskEvent::Aborted,
        3 | 4 => TaskEvent::RingGrasped { ring: index, side },
        5 => TaskEvent::RingLifted { ring: index, side },
        6 => TaskEvent::RingTransferred { ring: index, to: side },
        7 => TaskEvent::RingPlaced { ring: index, side, peg: index },
        8 => TaskEvent::RingDropped { ring: index, side, in_view: flag },
        9 => TaskEvent::RingKnockedOff { ring: index, side: flag.then_some(side) },
        10 => TaskEvent::LumpMarked { side, lump: flag.then_some(index) },
        11 => TaskEvent::WireTouched { side },
        _ => TaskEvent::WireLeft { side },
    })
}

/// Returns the time to the next one, s: usually a normal step.
fn step() -> impl Strategy<Value = f64> {
    prop_oneof![12 => 0.0..0.02, 3 => 0.0..0.3, 1 => number()]
}

fn judged(score: &Score) -> Result<(), TestCaseError> {
    for measure in score.measures() {
        prop_assert!(measure.value.is_none_or(f64::is_finite), "{}: {:?}", measure.key(), measure.value);
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn any_input_gives_finite_values_and_no_panic(
        kind in 0..3_usize,
        steps in proptest::collection::vec((step(), prop_oneof![9 => Just(None), 1 => event().prop_map(Some)], hand(), hand()), 0..200),
    ) {
        let task = task(["kind = 'peg_transfer'", "kind = 'palpation'\nlumps = 3", "kind = 'wire_loop'"][kind]);
        let mut scorer = Scorer::new(&task);
        let mut now_s = 100.0;
        for (step_s, event, right, left) in steps {
            let t_s = now_s + step_s;
            now_s = if t_s.is_finite() && (0.0..1.0).contains(&step_s) { t_s } else { now_s };
            match event {
                Some(event) => scorer.happening(&TimedTaskEvent { t_s, event }),
                None => scorer.sample(&ScoreSample { t_s, hands: [right, left] }),
            }
        }
        judged(&scorer.finish())?;
    }

    #[test]
    fn a_step_anywhere_never_makes_the_path_shorter_than_the_way(x in -0.2..0.2, at in 1..1999_u32) {
        let way = |t_s: f64| super::right(Vector3::x() * if t_s * 1000.0 < f64::from(at) { 0.0 } else { x });
        let score = super::trial(&task(""), 2.0, way, &[]);
        let path_m = super::of(&score, "path_length_m");
        prop_assert!(path_m >= x.abs() - 1e-9 && path_m < 2.0 * x.abs() + 1e-9, "{path_m} {x}");
    }
}

#[test]
fn numbers_that_are_none_are_skipped_and_counted() {
    let mut scorer = Scorer::new(&task(""));
    let hands = |x_m: f64| super::right(Vector3::new(x_m, 0.0, 0.0));
    for (t_s, x_m) in [
        (0.0, 0.0),
        (f64::NAN, 0.0),
        (0.001, f64::NAN),
        (0.001, 0.0),
        (f64::INFINITY, 0.0),
        (0.002, 1e300),
        (0.003, 0.0),
    ] {
        scorer.sample(&ScoreSample { t_s, hands: hands(x_m) });
    }
    scorer.happening(&TimedTaskEvent { t_s: f64::NAN, event: TaskEvent::Ended });
    scorer.happening(&TimedTaskEvent { t_s: -1.0, event: TaskEvent::Ended });
    let score = scorer.finish();
    assert_eq!(score.value("samples"), Some(4.0));
    assert_eq!(score.value("samples_skipped"), Some(5.0));
    assert_eq!(score.value("happenings_skipped"), Some(2.0));
    judged(&score).unwrap();
}

#[test]
fn a_task_that_was_never_checked_is_bounded_too() {
    let mut task = task("");
    for limit_s in [f64::NAN, f64::INFINITY, -1.0, 0.0] {
        task.time_limit_s = limit_s;
        task.contact_n = f64::NAN;
        task.reference_time_s = 0.0;
        let score = super::trial(&task, 1.0, |t_s| super::right(Vector3::x() * t_s), &[]);
        judged(&score).unwrap();
    }
}
