//! Both ends together: extremes, symmetry, delay, and real recordings.

#![expect(clippy::float_cmp, reason = "where the same operations are done, the same bits come out")]

use nalgebra::Vector3;

use super::*;

/// Returns a palpation-like motion with contact, in three axes, deterministic.
pub(super) fn sample(k: usize, rate_hz: f64) -> Sample {
    let t = k as f64 / rate_hz;
    let x = Vector3::new(
        0.02 * (5.0 * t).sin() + 0.003 * (31.0 * t).sin(),
        0.015 * (4.0 * t + 0.5).sin() + 0.002 * (23.0 * t).cos(),
        0.01 * (6.0 * t).cos() + 0.004 * (17.0 * t).sin(),
    );
    let v = Vector3::new(
        0.1 * (5.0 * t).cos() + 0.093 * (31.0 * t).cos(),
        0.06 * (4.0 * t + 0.5).cos() - 0.046 * (23.0 * t).sin(),
        -0.06 * (6.0 * t).sin() + 0.068 * (17.0 * t).cos(),
    );
    let force = |x: f64, v: f64| 80.0 * x + 2000.0 * x * x + 3.0 * v + 0.3;
    Sample { t_s: t, position_m: x, force_n: Vector3::new(force(x.x, v.x), force(x.y, v.y), force(x.z, v.z)) }
}

fn settings() -> ImpedanceSettings {
    ImpedanceSettings { window_s: 0.1, delay_s: 0.03, ..ImpedanceSettings::default() }
}

fn assert_finite(report: &IdentificationReport, parcel: &LinkPacket) {
    let IdentificationReport { prediction_n, reconstruction_n, condition, excitation, horizon_error_n, .. } = report;
    let vectors = prediction_n.iter().chain(reconstruction_n).chain([
        &excitation.position_m,
        &excitation.velocity_m_s,
        &excitation.acceleration_m_s2,
        &parcel.force_n,
    ]);
    assert!(vectors.flat_map(|v| v.iter()).all(|v| v.is_finite()), "{report:?}");
    assert!(condition.is_finite() && horizon_error_n.iter().all(|e| e.is_finite()), "{report:?}");
    for model in [&parcel.models.literal, &parcel.models.linear] {
        assert!(model.coefficients.iter().all(|m| m.is_finite()), "{parcel:?}");
    }
    let anchored = &parcel.models.anchored;
    assert!(anchored.motion.iter().chain([&anchored.constant_n]).all(|m| m.is_finite()), "{parcel:?}");
    for model in [&parcel.models.matched, &parcel.models.nima] {
        assert!(model.parameters.iter().chain([&model.offset_n]).all(|m| m.is_finite()), "{parcel:?}");
    }
}

#[test]
fn anchored_beats_delayed_reflection_on_contact() {
    let mut identifier = Identifier::new(&settings()).unwrap();
    for k in 0..3000 {
        identifier.step(&sample(k, 1000.0));
    }
    let errors = identifier.report().horizon_error_n;
    assert!(errors[Mode::Anchored.index()] < 0.3 * errors[Mode::Dfr.index()], "{errors:?}");
    assert!(identifier.report().degrees.anchored >= 1);
    assert!(identifier.report().degrees.paper >= 1);
    assert!(identifier.report().rank >= 3);
}

#[test]
fn without_delay_reflection_and_anchored_are_the_measured_force() {
    let mut identifier = Identifier::new(&ImpedanceSettings { delay_s: 0.0, ..settings() }).unwrap();
    for k in 0..500 {
        let sample = sample(k, 1000.0);
        identifier.step(&sample);
        for mode in [Mode::Dfr, Mode::Anchored] {
            assert_eq!(identifier.report().prediction_n[mode.index()], sample.force_n);
        }
        let best_n = identifier.report().prediction_n[Mode::Best.index()];
        assert!(k < 2 || (best_n - sample.force_n).norm() < 1e-9, "the best of two is the exact one");
    }
}

