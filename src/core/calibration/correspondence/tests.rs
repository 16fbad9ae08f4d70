//! Seeded trials: good sets, degenerate sets, and every mistake that is recognised.

use nalgebra::{UnitQuaternion, Vector3};

use super::*;
use crate::{calibration::Verdict, frames::from_roll_pitch_yaw_deg, noise::Noise};

/// Noise of one reading per axis, N.
const READING_N: f64 = 0.05;
/// A push is the mean of this many readings (0.1 s at 1 kHz).
const READINGS: f64 = 100.0;

struct Rig {
    noise: Noise,
    c_from_s2: UnitQuaternion<f64>,
    deviation_n: f64,
    chain: bool,
}

impl Rig {
    fn new(seed: u64, deviation_n: f64, chain: bool) -> Self {
        let mut noise = Noise::new(seed);
        let c_from_s2 = rotation(&mut noise);
        Self { noise, c_from_s2, deviation_n, chain }
    }

    fn direction(&mut self) -> Vector3<f64> {
        vector(&mut self.noise).normalize()
    }

    fn strength_n(&mut self) -> f64 {
        1.0 + 3.0 * self.noise.uniform()
    }

    fn push(&mut self, f2_n: Vector3<f64>) -> PushPair {
        let s1_from_c = if self.chain { rotation(&mut self.noise) } else { UnitQuaternion::identity() };
        let f1_n = s1_from_c * (self.c_from_s2 * f2_n) + vector(&mut self.noise) * self.deviation_n;
        PushPair { f1_n, f2_n: f2_n + vector(&mut self.noise) * self.deviation_n, s1_from_c }
    }

    fn pushes(&mut self, count: usize) -> Vec<PushPair> {
        let mut one = || {
            let f2_n = self.direction() * self.strength_n();
            self.push(f2_n)
        };
        (0..count).map(|_| one()).collect()
    }

    fn error_deg(&self, report: &CorrespondenceReport) -> f64 {
        report.solution.as_ref().unwrap().rotation().angle_to(&self.c_from_s2).to_degrees()
    }
}

fn vector(noise: &mut Noise) -> Vector3<f64> {
    Vector3::from_fn(|_, _| noise.gaussian())
}

fn rotation(noise: &mut Noise) -> UnitQuaternion<f64> {
    from_roll_pitch_yaw_deg(&Vector3::from_fn(|_, _| 360.0 * noise.uniform()))
}

fn judged(pairs: &[PushPair]) -> CorrespondenceReport {
    fit(pairs, &CorrespondenceOptions::default()).unwrap()
}

#[test]
fn twenty_pushes_of_a_hundred_readings_are_found_to_a_fifth_of_a_degree() {
    for seed in 0..200 {
        let mut rig = Rig::new(seed, READING_N / READINGS.sqrt(), seed % 2 == 0);
        let report = judged(&rig.pushes(20));
        assert_eq!(report.verdict, Verdict::Accepted, "{seed}: {}", report.reason);
        let solution = report.solution.as_ref().unwrap();
        assert!(rig.error_deg(&report) <= 0.2, "{seed}: {}", rig.error_deg(&report));
        assert!(solution.cross_check_deg < 1e-3, "{seed}: {}", solution.cross_check_deg);
        assert_eq!(solution.target, if seed % 2 == 0 { FitTarget::CFromS2 } else { FitTarget::S1FromS2 });
    }
}

#[test]
fn the_stated_uncertainty_is_the_error_that_is_made() {
    let mut made = 0.0;
    let mut stated = 0.0;
    let trials = 300;
    let pushes = 20;
    for seed in 0..trials {
        let mut rig = Rig::new(1000 + seed, READING_N, true);
        let report = judged(&rig.pushes(pushes));
        assert_eq!(report.verdict, Verdict::Accepted, "{seed}: {}", report.reason);
        made += rig.error_deg(&report).powi(2);
        stated += report.solution.unwrap().uncertainty_deg.powi(2);
    }
    let ratio = (made / stated).sqrt();
    assert!((0.9..1.1).contains(&ratio), "made over stated {ratio}, made {}", (made / trials as f64).sqrt());
}

