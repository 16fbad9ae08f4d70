use nalgebra::Vector3;
use nima_core::impedance::{HuntCrossleyContact, Identifier, Mode, Renderer, Sample, Wave};
use proptest::prelude::*;

use super::{passivity::PassivityController, *};

const RATE_HZ: f64 = 1000.0;

fn motion(x: f64, v: f64) -> Motion {
    Motion { x: Lanes([x, 0.0, 0.0, 0.0]), v: Lanes([v, 0.0, 0.0, 0.0]), a: Lanes::ZERO }
}

fn force(n: f64) -> Lanes {
    Lanes([n, 0.0, 0.0, 0.0])
}

fn forecast(model: &BaselineModel) -> f64 {
    let BaselineModel::Forecast { force_n } = model else { panic!("{model:?}") };
    force_n[0]
}

fn contact(model: &BaselineModel) -> HuntCrossleyContact {
    let BaselineModel::Contact(contact) = *model else { panic!("{model:?}") };
    contact
}

fn wave(model: &BaselineModel) -> Wave {
    let BaselineModel::Wave(wave) = *model else { panic!("{model:?}") };
    wave
}

#[test]
fn the_contact_of_hunt_and_crossley_is_found() {
    // Pressed 10 mm deep and released above the surface, for 6 s.
    let path = |t: f64| (0.004 + 0.006 * (5.0 * t).sin(), 0.03 * (5.0 * t).cos());
    let tissue = |x: f64, v: f64| if x > 0.0 { -2000.0 * x.powf(1.5) * (1.0 + 2.0 * v) } else { 0.0 };
    let mut follower = ModelMediated::new(RATE_HZ, 0);
    let mut worst_n = 0.0_f64;
    for k in 0..6000 {
        let (x, v) = path(f64::from(k) * 1e-3);
        let contact = contact(&follower.step(&motion(x, v), Some(force(tissue(x, v)))));
        if k > 4000 {
            // Evaluate anywhere in the range, not only where the follower is.
            let (x, v) = path(f64::from(k) * 0.77e-3);
            worst_n = worst_n.max((model_mediated::force(&contact, &motion(x, v))[0] - tissue(x, v)).abs());
        }
    }
    assert!(worst_n < 0.1 * 2.0, "{worst_n} N of 2 N");
    let exponent = contact(&follower.step(&motion(0.0, 0.0), None)).exponent[0];
    assert!((exponent - 1.5).abs() < 0.1, "{exponent}");
}

#[test]
fn kalman_follows_a_ramp_and_extrapolates_it_as_far_as_a_rate_lasts() {
    let mut kalman = Kalman::new(RATE_HZ, 50);
    let mut model = BaselineModel::Nothing;
    assert_eq!(kalman.step(&motion(0.0, 0.0), None), model, "nothing before the first force");
    for k in 0..2000 {
        model = kalman.step(&motion(0.0, 0.0), Some(force(3.0 * f64::from(k) * 1e-3)));
    }
    let BaselineModel::Trend { force_n, rate_n_s } = model else { panic!("{model:?}") };
    assert!((force_n[0] - 3.0 * 1.999).abs() < 0.03 && (1.0..3.0).contains(&rate_n_s[0]), "{model:?}");
    let tuning = KalmanTuning::of(0.05, false);
    let ahead = |age_s: f64| (tuning.extrapolated(force_n, rate_n_s, age_s) - force_n)[0];
    assert!(ahead(0.0).abs() < 1e-12 && (ahead(1e-4) - 1e-4 * rate_n_s[0]).abs() < 0.02 * 1e-4 * rate_n_s[0]);
    assert!(ahead(0.01) > 1.5 * ahead(0.003) && ahead(1.0) < 1.2 * ahead(0.01), "a rate does not last for ever");
}

