use nima_core::impedance::Baseline;

use super::*;

/// Returns a hand that presses a soft spring, on three axes, with a gap at index `hole`.
fn sample(i: usize, hole: Option<usize>) -> Sample {
    let t_s = i as f64 * 1e-3 + if hole.is_some_and(|hole| i >= hole) { 1.0 } else { 0.0 };
    let position_m = Vector3::new(0.01 * (9.0 * t_s).sin(), 0.004 * (7.0 * t_s).cos(), 0.006 * (11.0 * t_s).sin());
    let force_n = position_m.map(|x| if x > 0.0 { 300.0 * x.powf(1.3) } else { 0.0 });
    Sample { t_s, position_m, force_n }
}

const OPTIONS: ReplayOptions = ReplayOptions {
    mode: Mode::Anchored,
    window_s: 0.3,
    delay_s: 0.04,
    max_degree: 3,
    cross_talk: false,
    literal: Recipe {
        reading: nima_core::impedance::IncrementReading::Increments,
        choice: nima_core::impedance::DegreeChoice::Window,
        constant: false,
        ridge: 0.0,
    },
};

/// Returns the rows of 1500 samples, with the leader's motion if `leader` is given.
fn rows(
    mode: Mode,
    hole: Option<usize>,
    leader: Option<&dyn Fn(usize) -> Vector3<f64>>,
) -> (Vec<ReplayRow>, ReplayFigures) {
    let sample = |i: usize| sample(i, hole);
    let motion = ReplayMotion {
        name: "test".into(),
        axes: &[0, 1, 2],
        rate_hz: 1000.0,
        samples: 1500,
        sample: &sample,
        leader_m: leader,
    };
    let mut all = Vec::new();
    let figures = replay_motion(&motion, &ReplayOptions { mode, ..OPTIONS }, |row, parcel| {
        assert!((parcel.t_s - row.t_s).abs() < 1e-12, "the packet of the same tick");
        all.push(*row);
    });
    (all, figures.unwrap())
}

#[test]
fn a_leader_that_makes_the_followers_motion_renders_what_the_follower_foretells() {
    for hole in [None, Some(700)] {
        let same = |i: usize| sample(i, hole).position_m;
        for mode in [Mode::Dfr, Mode::Anchored, Mode::Literal, Mode::Linear, Mode::Baseline(Baseline::Kalman)] {
            let (alone, figures) = rows(mode, hole, None);
            let (led, of_led) = rows(mode, hole, Some(&same));
            for (alone, led) in alone.iter().zip(&led) {
                assert_eq!((alone.rendered, alone.held), (led.rendered, led.held), "{mode} at {} s", alone.t_s);
            }
            assert_eq!(figures.error, of_led.error, "{mode}");
            assert_eq!((figures.own_motion, of_led.own_motion), (OwnMotion::Follower, OwnMotion::Handle));
        }
    }
}

#[test]
fn a_leader_elsewhere_changes_what_is_made_of_motion_and_nothing_else() {
    let ahead = |i: usize| sample(i + 30, None).position_m;
    let error = |mode, leader| rows(mode, None, leader).1.error.mae;
    for mode in [Mode::Anchored, Mode::Matched, Mode::Best] {
        assert!((error(mode, Some(&ahead)) - error(mode, None)).abs() > 1e-6, "{mode}");
    }
    assert!((error(Mode::Dfr, Some(&ahead)) - error(Mode::Dfr, None)).abs() <= 0.0, "reflection knows no motion");
}

#[test]
fn several_recordings_are_one_in_proportion_to_their_samples() {
    let named = |name: &str, mode| (name.to_owned(), rows(mode, None, None).1);
    let anchored = named("a.csv", Mode::Anchored);
    let dfr = named("b.csv", Mode::Dfr);
    let both = ReplaySummary::of(&[anchored.clone(), dfr.clone()]);
    assert_eq!((both.recordings, both.samples, both.compared), (2, 3000, 2 * anchored.1.compared));
    assert!((both.error_mae - 0.5 * (anchored.1.error.mae + dfr.1.error.mae)).abs() < 1e-12);
    let ratios = both.ratios.unwrap();
    assert!((ratios.greatest - 1.0).abs() < 1e-12 && ratios.min < 0.7 && ratios.median <= ratios.greatest);
    assert_eq!(both.worst.as_deref(), Some("b.csv"));
}

/// Returns the figures of samples at a rate.
fn figures(rate_hz: f64, samples: &[Sample], mode: Mode) -> Result<ReplayFigures, RecordingReplayError> {
    let motion = ReplayMotion {
        name: "test".into(),
        axes: &[0, 1, 2],
        rate_hz,
        samples: samples.len(),
        sample: &|i: usize| samples[i],
        leader_m: None,
    };
    let delay_s = OPTIONS.delay_s.max(1.0 / rate_hz);
    replay_motion(&motion, &ReplayOptions { mode, delay_s, ..OPTIONS }, |_, _| ())
}

#[test]
fn a_gap_is_bridged() {
    let without = |gap: std::ops::Range<usize>| -> Vec<Sample> {
        (0..4000).filter(|i| !gap.contains(i)).map(|i| sample(i, None)).collect()
    };
    let mae = |samples: &[Sample]| figures(1000.0, samples, Mode::Best).unwrap().error.mae;
    let [whole, gap] = [without(0..0), without(2000..2500)].map(|samples| mae(&samples));
    assert!(gap < 1.3 * whole, "{gap} N with a gap, {whole} N without");
}

#[test]
fn positions_of_any_unit_and_origin_give_the_same_force() {
    let samples: Vec<Sample> = (0..3000).map(|i| sample(i, None)).collect();
    let expected = figures(1000.0, &samples, Mode::Best).unwrap().error.mae;
    for (scale, origin) in [(1e6, 0.0), (1e3, 5e4), (1.0, 1000.0), (1e-6, 0.0)] {
        let other = |s: &Sample| Sample { position_m: s.position_m * scale + Vector3::repeat(origin), ..*s };
        let moved: Vec<Sample> = samples.iter().map(other).collect();
        let found = figures(1000.0, &moved, Mode::Best).unwrap().error.mae;
        assert!(
            (found / expected - 1.0).abs() < 0.02,
            "times {scale} plus {origin}: {found} N, {expected} N in metres"
        );
    }
}

#[test]
fn a_slow_recording_is_identified_by_the_modes_without_a_window() {
    let samples: Vec<Sample> = (0..200).map(|i| sample(200 * i, None)).collect();
    let best = figures(5.0, &samples, Mode::Best).unwrap();
    assert!(best.error.mae.is_finite() && best.compared > 100, "{best:?}");
    let literal = figures(5.0, &samples, Mode::Literal).unwrap_err().to_string();
    assert!(literal.contains("window"), "{literal}");
}

#[test]
fn a_force_that_is_renewed_more_slowly_than_it_is_recorded_is_named() {
    let fresh: Vec<Sample> = (0..3000).map(|i| sample(i, None)).collect();
    let stale: Vec<Sample> =
        (0..3000).map(|i| Sample { force_n: sample(i - i % 250, None).force_n, ..sample(i, None) }).collect();
    assert_eq!(figures(1000.0, &fresh, Mode::Best).unwrap().force_renewal_hz, None);
    let hz = figures(1000.0, &stale, Mode::Best).unwrap().force_renewal_hz.unwrap();
    assert!((hz - 4.0).abs() < 0.5, "{hz} Hz");
}
