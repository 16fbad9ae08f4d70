//! Other errors between two sensors: different gains, or an offset because one was not zeroed.

use nalgebra::{Rotation3, SMatrix, SVector, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

use super::solver::PushRow;

/// The sensor in whose axes the offset is constant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum OffsetFrame {
    S1,
    S2,
    /// Unknown, because the wrist was not turned enough between the pushes; the values are in the wrist sensor's axes.
    Unknown,
}

/// Gain and offset between the two sensors, `f1 = gain R f2 + offset`, with their standard errors; estimated by least
/// squares together with the rotation, so that the rotation cannot absorb them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SensorDiagnosis {
    /// Force of the wrist sensor divided by the force of the tissue sensor.
    pub gain: f64,
    pub gain_se: f64,
    pub offset_n: [f64; 3],
    pub offset_se_n: f64,
    /// Sensor whose axes the offset refers to.
    pub offset_frame: OffsetFrame,
}

impl SensorDiagnosis {
    pub fn offset_norm_n(&self) -> f64 {
        Vector3::from(self.offset_n).norm()
    }

    /// Returns whether the gain differs from one by more than `limit`, and by more than three standard errors.
    pub fn gain_is_off(&self, limit: f64) -> bool {
        let by = (self.gain - 1.0).abs();
        by > limit && by > 3.0 * self.gain_se
    }

    /// Returns whether the offset exceeds `limit_n`, and four standard errors.
    pub fn offset_is_off(&self, limit_n: f64) -> bool {
        let by_n = self.offset_norm_n();
        by_n > limit_n && by_n > 4.0 * self.offset_se_n
    }

    /// Estimates gain and offset around this rotation; `None` if the rows do not determine them.
    pub(super) fn of(rows: &[PushRow], c_from_s2: &Rotation3<f64>) -> Option<Self> {
        let wrist = joint_fit(rows, c_from_s2, |row, _| row.s1_from_c.inverse())?;
        let tissue = joint_fit(rows, c_from_s2, |_, c_from_s2| UnitQuaternion::from(*c_from_s2));
        let (fit, offset_frame) = match tissue {
            // Clearly better (a tenth) means that the offset is constant in that sensor's axes; otherwise the data
            // cannot decide.
            Some(tissue) if tissue.sd_n < 0.9 * wrist.sd_n => (tissue, OffsetFrame::S2),
            Some(tissue) if wrist.sd_n < 0.9 * tissue.sd_n => (wrist, OffsetFrame::S1),
            _ => (wrist, OffsetFrame::Unknown),
        };
        Some(Self {
            gain: fit.gain,
            gain_se: fit.gain_se,
            offset_n: fit.offset_n.into(),
            offset_se_n: fit.offset_se_n,
            offset_frame,
        })
    }
}

/// Rotation (3), gain (1) and offset (3).
const UNKNOWNS: usize = 7;

struct JointFit {
    gain: f64,
    gain_se: f64,
    offset_n: Vector3<f64>,
    offset_se_n: f64,
    sd_n: f64,
}

/// Gauss-Newton on `c = gain R s2 + T offset` with `T = c_from_offset` of each row; nearly linear, so a few steps are
/// enough.
fn joint_fit(
    rows: &[PushRow],
    start: &Rotation3<f64>,
    c_from_offset: impl Fn(&PushRow, &Rotation3<f64>) -> UnitQuaternion<f64>,
) -> Option<JointFit> {
    // Three equations per row; without a surplus there is no residual and no standard error.
    let freedom = (3 * rows.len()).checked_sub(UNKNOWNS).filter(|&freedom| freedom > 0)?;
    let mut rotation = *start;
    let mut gain = 1.0;
    let mut offset_n = Vector3::zeros();
    let mut covariance = SMatrix::<f64, UNKNOWNS, UNKNOWNS>::zeros();
    let mut sd_n = 0.0;
    // Six Gauss-Newton steps: the start is already the rotation of least squares, so the steps shrink quadratically.
    for _ in 0..6 {
        let mut normal = SMatrix::<f64, UNKNOWNS, UNKNOWNS>::zeros();
        let mut right = SVector::<f64, UNKNOWNS>::zeros();
        let mut squares = 0.0;
        for row in rows {
            let turned_n = rotation * row.s2_n;
            let transform = *c_from_offset(row, &rotation).to_rotation_matrix().matrix();
            let error_n = row.c_n - turned_n * gain - transform * offset_n;
            let mut slopes = SMatrix::<f64, 3, UNKNOWNS>::zeros();
            // Derivative of a rotated vector by a small rotation in front of it: `-[R v]x`.
            slopes.fixed_view_mut::<3, 3>(0, 0).copy_from(&(-turned_n * gain).cross_matrix());
            slopes.fixed_view_mut::<3, 1>(0, 3).copy_from(&turned_n);
            slopes.fixed_view_mut::<3, 3>(0, 4).copy_from(&transform);
            normal += slopes.transpose() * slopes;
            right += slopes.transpose() * error_n;
            squares += error_n.norm_squared();
        }
        covariance = normal.cholesky()?.inverse();
        sd_n = (squares / freedom as f64).sqrt();
        let step = covariance * right;
        // Multiplied in front, as the derivative assumes; the exponential keeps it a rotation.
        rotation = Rotation3::new(step.fixed_rows::<3>(0).into_owned()) * rotation;
        gain += step[3];
        offset_n += step.fixed_rows::<3>(4);
    }
    let se = |index: usize| sd_n * covariance[(index, index)].max(0.0).sqrt();
    // The worst axis, because the limits hold for each.
    let offset_se_n = (4..7).map(se).fold(0.0, f64::max);
    let finite = gain.is_finite() && sd_n.is_finite() && offset_n.iter().all(|x| x.is_finite());
    finite.then(|| JointFit { gain, gain_se: se(3), offset_n, offset_se_n, sd_n })
}