#[test]
fn kalman_is_tuned_to_the_delay_and_only_the_newest_journal_knows_it() {
    let led = |delay: usize, earlier: bool| {
        let kalman = Kalman::new(RATE_HZ, delay);
        let mut kalman = if earlier { kalman.earlier() } else { kalman };
        let mut model = BaselineModel::Nothing;
        for k in 0..3000 {
            model = kalman.step(&motion(0.0, 0.0), Some(force((8.0 * f64::from(k) * 1e-3).sin())));
        }
        let BaselineModel::Trend { force_n, .. } = model else { panic!("{model:?}") };
        force_n[0]
    };
    let newest_n = (8.0_f64 * 2.999).sin();
    for delay in [5, 50, 100, 300] {
        assert!((led(delay, true) - newest_n).abs() < 0.02, "{delay} ms, earlier: near the newest force");
    }
    assert!((led(300, false) - newest_n).abs() > 0.1, "a long delay is predicted from the last periods");
}

#[test]
fn increments_predict_a_damped_spring_and_a_force_that_grows() {
    const DELAY: usize = 50;
    let mut follower = Increments::new(RATE_HZ, DELAY);
    let own = |k: usize| {
        let t_s = k as f64 * 1e-3;
        motion(0.01 * (7.0 * t_s).sin(), 0.07 * (7.0 * t_s).cos())
    };
    // The trend is not explained by motion, and holding errs by it and by the spring.
    let force_n = |k: usize| (own(k).x * -300.0 - own(k).v * 4.0) + force(5.0 + 0.8 * k as f64 * 1e-3);
    let mut sent = Vec::new();
    let mut worst_n = 0.0_f64;
    for k in 0..4000 {
        let BaselineModel::Increments(increments) = follower.step(&own(k), Some(force_n(k))) else { panic!("{k}") };
        sent.push(increments);
        let Some(then) = k.checked_sub(DELAY) else { continue };
        let rendered = increments::force(&sent[then], force_n(then), &own(then), &own(k));
        if k > 2000 {
            worst_n = worst_n.max((rendered - force_n(k))[0].abs());
        }
    }
    assert!(worst_n < 0.2, "{worst_n} N, where holding errs by up to 1 N");
}

#[test]
fn an_autoregressive_model_predicts_an_oscillation() {
    let mut follower = Autoregressive::new(RATE_HZ, 100);
    let wave = |k: i32| 1.0 + (9.0 * f64::from(k) * 1e-3).sin();
    let mut worst_n = 0.0_f64;
    for k in 0..6000 {
        let model = follower.step(&motion(0.0, 0.0), Some(force(wave(k))));
        assert!(k > 50 || (forecast(&model) - wave(k)).abs() < 1e-12, "reflection before anything is learnt");
        if k > 3000 {
            worst_n = worst_n.max((forecast(&model) - wave(k + 100)).abs());
        }
    }
    assert!(worst_n < 0.1, "{worst_n} N, where holding errs by up to 0.87 N");
}

#[test]
fn a_wave_is_decoded_to_the_force_and_the_change_of_speed() {
    let mut waves = Waves::new(RATE_HZ, 0);
    let mut back = wave(&waves.step(&motion(0.0, 0.0), Some(force(0.7))));
    assert!((waves::decoded(&back, &motion(0.0, 0.0))[0] - 0.7).abs() < 1e-9, "no motion: the unmodified force");
    for k in 0..1000 {
        let t = f64::from(k) * 1e-3;
        back = wave(&waves.step(&motion(0.0, 0.1 * (7.0 * t).sin()), Some(force(2.0 * (7.0 * t).sin()))));
    }
    let v = 0.1 * (7.0 * 0.999_f64).sin();
    let f = 2.0 * (7.0 * 0.999_f64).sin();
    let b = back.impedance_n_s_m[0];
    assert!(b > 0.1, "{b}");
    assert!((waves::decoded(&back, &motion(0.0, v))[0] - f).abs() < 1e-9);
    assert!((waves::decoded(&back, &motion(0.0, v + 0.02))[0] - (f - 0.02 * b)).abs() < 1e-9);
}