#[test]
fn delay_is_exact_and_can_change() {
    let mut identifier = Identifier::new(&ImpedanceSettings { modes: ModeSet::only(Mode::Dfr), ..settings() }).unwrap();
    let mut delay = 30;
    for k in 0..4000_usize {
        if k == 1500 || k == 2700 {
            delay = if k == 1500 { 1000 } else { 7 };
            identifier.set_delay(delay as f64 * 1e-3);
        }
        identifier.step(&sample(k, 1000.0));
        let report = identifier.report();
        let expected = k.checked_sub(delay).map(|k| sample(k, 1000.0).force_n);
        assert_eq!(report.prediction_valid[Mode::Dfr.index()], expected.is_some());
        assert_eq!(report.prediction_n[Mode::Dfr.index()], expected.unwrap_or_default());
    }
}

#[test]
fn the_leader_renders_what_the_follower_predicted() {
    let settings = settings();
    let mut identifier = Identifier::new(&settings).unwrap();
    let mut renderer = Renderer::new(&settings).unwrap();
    let mut link = Vec::new();
    for k in 0..1500 {
        let sample = sample(k, 1000.0);
        identifier.step(&sample);
        link.push(*identifier.parcel());
        let parcel = k.checked_sub(30).map(|k| link[k]);
        let rendered = renderer.step(&sample.position_m, parcel.as_ref());
        assert_eq!(rendered.force_n, identifier.report().prediction_n, "tick {k}");
        assert_eq!(rendered.valid, identifier.report().prediction_valid, "tick {k}");
    }
}

/// The leader's motion is 20 ms ahead of the follower's, so the error of matched rendering is the resulting change of
/// force.
#[test]
fn the_best_of_two_is_judged_by_what_the_leader_rendered() {
    let settings = ImpedanceSettings { delay_s: 0.01, ..settings() };
    let mut identifier = Identifier::new(&settings).unwrap();
    let mut renderer = Renderer::new(&settings).unwrap();
    let mut link = Vec::new();
    let modes = [Mode::Anchored, Mode::Matched, Mode::Best];
    let mut here_n = [0.0; 3];
    let mut there_n = [0.0; 3];
    for k in 0..9000 {
        let truth = sample(k, 1000.0);
        identifier.step(&truth);
        link.push(*identifier.parcel());
        let rendered = renderer.step(&sample(k + 20, 1000.0).position_m, k.checked_sub(10).map(|k| &link[k]));
        // The softmin averages over one second of motion, so skip the first moments.
        if k >= 6000 {
            for (i, mode) in modes.into_iter().enumerate() {
                here_n[i] += (identifier.report().prediction(mode).unwrap() - truth.force_n).norm();
                there_n[i] += (rendered.force(mode).unwrap() - truth.force_n).norm();
            }
        }
    }
    assert!(there_n[1] > 2.0 * there_n[0], "matched is the worse one at this leader: {there_n:?}");
    assert!(there_n[2] < 1.02 * there_n[0], "{there_n:?}");
    assert!(here_n[2] < 1.02 * here_n[0].min(here_n[1]), "{here_n:?}");
}

#[test]
fn permuting_axes_permutes_results() {
    let mut plain = Identifier::new(&settings()).unwrap();
    let mut turned = Identifier::new(&settings()).unwrap();
    let turn = |v: Vector3<f64>| Vector3::new(v.y, v.z, v.x);
    for k in 0..800 {
        let s = sample(k, 1000.0);
        plain.step(&s);
        turned.step(&Sample { t_s: s.t_s, position_m: turn(s.position_m), force_n: turn(s.force_n) });
        let a = plain.solution().unwrap().coefficients(16);
        let b = turned.solution().unwrap().coefficients(16);
        for (a, b) in a.iter().zip(&b) {
            assert_eq!([a[1], a[2], a[0]], [b[0], b[1], b[2]]);
        }
        for degree in 1..=5 {
            let a = plain.literal().unwrap();
            let b = turned.literal().unwrap();
            for (a, b) in a.coefficients(degree).iter().zip(b.coefficients(degree)) {
                assert_eq!([a[1], a[2], a[0]], [b[0], b[1], b[2]]);
            }
        }
        // Norms over the axes are summed in a different order: they may differ by a rounding error.
        for (a, b) in plain.report().prediction_n.iter().zip(&turned.report().prediction_n) {
            assert!((turn(*a) - b).norm() <= 1e-9 * (1.0 + a.norm()), "tick {k}: {a} {b}");
        }
    }
}

