use nalgebra::{UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

use super::{CorrespondenceExcitation, SensorDiagnosis};
use crate::{
    calibration::{AxisStats, Residuals, Verdict},
    frames,
};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FitTarget {
    /// `c_from_s2`: the remaining chain was given with each push.
    CFromS2,
    /// `s1_from_s2`: no chain was given.
    S1FromS2,
}

impl FitTarget {
    /// Returns the name in files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::CFromS2 => "c_from_s2",
            Self::S1FromS2 => "s1_from_s2",
        }
    }
}

/// Agreement of the rotated force of `s2` with the force of `s1`, in the axes of `s1`, N, over the agreeing pushes.
/// Held out: each push (each tenth of them, in order, beyond 20) is compared with a rotation fitted to the others.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PushAgreement {
    pub residuals: Residuals,
    /// Coefficient of determination per axis of the fit, `1 - sum e^2 / sum (f - mean)^2`.
    pub r2_fitted: [f64; 3],
    /// Coefficient of determination per axis, held out.
    pub r2_held_out: [f64; 3],
    /// Coefficient of determination of all axes together, for the fit.
    pub r2_fitted_overall: f64,
    /// Coefficient of determination of all axes together, held out.
    pub r2_held_out_overall: f64,
}

impl PushAgreement {
    /// Computes the agreement from the forces of `s1` and the errors (N), pair by pair.
    pub(super) fn of(f1_n: &[Vector3<f64>], fitted_n: &[Vector3<f64>], held_out_n: &[Vector3<f64>]) -> Self {
        let (r2_fitted, r2_fitted_overall) = determination(f1_n, fitted_n);
        let (r2_held_out, r2_held_out_overall) = determination(f1_n, held_out_n);
        let stats = |errors: &[Vector3<f64>]| AxisStats::of(errors.iter().copied());
        let residuals = Residuals { fitted: stats(fitted_n), held_out: stats(held_out_n) };
        Self { residuals, r2_fitted, r2_held_out, r2_fitted_overall, r2_held_out_overall }
    }
}

/// Returns the coefficient of determination per axis and overall; zero if the force did not vary.
fn determination(force_n: &[Vector3<f64>], error_n: &[Vector3<f64>]) -> ([f64; 3], f64) {
    let mean_n = force_n.iter().sum::<Vector3<f64>>() / force_n.len().max(1) as f64;
    let squares = |vectors: &mut dyn Iterator<Item = Vector3<f64>>| {
        vectors.fold(Vector3::zeros(), |sum: Vector3<f64>, v| sum + v.component_mul(&v))
    };
    let varied = squares(&mut force_n.iter().map(|force_n| force_n - mean_n));
    let unexplained = squares(&mut error_n.iter().copied());
    // A constant force has no variance to explain; zero fails every limit.
    let fraction = |unexplained: f64, varied: f64| if varied > 0.0 { 1.0 - unexplained / varied } else { 0.0 };
    (unexplained.zip_map(&varied, fraction).into(), fraction(unexplained.sum(), varied.sum()))
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CorrespondenceSolution {
    pub target: FitTarget,
    /// The rotation as a quaternion (w, x, y, z).
    pub rotation_wxyz: [f64; 4],
    /// The rotation as roll, pitch, yaw, degrees (`Rz Ry Rx`).
    pub roll_pitch_yaw_deg: [f64; 3],
    pub agreement: PushAgreement,
    /// Combined noise of both sensors per axis, N: standard deviation of the residuals.
    pub noise_n: f64,
    /// Expected angular error (root mean square), degrees, for noise that is independent from row to row.
    pub uncertainty_deg: f64,
    /// Angle to the result of the paper's search over Euler angles on the same pushes, degrees.
    pub cross_check_deg: f64,
    /// Gain and offset between the sensors; `None` if the pushes do not determine them.
    pub diagnosis: Option<SensorDiagnosis>,
}

impl CorrespondenceSolution {
    pub fn rotation(&self) -> UnitQuaternion<f64> {
        from_wxyz(&self.rotation_wxyz)
    }
}

pub(super) fn from_wxyz(wxyz: &[f64; 4]) -> UnitQuaternion<f64> {
    let [w, x, y, z] = *wxyz;
    UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(w, x, y, z))
}

/// Returns the components of a rotation, with `w` not negative, and its angles in degrees.
pub(super) fn parts(rotation: &UnitQuaternion<f64>) -> ([f64; 4], [f64; 3]) {
    // One of the two quaternions of a rotation, so that files and tests compare equal.
    let sign = if rotation.w < 0.0 { -1.0 } else { 1.0 };
    let wxyz = [rotation.w, rotation.i, rotation.j, rotation.k].map(|part| part * sign);
    (wxyz, frames::to_roll_pitch_yaw_deg(rotation).into())
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CorrespondenceReport {
    pub verdict: Verdict,
    /// The reason for the verdict, one sentence for the operator.
    pub reason: String,
    pub pairs: usize,
    /// Indices of pairs that are too weak, from 0; not used.
    pub weak: Vec<usize>,
    /// Indices of pairs that contradict the others, from 0; not used.
    pub outliers: Vec<usize>,
    pub excitation: CorrespondenceExcitation,
    /// The rotation; `None` with fewer than three usable pushes. Only to be used with [`Verdict::Accepted`].
    pub solution: Option<CorrespondenceSolution>,
}
