//! The trocar watch: no false alarm over an hour, and a shift of 2 mm detected within one or two seconds.

use nalgebra::Vector3;

use super::rig::*;
use crate::calibration::frames::{ShaftLine, TrocarState, TrocarWatch};

const RATE_HZ: f64 = 60.0;

/// Returns the shaft at time `t_s`, as a tracker measures it; `tilt` is the largest tilt in rad, pivoting once in four
/// seconds.
fn line(rig: &mut Rig, trocar_m: &Vector3<f64>, tilt: f64, t_s: f64) -> ShaftLine {
    let (sin, cos) = (t_s * 1.57).sin_cos();
    let direction = Vector3::new(tilt * sin, tilt * cos, -1.0).normalize();
    // The marker is 0.3 m from the trocar.
    let noisy = (direction + rig.vector(NOISE_RAD)).normalize();
    ShaftLine { point_m: trocar_m - direction * 0.3 + rig.vector(NOISE_M), direction: noisy }
}

#[test]
fn an_hour_of_noise_gives_no_alarm() {
    let mut rig = Rig::new(1);
    for tilt in [0.0, 0.1, 0.3] {
        let mut watch = TrocarWatch::new(TROCAR_M, TrocarWatch::LIMIT_M);
        let mut worst_m = 0.0_f64;
        for tick in 0..(3600.0 * RATE_HZ) as u32 {
            let t_s = f64::from(tick) / RATE_HZ;
            match watch.step(&line(&mut rig, &TROCAR_M, tilt, t_s), t_s) {
                TrocarState::Fine { by_m } => worst_m = worst_m.max(by_m),
                TrocarState::Waiting => assert!(t_s < 0.6, "{t_s}"),
                TrocarState::Moved { by_m } => panic!("{by_m:?} at {t_s}"),
            }
        }
        println!("tilt {tilt} rad: at most {:.2} mm in an hour", 1e3 * worst_m);
        assert!(worst_m < 0.5 * TrocarWatch::LIMIT_M, "{worst_m}");
    }
}

/// Returns the time until a shift is detected, s.
fn reported_after_s(rig: &mut Rig, shift_m: &Vector3<f64>, tilt: f64) -> Option<f64> {
    let mut watch = TrocarWatch::new(TROCAR_M, TrocarWatch::LIMIT_M);
    let start_s = 3.0 + 4.0 * rig.noise.uniform();
    (0..1200).map(|tick| f64::from(tick) / RATE_HZ).find_map(|t_s| {
        let trocar_m = if t_s < start_s { TROCAR_M } else { TROCAR_M + shift_m };
        let state = watch.step(&line(rig, &trocar_m, tilt, t_s), t_s);
        matches!(state, TrocarState::Moved { .. }).then_some(t_s - start_s)
    })
}

#[test]
fn two_millimetres_across_the_shaft_are_told_within_a_second() {
    let mut times_s = vec![];
    for seed in 0..200 {
        let mut rig = Rig::new(seed);
        let across = Vector3::new(rig.noise.gaussian(), rig.noise.gaussian(), 0.0).normalize();
        let tilt = 0.2 * rig.noise.uniform();
        times_s.push(reported_after_s(&mut rig, &(across * 2e-3), tilt).unwrap());
    }
    let worst_s = times_s.iter().copied().fold(0.0, f64::max);
    let p95_s = p95(times_s);
    println!("2 mm across: p95 {p95_s:.2} s, at most {worst_s:.2} s");
    assert!(worst_s < 1.0, "{worst_s}");
    let mut rig = Rig::new(1);
    let along = reported_after_s(&mut rig, &(Vector3::z() * 5e-3), 0.35);
    println!("5 mm along a shaft that pivots by 20 degrees: {along:?} s");
    assert!(reported_after_s(&mut rig, &(Vector3::z() * 5e-3), 0.0).is_none(), "along a shaft at rest nothing is seen");
}

#[test]
fn what_is_back_is_fine_and_what_is_no_line_changes_nothing() {
    let mut rig = Rig::new(2);
    let mut watch = TrocarWatch::new(TROCAR_M, TrocarWatch::LIMIT_M);
    let mut go = |watch: &mut TrocarWatch, from_s: f64, trocar_m: &Vector3<f64>| {
        for tick in 0..240 {
            let t_s = from_s + f64::from(tick) / RATE_HZ;
            watch.step(&line(&mut rig, trocar_m, 0.1, t_s), t_s);
        }
        watch.state()
    };
    assert!(matches!(go(&mut watch, 0.0, &TROCAR_M), TrocarState::Fine { .. }));
    let TrocarState::Moved { by_m } = go(&mut watch, 4.0, &(TROCAR_M + Vector3::x() * 3e-3)) else {
        panic!("not told")
    };
    assert!((Vector3::from(by_m) - Vector3::x() * 3e-3).norm() < 0.7e-3, "{by_m:?}");
    let broken = ShaftLine { point_m: Vector3::repeat(f64::NAN), direction: Vector3::z() };
    assert!(matches!(watch.step(&broken, 8.1), TrocarState::Moved { .. }));
    assert!(matches!(go(&mut watch, 8.2, &TROCAR_M), TrocarState::Fine { .. }));
    let good = ShaftLine { point_m: TROCAR_M, direction: Vector3::z() };
    assert_eq!(watch.step(&good, 20.0), TrocarState::Waiting, "after a gap it restarts");
    assert_eq!(watch.step(&good, f64::NAN), TrocarState::Waiting);
}