#[test]
fn metres_and_millimetres_agree() {
    let metres = settings();
    let Scales { position_m, velocity_m_s, acceleration_m_s2, force_n } = metres.scales;
    let scales = Scales {
        position_m: 1e3 * position_m,
        velocity_m_s: 1e3 * velocity_m_s,
        acceleration_m_s2: 1e3 * acceleration_m_s2,
        force_n,
    };
    let mut a = Identifier::new(&metres).unwrap();
    let mut b = Identifier::new(&ImpedanceSettings { scales, ..metres }).unwrap();
    let mut worst = 0.0_f64;
    for k in 0..2000 {
        let s = sample(k, 1000.0);
        a.step(&s);
        b.step(&Sample { position_m: 1e3 * s.position_m, ..s });
        // Not literal: the paper's degree-5 normal equations square a condition number near 1e8 and depend on the unit.
        let literal = [&a, &b].map(|identifier| identifier.report().prediction_n[Mode::Literal.index()]);
        worst = worst.max((literal[0] - literal[1]).norm() / (1e-3 + literal[0].norm()));
        let all = [Mode::Linear, Mode::Dfr, Mode::Anchored, Mode::Matched, Mode::Nima, Mode::Best];
        for (mode, tolerance) in all.map(|mode| (mode, if mode == Mode::Dfr { 0.0 } else { 1e-9 })) {
            let a = a.report().prediction_n[mode.index()];
            let b = b.report().prediction_n[mode.index()];
            assert!((a - b).norm() <= tolerance * (1.0 + a.norm()), "{mode}, tick {k}: {a} {b}");
        }
    }
    eprintln!("literal: metres and millimetres differ by up to {worst:.1e} of the force");
}

#[test]
fn bad_samples_are_counted_and_leave_no_trace() {
    let mut clean = Identifier::new(&settings()).unwrap();
    let mut dirty = Identifier::new(&settings()).unwrap();
    let bad = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e18];
    let mut expected = 0;
    for k in 0..2000 {
        let good = sample(k, 1000.0);
        clean.step(&good);
        let mut s = good;
        let value = bad[k % bad.len()];
        match k % 97 {
            5 => s.position_m.y = value,
            23 => s.force_n.x = value,
            41 => s.t_s = value.min(0.0),
            60 => s.t_s = sample(k - 1, 1000.0).t_s,
            _ => {}
        }
        expected += u64::from(s != good);
        dirty.step(&s);
        assert_finite(dirty.report(), dirty.parcel());
    }
    assert_eq!(dirty.report().failures.samples, expected);
    assert_eq!(clean.report().failures.samples, 0);
    let error = |identifier: &Identifier| identifier.report().horizon_error_n[Mode::Anchored.index()];
    assert!(error(&dirty) < 3.0 * error(&clean) + 0.02, "{} {}", error(&dirty), error(&clean));
}

#[test]
fn standstill_renders_what_was_measured() {
    let mut identifier = Identifier::new(&settings()).unwrap();
    let still = Sample { t_s: 0.0, position_m: Vector3::new(0.01, -0.02, 0.03), force_n: Vector3::new(0.0, 1.4, 0.0) };
    for k in 0..3000 {
        identifier.step(&Sample { t_s: f64::from(k) * 1e-3, ..still });
        assert_finite(identifier.report(), identifier.parcel());
    }
    let report = identifier.report();
    assert_eq!(report.prediction_n[Mode::Dfr.index()], still.force_n);
    assert!((report.prediction_n[Mode::Anchored.index()] - still.force_n).norm() < 1e-9);
    assert_eq!(report.degrees.anchored, 0);
}

#[test]
fn one_axis_leaves_the_others_alone() {
    let mut identifier = Identifier::new(&ImpedanceSettings { axes: 1, ..settings() }).unwrap();
    for k in 0..1000 {
        let mut s = sample(k, 1000.0);
        s.position_m.y = f64::NAN;
        s.force_n.z = f64::INFINITY;
        identifier.step(&s);
        assert_finite(identifier.report(), identifier.parcel());
    }
    assert_eq!(identifier.report().failures.samples, 0);
    assert!(identifier.report().degrees.paper >= 1);
    let [_, y, z, spare] = identifier.solution().unwrap().coefficients(16).map(|m| m.0)[3];
    assert_eq!([y, z, spare], [0.0; 3]);
}

