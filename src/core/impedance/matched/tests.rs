//! Properties of matched rendering: only parameters cross the link, nothing is forgotten at rest, the force stays
//! finite with any input.

use std::f64::consts::TAU;

use nalgebra::Vector3;

use super::{super::track::MotionTrack, slip::Slip, *};

const FORMS: [ModelForm; 4] = [ModelForm::Tissue, ModelForm::Sliding, ModelForm::Coupled, ModelForm::Paper(5)];
const MATCHED: [ModelForm; 3] = [ModelForm::Tissue, ModelForm::Sliding, ModelForm::Coupled];

/// Both ends with a link of `delay` ticks between them; the leader's own motion is an argument.
struct Pair {
    follower_track: MotionTrack,
    follower: Learner,
    leader_track: MotionTrack,
    leader_slip: Slip,
    link: Vec<MatchedModel>,
    delay: usize,
}

impl Pair {
    fn new(form: ModelForm, settings: &ImpedanceSettings) -> Self {
        let delay = settings.delay_ticks(settings.delay_s);
        Self {
            follower_track: MotionTrack::new(settings),
            follower: Learner::new(form, settings, delay),
            leader_track: MotionTrack::new(settings),
            leader_slip: Slip::default(),
            link: Vec::new(),
            delay,
        }
    }

    /// Runs one tick of the follower; returns the model that it sends.
    fn follower(&mut self, tip_m: Vector3<f64>, force_n: Option<Vector3<f64>>) -> MatchedModel {
        let posture = self.follower_track.step(Some(tip_m.into()));
        let sent = self.link.len().checked_sub(self.delay.max(1)).map(|then| self.link[then]);
        let model = *self.follower.step(&posture, force_n.map(Lanes::from), sent.as_ref());
        self.link.push(model);
        model
    }

    /// Runs one tick of the leader, after the follower's; returns the force for the hand.
    fn leader(&mut self, hand_m: Vector3<f64>) -> Option<Vector3<f64>> {
        let Some(arrived) = self.link.len().checked_sub(self.delay + 1) else {
            self.leader_track.step(Some(hand_m.into()));
            return None;
        };
        self.leader_with(&self.link[arrived].clone(), hand_m)
    }

    /// Runs one tick of the leader with a received model.
    fn leader_with(&mut self, model: &MatchedModel, hand_m: Vector3<f64>) -> Option<Vector3<f64>> {
        let now = self.leader_track.step(Some(hand_m.into()));
        model.force(&now, &mut self.leader_slip).map(Lanes::vector)
    }

    /// Runs both ends with the same motion.
    fn step(&mut self, position_m: Vector3<f64>, force_n: Vector3<f64>) -> Option<Vector3<f64>> {
        self.follower(position_m, Some(force_n));
        self.leader(position_m)
    }
}

fn settings(delay_s: f64) -> ImpedanceSettings {
    ImpedanceSettings { delay_s, ..ImpedanceSettings::default() }
}

/// Returns the position (m) of a hand that presses, slides and lifts.
fn hand_m(t_s: f64) -> Vector3<f64> {
    Vector3::new(
        0.004 * (TAU * 0.7 * t_s).sin() + 0.0004 * (TAU * 8.3 * t_s).sin(),
        0.003 * (TAU * 0.9 * t_s + 0.4).sin(),
        0.005 * (TAU * 0.8 * t_s).cos() + 0.0003 * (TAU * 9.7 * t_s).sin(),
    )
}

/// Returns the contact below the surface z = 0 and a little drag, N.
fn contact_n(position_m: Vector3<f64>) -> Vector3<f64> {
    let depth_m = (-position_m.z).max(0.0);
    Vector3::new(-20.0 * position_m.x, -15.0 * position_m.y, 500.0 * depth_m + 2e4 * depth_m * depth_m)
}