/// Presses a spring of 500 N/m behind a link of `delay` ticks 8 mm deep twice per second for 4 s. Returns the energy
/// given to the hand (without the hand's own work) and the energy that the tissue returned, J.
fn cycled(delay: usize, controlled: bool) -> [f64; 2] {
    let mut follower = ReturnedEnergy::new(RATE_HZ, 0);
    let mut controller = PassivityController::new(RATE_HZ);
    let mut sent = Vec::new();
    let mut got_j = 0.0;
    for k in 0..4000 {
        let angle = std::f64::consts::TAU * 2e-3 * f64::from(k);
        let own = motion(0.004 * (1.0 - angle.cos()), 0.004 * std::f64::consts::TAU * 2.0 * angle.sin());
        let force_n = own.x * -500.0;
        let BaselineModel::Returned { energy_j } = follower.step(&own, Some(force_n)) else { panic!("no energy") };
        sent.push((force_n, energy_j));
        let Some((force_n, came_j)) = sent.len().checked_sub(delay + 1).map(|k| sent[k]) else { continue };
        let rendered = if controlled { controller.step(force_n, came_j, &own) } else { force_n };
        got_j += (rendered * own.v)[0].max(0.0) * 1e-3;
    }
    [got_j, sent.last().map_or(0.0, |(_, energy_j)| energy_j[0])]
}

#[test]
fn passivity_takes_the_energy_that_a_delay_makes() {
    let [free_j, returned_j] = cycled(60, false);
    assert!(free_j > returned_j + 0.01, "a delayed spring gives more than it has: {free_j} J of {returned_j} J");
    let [held_j, _] = cycled(60, true);
    assert!(held_j <= returned_j && held_j > 0.8 * returned_j, "{held_j} J of {returned_j} J");
    let [undelayed_j, _] = cycled(0, true);
    assert!(
        (undelayed_j - returned_j).abs() < 1e-9,
        "nothing is taken without delay: {undelayed_j} J of {returned_j} J"
    );
}

#[test]
fn the_controller_only_ever_takes() {
    let mut controller = PassivityController::new(RATE_HZ);
    let mut taken = 0;
    for k in 0..5000 {
        let t = f64::from(k) * 1e-3;
        let f = (11.0 * t).sin();
        let v = 0.1 * (7.0 * t).cos();
        let given = controller.step(Lanes::splat(f), Lanes::splat(1e-3 * t), &motion(0.0, v))[0];
        assert!(given.abs() <= f.abs() + 1e-12 && given * f >= -1e-12, "{f} N became {given} N");
        taken += i32::from(given.abs() < 0.9 * f.abs());
    }
    assert!(taken > 1000, "{taken}");
}

fn settings(mode: Mode) -> ImpedanceSettings {
    provide();
    ImpedanceSettings { window_s: 0.1, delay_s: 0.03, modes: ModeSet::only(mode), ..ImpedanceSettings::default() }
}

fn sample(k: usize) -> Sample {
    let t = k as f64 * 1e-3;
    let x = Vector3::new((7.0 * t).sin(), (5.0 * t).cos(), (3.0 * t).sin()) * 0.01;
    Sample { t_s: t, position_m: x, force_n: x.map(|x| if x > 0.0 { -300.0 * x } else { 0.05 }) }
}

#[test]
fn only_the_baseline_that_is_asked_for_is_computed() {
    let mut own = Identifier::new(&ImpedanceSettings { modes: ModeSet::ALL, ..settings(Mode::Dfr) }).unwrap();
    own.step(&sample(0));
    assert_eq!(own.parcel().models.baseline, BaselineModel::Nothing);
    assert_eq!(ModeSet::ALL.baseline(), None);
    let both = ModeSet::only(Mode::Baseline(Baseline::Waves)).with(Mode::Baseline(Baseline::Kalman));
    assert!(both.contains(Mode::Baseline(Baseline::Kalman)) && !both.contains(Mode::Baseline(Baseline::Waves)));
    assert_eq!(both.modes().collect::<Vec<_>>(), [Mode::Dfr, Mode::Baseline(Baseline::Kalman)]);
}

#[test]
fn the_leader_renders_what_the_follower_predicted() {
    for mode in Mode::BASELINES {
        let settings = settings(mode);
        let mut follower = Identifier::new(&settings).unwrap();
        let mut leader = Renderer::new(&settings).unwrap();
        let mut link = Vec::new();
        for k in 0..2000 {
            let sample = sample(k);
            follower.step(&sample);
            link.push(*follower.parcel());
            let rendered = leader.step(&sample.position_m, k.checked_sub(30).map(|k| &link[k]));
            assert_eq!(rendered.force(mode), follower.report().prediction(mode), "{mode}, tick {k}");
            assert_eq!(rendered.force(mode).is_some(), k >= 30, "{mode}: a force from the first packet on");
        }
    }
}