#[test]
fn reset_forgets_everything() {
    let mut used = Identifier::new(&settings()).unwrap();
    let mut fresh = used.clone();
    for k in 0..777 {
        used.step(&sample(k + 5000, 1000.0));
    }
    used.reset();
    for k in 0..777 {
        used.step(&sample(k, 1000.0));
        fresh.step(&sample(k, 1000.0));
        assert_eq!(used.report(), fresh.report(), "tick {k}");
        assert_eq!(used.parcel(), fresh.parcel(), "tick {k}");
    }
}

#[test]
fn every_rate_and_amplitude_stays_finite() {
    for rate_hz in [20.0_f64, 66.0, 1000.0, 10_000.0] {
        for amplitude in [1e-6, 1e-3, 0.2, 50.0] {
            let window_s = (12.0 / rate_hz).max(0.02);
            let settings = ImpedanceSettings { rate_hz, window_s, ..ImpedanceSettings::default() };
            let mut identifier = Identifier::new(&settings).unwrap();
            for k in 0..1500 {
                let mut s = sample(k, rate_hz);
                s.position_m *= amplitude / 0.02;
                identifier.step(&s);
                assert_finite(identifier.report(), identifier.parcel());
            }
        }
    }
}

#[test]
fn nothing_that_comes_in_makes_a_number_that_is_not_finite() {
    let settings = ImpedanceSettings { cross_talk: true, ..settings() };
    let mut identifier = Identifier::new(&settings).unwrap();
    let mut renderer = Renderer::new(&settings).unwrap();
    let mut state = 1_u64;
    let mut random = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    // Segments of ordinary motion, of constant values, and of values of any magnitude.
    let mut still = sample(0, 1000.0);
    for k in 0..30_000 {
        let mut s = sample(k, 1000.0);
        match (k / 700) % 4 {
            1 => s = Sample { t_s: s.t_s, ..still },
            2 => {
                let mut any = || (random() - 0.5) * 10.0_f64.powf(640.0 * random() - 320.0);
                s.position_m = Vector3::from_fn(|_, _| any());
                s.force_n = Vector3::from_fn(|_, _| any());
            }
            3 => s.force_n *= 10.0_f64.powf(f64::from((k % 40) as u32) - 20.0),
            _ => still = s,
        }
        identifier.step(&s);
        assert_finite(identifier.report(), identifier.parcel());
        let rendered = renderer.step(&s.position_m, Some(identifier.parcel()));
        assert!(rendered.force_n.iter().all(|force| force.iter().all(|f| f.is_finite())), "tick {k}");
        let bound = 1e4 * settings.scales.force_n * 2.0;
        assert!(rendered.force_n[Mode::Anchored.index()].norm() <= bound, "tick {k}");
    }
    assert_eq!(identifier.report().failures.restarts, 0);
}

#[test]
fn settings_out_of_range_are_refused_with_one_line() {
    let good = ImpedanceSettings::default;
    let bad = [
        ImpedanceSettings { rate_hz: 10.0, ..good() },
        ImpedanceSettings { rate_hz: f64::NAN, ..good() },
        ImpedanceSettings { window_s: 0.001, ..good() },
        ImpedanceSettings { delay_s: 1.5, ..good() },
        ImpedanceSettings { delay_s: f64::NAN, ..good() },
        ImpedanceSettings { max_degree: 6, ..good() },
        ImpedanceSettings { axes: 0, ..good() },
        ImpedanceSettings { scales: Scales { position_m: 0.0, ..Scales::default() }, ..good() },
        ImpedanceSettings { ridge: -1.0, ..good() },
    ];
    for settings in bad {
        let error = Identifier::new(&settings).unwrap_err();
        assert_eq!(Renderer::new(&settings).unwrap_err().to_string(), error.to_string());
        assert!(!error.to_string().contains('\n'));
    }
}