#[test]
fn the_force_is_made_of_what_was_known_one_delay_ago_and_of_the_own_motion() {
    for form in FORMS {
        let [mut clean, mut corrupt] = [(); 2].map(|()| Pair::new(form, &settings(0.1)));
        let changed = 1500_u32;
        let horizon = 100;
        for k in 0..changed + horizon {
            let position_m = hand_m(f64::from(k) * 1e-3);
            let noise = Vector3::new(7.0, -3.0, 11.0) * f64::from((k * 7919) % 101);
            clean.follower(position_m, Some(contact_n(position_m)));
            // From here on the follower's motion and force are entirely different; the leader's hand is unaffected.
            let (tip_m, force_n) = if k < changed {
                (position_m, contact_n(position_m))
            } else {
                (position_m + 0.01 * noise, contact_n(position_m) + noise)
            };
            corrupt.follower(tip_m, Some(force_n));
            assert_eq!(clean.leader(position_m), corrupt.leader(position_m), "{form:?}, tick {k}");
        }
        let position_m = hand_m(f64::from(changed + horizon) * 1e-3);
        let [clean, corrupt] = [&mut clean, &mut corrupt].map(|pair| {
            pair.follower(position_m, Some(contact_n(position_m)));
            pair.leader(position_m)
        });
        assert_ne!(clean, corrupt, "{form:?}: the corrupt samples arrive in the end");
    }
}

#[test]
fn a_hand_that_leaves_when_the_link_fails_leaves_the_force_behind() {
    for form in MATCHED {
        for (delay_s, speed_m_s) in [(0.05, 0.1), (0.05, 0.3), (0.1, 0.1), (0.1, 0.2), (0.3, 0.1), (0.3, 0.3)] {
            let mut pair = Pair::new(form, &settings(delay_s));
            // Palpation of a spring, at its deepest when the last packet is sent.
            let pressed = |k: i32| Vector3::new(0.0, 0.0, -0.0025 * (1.0 - (TAU * 1e-3 * f64::from(k)).cos()));
            let spring_n = |position_m: Vector3<f64>| Vector3::new(0.0, 0.0, (-600.0 * position_m.z).max(0.0));
            for k in 0..5500 {
                pair.step(pressed(k), spring_n(pressed(k)));
            }
            let last = pair.link[pair.link.len() - 1 - pair.delay];
            let mut position_m = pressed(5500);
            let before_n = pair.leader_with(&last, position_m).unwrap().norm();
            for _ in 0..pair.delay {
                position_m.z += speed_m_s * 1e-3;
                assert!(pair.leader_with(&last, position_m).is_some());
                if position_m.z > 0.03 {
                    break;
                }
            }
            let left_n = pair.leader_with(&last, position_m).unwrap().norm();
            let gone = -position_m.z <= 0.0;
            assert!(before_n > 2.0, "{before_n} N");
            assert!(
                !gone || left_n <= 0.15 * before_n,
                "{form:?}, {delay_s} s, {speed_m_s} m/s: {left_n} of {before_n} N"
            );
        }
    }
}

#[test]
fn nothing_is_forgotten_while_the_hand_stands_still() {
    const STIFFNESS_N_M: f64 = 600.0;
    for form in MATCHED {
        let mut pair = Pair::new(form, &settings(0.05));
        let spring_n = |position_m: Vector3<f64>| position_m * -STIFFNESS_N_M;
        let mut position_m = Vector3::zeros();
        for k in 0..4000 {
            position_m = hand_m(f64::from(k) * 1e-3);
            pair.step(position_m, spring_n(position_m));
        }
        for _ in 0..60_000 {
            pair.step(position_m, spring_n(position_m));
            pair.link.drain(..pair.link.len().saturating_sub(200));
        }
        // From here only the leader moves: it must render the stiffness that was learned a minute ago.
        let model = *pair.link.last().unwrap();
        let mut force_n = |position_m: Vector3<f64>| pair.leader_with(&model, position_m).unwrap();
        let rest_n = force_n(position_m);
        for _ in 0..2000 {
            force_n(position_m - position_m * 0.2);
        }
        let change_n = force_n(position_m - position_m * 0.2) - rest_n;
        let expected_n = position_m * (0.2 * STIFFNESS_N_M);
        assert!((change_n - expected_n).norm() < 0.1 * expected_n.norm(), "{form:?}: {change_n} for {expected_n}");
    }
}