#[test]
fn random_pushes_along_a_line_or_in_a_plane_are_always_refused() {
    for seed in 0..400 {
        let deviation_n = if seed % 4 < 2 { READING_N } else { READING_N / READINGS.sqrt() };
        let mut rig = Rig::new(2000 + seed, deviation_n, seed % 3 == 0);
        let a = rig.direction();
        let b = rig.direction();
        let line = seed % 2 == 0;
        let count = 6 + (seed % 25) as usize;
        let pairs: Vec<_> = (0..count)
            .map(|_| {
                let along = (a * rig.noise.gaussian() + b * if line { 0.0 } else { rig.noise.gaussian() }).normalize();
                let f2_n = along * rig.strength_n();
                rig.push(f2_n)
            })
            .collect();
        let report = judged(&pairs);
        assert_eq!(report.verdict, Verdict::InsufficientMotion, "{seed}: {} {:?}", report.reason, report.excitation);
        assert!(report.reason.contains(if line { "one line" } else { "one" }), "{seed}: {}", report.reason);
    }
}

#[test]
fn a_tenth_of_gross_outliers_is_named_and_does_no_harm() {
    for seed in 0..200 {
        let mut rig = Rig::new(3000 + seed, READING_N / READINGS.sqrt(), true);
        let mut pairs = rig.pushes(20);
        for index in [4, 13] {
            pairs[index].f1_n = rig.direction() * rig.strength_n();
        }
        let report = judged(&pairs);
        assert_eq!(report.verdict, Verdict::Accepted, "{seed}: {}", report.reason);
        assert_eq!(report.outliers, [4, 13], "{seed}");
        assert!(rig.error_deg(&report) <= 0.25, "{seed}: {}", rig.error_deg(&report));
    }
}

#[test]
fn one_push_alone_does_not_make_a_plane_into_space() {
    let mut rig = Rig::new(7, 0.005, false);
    let mut pairs: Vec<_> =
        (0..12).map(|i| rig.push(Vector3::new((f64::from(i)).cos(), (f64::from(i)).sin(), 0.0) * 2.0)).collect();
    pairs.push(rig.push(Vector3::z() * 3.0));
    let report = judged(&pairs);
    assert_eq!(report.verdict, Verdict::InsufficientMotion, "{}", report.reason);
}

#[test]
fn a_sensor_that_tells_the_reaction_is_named_and_the_flip_cures_it() {
    for seed in 0..50 {
        let mut rig = Rig::new(4000 + seed, 0.02, seed % 2 == 0);
        let mut pairs = rig.pushes(12);
        for pair in &mut pairs {
            pair.f2_n *= -1.0;
        }
        let report = judged(&pairs);
        assert_eq!(report.verdict, Verdict::PoorData);
        assert!(report.reason.contains("opposite forces"), "{seed}: {}", report.reason);
        let cured = fit(&pairs, &CorrespondenceOptions { flip_s2: true, ..CorrespondenceOptions::default() }).unwrap();
        assert_eq!(cured.verdict, Verdict::Accepted, "{seed}: {}", cured.reason);
        assert!(rig.error_deg(&cured) < 1.0);
    }
}

#[test]
fn inverse_rotations_of_the_chain_are_named() {
    for seed in 0..50 {
        let mut rig = Rig::new(5000 + seed, 0.02, true);
        let mut pairs = rig.pushes(14);
        for pair in &mut pairs {
            pair.s1_from_c = pair.s1_from_c.inverse();
        }
        let report = judged(&pairs);
        assert_eq!(report.verdict, Verdict::PoorData);
        assert!(report.reason.contains("inverse"), "{seed}: {}", report.reason);
    }
}

#[test]
fn a_sensor_that_reads_more_and_one_that_was_not_zeroed_are_named() {
    let edited = |seed, edit: &dyn Fn(&mut PushPair)| {
        let mut rig = Rig::new(seed, 0.01, true);
        let mut pairs = rig.pushes(20);
        pairs.iter_mut().for_each(edit);
        let report = judged(&pairs);
        (report.verdict, report.reason)
    };
    for seed in 6000..6030 {
        let (verdict, reason) = edited(seed, &|pair| pair.f2_n *= 1.2);
        assert_eq!(verdict, Verdict::PoorData, "{reason}");
        assert!(reason.contains("sensor 2 reads 20 % more"), "{seed}: {reason}");
        assert_eq!(edited(seed, &|pair| pair.f2_n *= 1.03).0, Verdict::Accepted, "{seed}");
        let (verdict, reason) = edited(seed, &|pair| pair.f1_n += Vector3::new(0.3, -0.2, 0.1));
        assert_eq!(verdict, Verdict::PoorData, "{reason}");
        assert!(
            reason.contains("sensor 1 was not zeroed") && (reason.contains("0.37 N") || reason.contains("0.38 N")),
            "{seed}: {reason}"
        );
        let (_, reason) = edited(seed, &|pair| pair.f2_n += Vector3::new(0.3, -0.2, 0.1));
        assert!(reason.contains("sensor 2 was not zeroed"), "{seed}: {reason}");
    }
}