#[test]
fn the_prediction_knows_nothing_of_the_last_delay() {
    // Every force after t - D is replaced; the force rendered at t must not change by a bit.
    for mode in Mode::BASELINES {
        let settings = settings(mode);
        let mut seen = Identifier::new(&settings).unwrap();
        for k in 0..1000 {
            seen.step(&sample(k));
        }
        let mut blind = Identifier::new(&settings).unwrap();
        for k in 0..1000 {
            let known = k < 1000 - 30;
            let sample = sample(k);
            blind.step(&if known { sample } else { Sample { force_n: Vector3::repeat(1.7), ..sample } });
        }
        assert_eq!(seen.report().prediction(mode), blind.report().prediction(mode), "{mode}");
    }
}

#[test]
fn reset_forgets_everything() {
    for mode in Mode::BASELINES {
        let mut used = Identifier::new(&settings(mode)).unwrap();
        let mut fresh = used.clone();
        (0..777).for_each(|k| used.step(&sample(k + 5000)));
        used.reset();
        for k in 0..500 {
            used.step(&sample(k));
            fresh.step(&sample(k));
            assert_eq!(used.parcel(), fresh.parcel(), "{mode}, tick {k}");
            assert_eq!(used.report().prediction_n, fresh.report().prediction_n, "{mode}, tick {k}");
        }
    }
}

#[test]
fn metres_and_millimetres_agree() {
    for mode in Mode::BASELINES {
        let metres = settings(mode);
        let mut scales = metres.scales;
        scales.position_m *= 1e3;
        scales.velocity_m_s *= 1e3;
        scales.acceleration_m_s2 *= 1e3;
        let mut a = Identifier::new(&metres).unwrap();
        let mut b = Identifier::new(&ImpedanceSettings { scales, ..metres }).unwrap();
        for k in 0..1500 {
            let s = sample(k);
            a.step(&s);
            b.step(&Sample { position_m: 1e3 * s.position_m, ..s });
            let [a, b] = [&a, &b].map(|identifier| identifier.report().prediction(mode).unwrap_or_default());
            assert!((a - b).norm() <= 1e-6 * (1.0 + a.norm()), "{mode}, tick {k}: {a} {b}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    #[test]
    fn nothing_that_comes_in_makes_a_number_that_is_not_finite(
        which in 0..Baseline::ALL.len(),
        ticks in prop::collection::vec(
            (prop::array::uniform3(any_number(0.05)), prop::array::uniform3(any_number(5.0)), 0_u8..30),
            1..400,
        ),
    ) {
        let mode = Mode::BASELINES[which];
        let settings = settings(mode);
        let mut follower = Identifier::new(&settings).unwrap();
        let mut leader = Renderer::new(&settings).unwrap();
        for (k, (position, force, delay)) in ticks.into_iter().enumerate() {
            if delay == 0 {
                follower.set_delay(k as f64 * 1e-3);
                leader.set_delay(k as f64 * 1e-3);
            }
            let position_m = Vector3::from(position);
            follower.step(&Sample { t_s: k as f64 * 1e-3, position_m, force_n: Vector3::from(force) });
            // Received data are not trusted either.
            let forged = LinkPacket { force_n: Vector3::from(force), ..*follower.parcel() };
            for parcel in [follower.parcel(), &forged] {
                let rendered = leader.step(&position_m, Some(parcel));
                prop_assert!(rendered.force_n.iter().flatten().all(|f| f.is_finite()), "{mode} {rendered:?}");
            }
            prop_assert!(follower.report().prediction_n.iter().flatten().all(|f| f.is_finite()));
            prop_assert!(follower.report().horizon_error_n.iter().all(|e| e.is_finite()));
        }
    }
}

/// Returns mostly ordinary numbers, sometimes NaN, infinities, 1e300 or zero.
fn any_number(usual: f64) -> impl Strategy<Value = f64> {
    prop_oneof![
        8 => -usual..usual,
        1 => prop_oneof![Just(0.0), Just(f64::NAN), Just(f64::INFINITY), Just(f64::NEG_INFINITY), Just(1e300), Just(-1e18)],
        1 => prop::num::f64::ANY,
    ]
}