#[test]
fn metres_and_newtons_give_the_same_force_as_millimetres_and_millinewtons() {
    let metres = settings(0.05);
    let mut millimetres = metres.clone();
    for scale in [
        &mut millimetres.scales.position_m,
        &mut millimetres.scales.velocity_m_s,
        &mut millimetres.scales.acceleration_m_s2,
    ] {
        *scale *= 1e3;
    }
    for form in FORMS {
        let mut a = Pair::new(form, &metres);
        let mut b = Pair::new(form, &millimetres);
        for k in 0..4000 {
            let position_m = hand_m(f64::from(k) * 1e-3);
            let force_n = contact_n(position_m);
            if let (Some(a), Some(b)) =
                (a.step(position_m, force_n), b.step(position_m * 1e3, force_n * 1e3).map(|f| f * 1e-3))
            {
                assert!((a - b).norm() <= 1e-9 * (1.0 + a.norm()), "{form:?}, tick {k}: {a} {b}");
            }
        }
    }
}

#[test]
fn whatever_comes_in_the_force_is_finite_and_within_the_range_seen() {
    let mut random = fastrand::Rng::with_seed(7);
    for form in FORMS {
        let mut pair = Pair::new(form, &settings(0.05));
        for k in 0..40_000_u32 {
            let mut any = |exponent: f64| (random.f64() - 0.5) * 10.0_f64.powf(exponent * (random.f64() - 0.5));
            let (position_m, force_n) = match (k / 1000) % 8 {
                0 | 4 => {
                    let position_m = hand_m(f64::from(k) * 1e-3);
                    (position_m, Some(contact_n(position_m)))
                }
                1 => (Vector3::zeros(), Some(Vector3::zeros())),
                2 => (Vector3::new(0.01, 0.0, -0.02), Some(Vector3::new(1.0, 0.0, 3.0))),
                3 => (Vector3::from_fn(|_, _| any(5.0).clamp(-1e3, 1e3)), Some(Vector3::from_fn(|_, _| any(8.0)))),
                5 => (Vector3::from_fn(|_, _| any(300.0).clamp(-1e3, 1e3)), None),
                6 => (Vector3::from_fn(|_, _| any(40.0) * 1e-30), Some(Vector3::from_fn(|_, _| any(40.0) * 1e-30))),
                _ => (Vector3::from_fn(|_, _| any(1.0) * 1e3), Some(Vector3::from_fn(|_, _| any(1.0) * 4e4))),
            };
            let model = pair.follower(position_m, force_n);
            assert!(model.parameters.iter().all(|p| p.is_finite()), "{form:?}, tick {k}");
            if let Some(force_n) = pair.leader(position_m) {
                assert!(force_n.iter().all(|f| f.abs() <= 1e5), "{form:?}, tick {k}: {force_n}");
            } else {
                assert!(k < 50, "{form:?}, tick {k}: no force");
            }
            pair.link.drain(..pair.link.len().saturating_sub(100));
        }
    }
}

#[test]
fn a_long_run_leaves_it_as_it_was() {
    // A whole number of periods of the motion, and of renewals of the fit.
    const PERIOD: u32 = 70_000;
    let mut pair = Pair::new(ModelForm::Tissue, &settings(0.02));
    let mut error_n = [0.0, 0.0];
    for k in 0..6 * PERIOD {
        let position_m = hand_m(f64::from(k % PERIOD) * 1e-3);
        let rendered_n = pair.step(position_m, contact_n(position_m));
        pair.link.drain(..pair.link.len().saturating_sub(30));
        let error = |sum: &mut f64| *sum += rendered_n.map_or(0.0, |f| (f - contact_n(position_m)).norm());
        match k / PERIOD {
            1 => error(&mut error_n[0]),
            5 => error(&mut error_n[1]),
            _ => {}
        }
    }
    assert!((error_n[1] / error_n[0] - 1.0).abs() < 1e-6, "{error_n:?}");
}