#[test]
fn unrelated_forces_are_never_accepted() {
    for seed in 0..200 {
        let mut rig = Rig::new(8000 + seed, READING_N, true);
        let mut pairs = rig.pushes(12);
        for pair in &mut pairs {
            pair.f1_n = rig.direction() * rig.strength_n();
        }
        let report = judged(&pairs);
        assert_ne!(report.verdict, Verdict::Accepted, "{seed}: {}", report.reason);
    }
}

#[test]
fn few_weak_or_no_pushes_ask_for_more_and_bad_numbers_are_errors() {
    let mut rig = Rig::new(9, 0.01, false);
    for count in 0..6 {
        let report = judged(&rig.pushes(count));
        assert_eq!(report.verdict, Verdict::InsufficientMotion, "{count}");
        assert!(report.reason.contains("6 are required"), "{}", report.reason);
    }
    let mut pairs = rig.pushes(20);
    for pair in &mut pairs {
        pair.f1_n *= 0.05;
    }
    let report = judged(&pairs);
    assert_eq!((report.verdict, report.weak.len()), (Verdict::InsufficientMotion, 20));
    let mut pairs = rig.pushes(8);
    pairs[3].f2_n.y = f64::NAN;
    assert_eq!(fit(&pairs, &CorrespondenceOptions::default()), Err(CorrespondenceError::NotFinite { index: 3 }));
    pairs[3].f2_n.y = 1e200;
    assert!(matches!(
        fit(&pairs, &CorrespondenceOptions::default()),
        Err(CorrespondenceError::NotPlausible { index: 3, .. })
    ));
}

#[test]
fn held_out_errors_are_those_of_pushes_that_were_not_fitted() {
    let mut rig = Rig::new(10, READING_N, true);
    let pairs = rig.pushes(12);
    let solution = judged(&pairs).solution.unwrap();
    let mut others = pairs.clone();
    let left_out = others.remove(5);
    let rotation = judged(&others).solution.unwrap().rotation();
    let error_n = left_out.s1_from_c * (rotation * left_out.f2_n) - left_out.f1_n;
    let held_out = solution.agreement.residuals.held_out;
    for axis in 0..3 {
        assert!(held_out.max[axis] >= error_n[axis].abs() - 1e-12);
    }
    assert!(held_out.mean_mae() > solution.agreement.residuals.fitted.mean_mae());
    assert!(solution.agreement.r2_held_out_overall < solution.agreement.r2_fitted_overall);
    assert!(solution.agreement.r2_held_out_overall > 0.99);
}

/// Corrupts one pair; the vector provides random noise.
type Edit<'a> = &'a dyn Fn(&mut PushPair, Vector3<f64>);

#[test]
fn a_sensor_that_feels_nothing_or_hangs_is_refused() {
    for seed in 0..50 {
        let mut rig = Rig::new(8000 + seed, 0.02, seed % 2 == 0);
        let good = rig.pushes(20);
        let hung = vector(&mut rig.noise).normalize() * 2.0;
        let noise_n = 0.02;
        let edits: [(&str, Edit<'_>); 5] = [
            ("both zero", &|pair, _| (pair.f1_n, pair.f2_n) = (Vector3::zeros(), Vector3::zeros())),
            ("one zero", &|pair, _| pair.f1_n = Vector3::zeros()),
            ("noise", &|pair, noise| pair.f2_n = noise * noise_n),
            ("both hung", &|pair, _| (pair.f1_n, pair.f2_n) = (hung, hung)),
            ("one hung", &|pair, _| pair.f2_n = hung),
        ];
        for (name, edit) in edits {
            let mut pairs = good.clone();
            for pair in &mut pairs {
                edit(pair, vector(&mut rig.noise));
            }
            let report = fit(&pairs, &CorrespondenceOptions::default()).unwrap();
            assert_ne!(report.verdict, Verdict::Accepted, "{name}, seed {seed}: {}", report.reason);
        }
    }
}
