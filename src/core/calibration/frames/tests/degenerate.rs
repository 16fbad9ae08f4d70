//! Data that do not determine a result are refused; 1000 sets for each calibration, all with noise.

use nalgebra::{Isometry3, Unit, UnitQuaternion, Vector3};

use super::{rig::*, scenes::*};
use crate::calibration::{Verdict, frames::*};

const SETS: u64 = 1000;

/// Returns insufficient turns: about one axis, too small, none at all.
fn poor_turns(rig: &mut Rig, seed: u64, count: usize) -> Vec<UnitQuaternion<f64>> {
    let axis = Unit::new_normalize(rig.vector(1.0));
    let start = any_turn(rig);
    let turn = |rig: &mut Rig| match seed % 3 {
        0 => UnitQuaternion::from_axis_angle(&axis, 2.0 * rig.noise.uniform()),
        1 => UnitQuaternion::from_scaled_axis(rig.vector(0.04)),
        _ => UnitQuaternion::identity(),
    };
    (0..count).map(|_| turn(rig) * start).collect()
}

fn refused<C: Calibration>(calibration: &C, samples: &[FrameSample], seed: u64) {
    let report = calibration.fit(samples).unwrap();
    assert_eq!(report.verdict, Verdict::InsufficientMotion, "seed {seed}: {:?}", report.cause);
}

#[test]
fn turns_that_do_not_suffice_are_refused() {
    for seed in 0..SETS {
        let mut rig = Rig::new(seed);
        let turns = poor_turns(&mut rig, seed, 20);
        let pivoting: Vec<FrameSample> = turns
            .iter()
            .map(|turn| {
                // No rotation at all: the tip wanders, which a dimple would prevent.
                let tip_m = TROCAR_M + if seed % 3 == 2 { rig.vector(0.05) } else { Vector3::zeros() };
                rig.sample(&with_tip_at(&tip_m, *turn))
            })
            .collect();
        // The other side is at rest because it is not used.
        let alone: Vec<FrameSample> = pivoting
            .iter()
            .map(|sample| FrameSample { c_from_other_m: None, other_base_from_flange: None, ..*sample })
            .collect();
        refused(&TipSettings::by_tracker(), &alone, seed);
        refused(&TipSettings::by_arm(), &alone, seed);
        let free: Vec<FrameSample> = turns
            .iter()
            .map(|turn| Isometry3::from_parts((TROCAR_M + rig.vector(0.1)).into(), *turn))
            .map(|pose| FrameSample {
                c_from_other_m: None,
                other_base_from_flange: None,
                ..Rig::new(seed).sample(&pose)
            })
            .collect();
        refused(&HandEyeSettings::new(TIP_IN_FLANGE_M), &free, seed);
    }
}

#[test]
fn lines_that_are_nearly_parallel_are_refused() {
    let trocar = TrocarSettings::by_tracker(&arm(), &flange_from_m());
    for seed in 0..SETS {
        let mut rig = Rig::new(seed);
        let samples: Vec<FrameSample> = (0..40)
            .map(|_| {
                let tilt = UnitQuaternion::from_scaled_axis(rig.vector(0.02)) * shaft_down();
                let roll = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), rig.noise.uniform());
                let tip_m = TROCAR_M + tilt * Vector3::z() * (0.05 + 0.1 * rig.noise.uniform());
                FrameSample { c_from_other_m: None, ..rig.sample(&with_tip_at(&tip_m, tilt * roll)) }
            })
            .collect();
        refused(&trocar, &samples, seed);
    }
}

#[test]
fn points_on_a_line_are_refused() {
    let tables =
        [TableSettings::by_arm(TIP_IN_FLANGE_M, Vector3::z()), TableSettings::by_tracker(tip_in(Carrier::Marker))];
    for seed in 0..SETS {
        let mut rig = Rig::new(seed);
        let slope = rig.noise.gaussian();
        let mut points: Vec<[f64; 2]> = (0..6).map(|i| f64::from(i) * 0.03).map(|x| [x, x * slope]).collect();
        if seed % 2 == 0 {
            // A single point off the line does not verify the plane.
            points[2] = [0.0, 0.1];
        }
        refused(&tables[(seed / 2 % 2) as usize], &touched(&mut rig, &points), seed);
    }
}

#[test]
fn moves_along_a_line_or_in_a_plane_are_refused() {
    let view = ViewSettings::by_arm(TIP_IN_FLANGE_M);
    for seed in 0..SETS {
        let mut rig = Rig::new(seed);
        let axes = [rig.vector(1.0).normalize(), rig.vector(1.0).normalize()];
        let along = |i: usize| if seed % 2 == 0 { axes[0] } else { axes[i % 2] };
        let moves: Vec<Vector3<f64>> = (0..6).map(|i| along(i) * if i < 3 { 1.0 } else { -1.0 }).collect();
        let mut samples = moved(&mut rig, &moves, 2.0);
        for sample in &mut samples {
            sample.other_base_from_flange = None;
        }
        refused(&view, &samples, seed);
    }
}

#[test]
fn directions_of_gravity_in_a_cone_or_plane_are_refused() {
    for seed in 0..SETS {
        let mut rig = Rig::new(seed);
        let mount = any_turn(&mut rig);
        let axis = Unit::new_normalize(Vector3::new(rig.noise.gaussian(), rig.noise.gaussian(), 0.0));
        let samples: Vec<FrameSample> = (0..12)
            .map(|_| {
                let turn = match seed % 2 {
                    0 => UnitQuaternion::from_axis_angle(&axis, 6.0 * rig.noise.uniform()),
                    _ => UnitQuaternion::from_scaled_axis(rig.vector(0.1)),
                };
                FrameSample { other_base_from_flange: None, ..weighed(&mut rig, turn * shaft_down(), &mount) }
            })
            .collect();
        refused(&SensorMount::new(mount, Vector3::z()), &samples, seed);
    }
}

#[test]
fn a_sensor_that_feels_no_weight_is_refused() {
    for seed in 0..200 {
        let mut rig = Rig::new(seed);
        let mut samples = all_weighed(&mut rig, 12, &UnitQuaternion::identity());
        for sample in &mut samples {
            sample.wrench.as_mut().unwrap().force_n = BIAS_N + rig.vector(if seed % 2 == 0 { 0.02 } else { 0.0 });
        }
        let report = SensorMount::new(UnitQuaternion::identity(), Vector3::z()).fit(&samples).unwrap();
        assert!(matches!(report.cause, FrameCause::Weightless { .. }), "seed {seed}: {:?}", report.cause);
    }
}

#[test]
fn too_few_poses_and_none_at_all_are_refused() {
    let mut rig = Rig::new(1);
    for count in [0, 1, 2, 5] {
        let samples = rig.samples(in_dimple(), count);
        refused(&TipSettings::by_tracker(), &samples, 0);
        refused(&HandEyeSettings::new(TIP_IN_FLANGE_M), &samples, 0);
        refused(&TrocarSettings::by_arm(&arm()), &samples, 0);
        refused(&TableSettings::by_arm(TIP_IN_FLANGE_M, Vector3::z()), &samples[..count.min(2)], 0);
        refused(&ViewSettings::by_arm(TIP_IN_FLANGE_M), &samples, 0);
        let weighed = all_weighed(&mut rig, count, &UnitQuaternion::identity());
        refused(&SensorMount::new(UnitQuaternion::identity(), Vector3::z()), &weighed, 0);
    }
}