/// A tip that presses into a soft plane, drags along it and lifts off, with Coulomb friction in proportion to the load
/// (N).
struct Rubbing {
    held_m: Vector3<f64>,
    last_m: Vector3<f64>,
}

impl Rubbing {
    fn step(&mut self, position_m: Vector3<f64>) -> Vector3<f64> {
        let load_n = 800.0 * (-position_m.z).max(0.0);
        let travel_m = std::mem::replace(&mut self.last_m, position_m);
        let stretched_m = self.held_m + Vector3::new(position_m.x - travel_m.x, position_m.y - travel_m.y, 0.0);
        self.held_m = stretched_m.cap_magnitude(0.3 * load_n / 400.0);
        Vector3::new(0.0, 0.0, load_n) - self.held_m * 400.0
    }
}

#[test]
fn friction_is_known_from_the_force_along_the_other_axes() {
    let error_n = |form: ModelForm| {
        let mut pair = Pair::new(form, &settings(0.1));
        let mut rubbing = Rubbing { held_m: Vector3::zeros(), last_m: Vector3::zeros() };
        let mut sum_n = 0.0;
        for k in 0..12_000 {
            let position_m = hand_m(f64::from(k) * 1e-3);
            let force_n = rubbing.step(position_m);
            let rendered_n = pair.step(position_m, force_n).unwrap_or_default();
            sum_n += if k < 4000 { 0.0 } else { (rendered_n - force_n).xy().norm() };
        }
        sum_n / 8000.0
    };
    let [blind_n, sliding_n] = [ModelForm::Tissue, ModelForm::Sliding].map(error_n);
    assert!(sliding_n < 0.4 * blind_n, "{sliding_n} N with slip columns, {blind_n} N without");
}

/// Returns the mean error (N) from 1 s to 3 s after the stiffness of the tissue grew to ten times its value.
fn error_on_stiffer_tissue_n(settings: &ImpedanceSettings, soft_s: f64) -> f64 {
    let mut pair = Pair::new(ModelForm::Tissue, settings);
    let mut sum_n = 0.0;
    for k in 0..=((soft_s + 3.0) * settings.rate_hz) as u32 {
        let t_s = f64::from(k) / settings.rate_hz;
        let at_m = hand_m(t_s);
        let stiffness_n_m = if t_s < soft_s { 100.0 } else { 1000.0 };
        let force_n = Vector3::new(0.0, 0.0, -stiffness_n_m * at_m.z.min(0.0));
        let said_n = pair.step(at_m, force_n).unwrap_or_default();
        sum_n += if t_s > soft_s + 1.0 { (said_n - force_n).norm() } else { 0.0 };
    }
    sum_n / (2.0 * settings.rate_hz)
}

#[test]
fn another_tissue_is_learnt_as_fast_as_the_first_one() {
    let settings = settings(0.05);
    let cold_n = error_on_stiffer_tissue_n(&settings, 0.0);
    let changed_n = error_on_stiffer_tissue_n(&settings, 6.0);
    let before_n = error_on_stiffer_tissue_n(&ImpedanceSettings { earlier_forces: true, ..settings.clone() }, 6.0);
    println!("cold {cold_n} N, after a change {changed_n} N, without detecting it {before_n} N");
    assert!(changed_n < 1.3 * cold_n, "{changed_n} N, {cold_n} N without the soft tissue before");
    assert!(before_n > 1.5 * changed_n, "{before_n} N without detecting the change");
}
