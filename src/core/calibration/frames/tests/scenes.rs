//! Samples of the calibrations other than pivoting: touched points, moves in the camera image, still poses with a
//! weight.

use nalgebra::{Isometry3, UnitQuaternion, Vector3};

use super::rig::*;
use crate::{
    calibration::frames::{FrameSample, ViewMove},
    frames::{GRAVITY_M_S2, Wrench},
};

pub(crate) const MASS_KG: f64 = 0.4;
pub(crate) const BIAS_N: Vector3<f64> = Vector3::new(1.5, -0.8, 3.0);

pub(crate) fn base_from_table() -> Isometry3<f64> {
    pose([0.35, -0.1, -0.2], [2.0, -3.0, 35.0])
}

/// Touches these points of the table (m, in its own frame) with the tip.
pub(crate) fn touched(rig: &mut Rig, points_m: &[[f64; 2]]) -> Vec<FrameSample> {
    let touch = |[x, y]: &[f64; 2]| {
        let tip_m = base_from_table() * nalgebra::Point3::new(*x, *y, 0.0);
        let tilt = UnitQuaternion::from_scaled_axis(rig.vector(0.1));
        let mut sample = rig.sample(&with_tip_at(&tip_m.coords, tilt * shaft_down()));
        sample.base_from_flange = sample.base_from_flange.map(|pose| rig.noisy(&pose));
        sample
    };
    points_m.iter().map(touch).collect()
}

pub(crate) fn base_from_view() -> UnitQuaternion<f64> {
    pose([0.0; 3], [-130.0, 8.0, 70.0]).rotation
}

/// Returns the ends of these moves of about 3 cm, `off_deg` away from their true directions.
pub(crate) fn moved(rig: &mut Rig, moves: &[Vector3<f64>], off_deg: f64) -> Vec<FrameSample> {
    let mut tip_m = TROCAR_M - Vector3::z() * 0.1;
    let mut samples = vec![rig.sample(&with_tip_at(&tip_m, shaft_down()))];
    for direction in moves {
        let off = UnitQuaternion::from_scaled_axis(rig.vector(off_deg.to_radians()));
        tip_m += base_from_view() * (off * direction * (0.03 + 0.005 * rig.noise.uniform()));
        let tilt = UnitQuaternion::from_scaled_axis(rig.vector(0.05));
        samples.push(rig.sample(&with_tip_at(&tip_m, tilt * shaft_down())));
    }
    samples
}

pub(crate) fn all_moves() -> Vec<Vector3<f64>> {
    ViewMove::ALL.into_iter().map(ViewMove::in_view).collect()
}

/// Returns a still pose of the flange with the tool's weight, as read by a sensor with this mount.
pub(crate) fn weighed(rig: &mut Rig, turn: UnitQuaternion<f64>, flange_from_s1: &UnitQuaternion<f64>) -> FrameSample {
    let mut sample = rig.sample(&with_tip_at(&TROCAR_M, turn));
    let weight_n = (turn * flange_from_s1).inverse() * Vector3::new(0.0, 0.0, -MASS_KG * GRAVITY_M_S2);
    let force_n = weight_n + BIAS_N + rig.vector(0.02);
    sample.wrench = Some(Wrench { force_n, torque_nm: Vector3::zeros() });
    sample
}

pub(crate) fn any_turn(rig: &mut Rig) -> UnitQuaternion<f64> {
    let parts = nalgebra::Quaternion::new(
        rig.noise.gaussian(),
        rig.noise.gaussian(),
        rig.noise.gaussian(),
        rig.noise.gaussian(),
    );
    UnitQuaternion::new_normalize(parts)
}

pub(crate) fn all_weighed(rig: &mut Rig, count: usize, flange_from_s1: &UnitQuaternion<f64>) -> Vec<FrameSample> {
    let one = |rig: &mut Rig| {
        let turn = any_turn(rig);
        weighed(rig, turn, flange_from_s1)
    };
    (0..count).map(|_| one(rig)).collect()
}
