//! Unneeded computations are skipped: modes that are not chosen, and learning without contact.

use std::f64::consts::TAU;

use nalgebra::Vector3;

use super::{tests::sample, *};

const REST_N: f64 = 0.1;

fn settings() -> ImpedanceSettings {
    ImpedanceSettings { window_s: 0.1, delay_s: 0.03, rest_n: REST_N, ..ImpedanceSettings::default() }
}

/// Presses into a spring of 200 N/m twice per second until 1.5 s and from 4.5 s on; in between the tip moves above it.
fn touched(k: usize) -> Sample {
    let t_s = k as f64 * 1e-3;
    let away_m = 0.03 * (1.0 - (TAU * (t_s - 1.5) / 3.0).cos()) * f64::from((1500..4500).contains(&k));
    let z_m = 0.003 + 0.008 * (2.0 * TAU * t_s).cos() + away_m;
    let noise_n = Vector3::new(0.01, -0.02, 0.015) * (k as f64).sin();
    let force_n = Vector3::new(0.0, 0.0, 200.0 * (-z_m).max(0.0)) + noise_n;
    Sample { t_s, position_m: Vector3::new(0.0, 0.0, z_m), force_n }
}

#[test]
fn without_contact_nothing_is_learnt_and_learning_goes_on_with_the_next_contact() {
    for mode in [Mode::Dfr, Mode::Linear, Mode::Anchored, Mode::Matched, Mode::Nima, Mode::Best] {
        let mut identifier = Identifier::new(&ImpedanceSettings { modes: ModeSet::only(mode), ..settings() }).unwrap();
        let mut learnt = [0; 3];
        let mut touches = 0;
        for k in 0..6000 {
            let sample = touched(k);
            identifier.step(&sample);
            let report = identifier.report();
            if sample.force_n.norm() > REST_N {
                assert!(!report.resting, "{mode}: a force is always learnt from");
                touches += 1;
            }
            if let Some(part) = [2900, 3700, 5999].iter().position(|&at| at == k) {
                learnt[part] = report.learnt;
            }
        }
        assert!(touches > 500);
        // Far from the tissue, any force that is still predicted must be unlearned first.
        assert!(learnt[1] < learnt[0] + 200, "{mode}: {learnt:?} samples");
        assert!(learnt[2] > learnt[1] + 500, "{mode}: it learns again");
    }
}

#[test]
fn what_was_learnt_before_a_rest_is_there_at_the_next_touch() {
    let settings = |rest_n| ImpedanceSettings { modes: ModeSet::only(Mode::Best), rest_n, ..settings() };
    let [mut resting, mut restless] = [REST_N, 0.0].map(|rest_n| Box::new(Identifier::new(&settings(rest_n)).unwrap()));
    let mut errors_n = [0.0; 3];
    for k in 0..5500 {
        let sample = touched(k);
        resting.step(&sample);
        restless.step(&sample);
        if k >= 4500 {
            let error_n = |of: &Identifier, mode| (of.report().prediction(mode).unwrap() - sample.force_n).norm();
            errors_n[0] += error_n(&resting, Mode::Best);
            errors_n[1] += error_n(&restless, Mode::Best);
            errors_n[2] += error_n(&resting, Mode::Dfr);
        }
    }
    println!("{errors_n:?}");
    assert!(errors_n[0] < 0.7 * errors_n[2] && errors_n[0] < 1.3 * errors_n[1], "{errors_n:?}");
}

#[test]
fn a_mode_that_nobody_chose_is_not_computed() {
    let mut identifier = Identifier::new(&ImpedanceSettings { rest_n: 0.0, ..settings() }).unwrap();
    let mut alone =
        Identifier::new(&ImpedanceSettings { modes: ModeSet::only(Mode::Matched), rest_n: 0.0, ..settings() }).unwrap();
    identifier.compute(ModeSet::only(Mode::Matched));
    for k in 0..500 {
        identifier.step(&sample(k, 1000.0));
        alone.step(&sample(k, 1000.0));
    }
    let report = identifier.report();
    let valid = Mode::ALL.map(|mode| report.prediction(mode).is_some());
    assert_eq!(valid, Mode::ALL.map(|mode| matches!(mode, Mode::Dfr | Mode::Matched)));
    assert_eq!((report.degrees.paper, report.degrees.anchored, report.degrees.nima, report.rank), (0, 0, 0, 0));
    assert_eq!(identifier.parcel(), alone.parcel(), "what is left out leaves no trace");

    // An added mode restarts learning, while the other one continues.
    identifier.compute(ModeSet::only(Mode::Matched).with(Mode::Anchored).with(Mode::Literal));
    for k in 500..1500 {
        identifier.step(&sample(k, 1000.0));
        alone.step(&sample(k, 1000.0));
    }
    assert_eq!(identifier.parcel().models.matched, alone.parcel().models.matched);
    assert!(identifier.report().degrees.anchored > 0 && identifier.report().degrees.paper > 0);
    assert!(identifier.report().rank > 0, "the window's degrees are available for comparison");
    assert!(identifier.report().prediction(Mode::Linear).is_none());

    identifier.compute(ModeSet::only(Mode::Linear));
    assert_eq!(identifier.parcel().models.literal, LiteralModel::NONE);
    for k in 1500..2000 {
        identifier.step(&sample(k, 1000.0));
    }
    let mut linear =
        Identifier::new(&ImpedanceSettings { modes: ModeSet::only(Mode::Linear), rest_n: 0.0, ..settings() }).unwrap();
    for k in 0..2000 {
        linear.step(&sample(k, 1000.0));
    }
    assert_eq!(identifier.parcel().models.linear, linear.parcel().models.linear, "the window slid over it");
}

#[test]
fn a_force_that_counts_as_none_must_be_small() {
    for rest_n in [-0.1, 1.1, f64::NAN, f64::INFINITY] {
        assert!(matches!(ImpedanceSettings { rest_n, ..settings() }.validate(), Err(SettingsError::Rest { .. })));
    }
}
