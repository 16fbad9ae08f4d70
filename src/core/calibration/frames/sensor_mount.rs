//! Orientation of the wrist sensor on the flange: `flange_from_s1` from the weight of the tool in still poses of the
//! arm.
//!
//! In a still pose `f = m R u + f0` with the gravity vector `u` in the flange's frame, which follows from the joints.
//! The least-squares `R = s1_from_flange`, mass `m` and bias `f0` have a closed form: differences from the means remove
//! the bias, `R` is Wahba's problem on them, `m` their scale (Umeyama, IEEE Trans. Pattern Anal. Mach. Intell. 13,
//! 1991). The result is compared with the active mount.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

use super::{
    Calibration, CalibrationSource, Carrier, FrameCause, FrameCoverage, FrameLimits, FrameReport, FrameSample,
    MissingMotion, Mistake, SignedAxes, Sizes,
    examine::{Problem, RowMiss, examined},
    record::{CalibrationResult, rotation, rotation_fault, wxyz},
    report::finite,
    spread::{below, nearest_orthogonal, principal, radius_95},
};
use crate::frames::GRAVITY_M_S2;

/// Minimum rotation of the flange relative to gravity between two poses, rad: 10 degrees, so that a person who hardly
/// moves does not fill the session with equal poses. Design choice.
const APART_RAD: f64 = 0.17;
/// Minimum root mean square of the directions of gravity from their mean along the third axis, 0 to 1; 0.58 for all
/// directions.
const MIN_SPREAD: f64 = 0.1;
const PLENTY_SPREAD: f64 = 0.35;
const PLENTY: usize = 12;
/// Minimum weight, N, and as a multiple of the noise; 0.3 N is a tool of 30 g.
const MIN_WEIGHT_N: f64 = 0.3;
/// With less, noise turns the estimated direction by more than 10 degrees (1/5 rad).
const MIN_SIGNAL: f64 = 5.0;
/// A mirror explains the forces if its error is below this fraction of the rotation's.
const MIRROR_FRACTION: f64 = 0.5;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorMount {
    /// The active mount, `flange_from_s1`.
    pub active: UnitQuaternion<f64>,
    /// Direction upwards in the frame of the arm's base.
    pub up_in_base: Vector3<f64>,
    pub limits: FrameLimits,
}

impl SensorMount {
    /// Creates the settings for a comparison with this mount (`flange_from_s1`), on an arm with this upward direction
    /// in its base frame.
    pub const fn new(active: UnitQuaternion<f64>, up_in_base: Vector3<f64>) -> Self {
        let limits =
            // Six poses give 18 equations for seven unknowns.
            FrameLimits { min: 6, held_out: Sizes::angle(5.0), uncertainty: Sizes::angle(3.0), outliers: 0.25 };
        Self { active, up_in_base, limits }
    }

    /// Returns the direction of gravity in the flange's frame, unit length.
    fn down_in_flange(&self, sample: &FrameSample) -> Option<Vector3<f64>> {
        Some(-(sample.base_from_flange?.rotation.inverse() * self.up_in_base.try_normalize(0.0)?))
    }

    fn rows(&self, samples: &[FrameSample]) -> Vec<SensorMountRow> {
        let row = |sample: &FrameSample| {
            Some(SensorMountRow { down: self.down_in_flange(sample)?, force_n: sample.wrench?.force_n })
        };
        samples.iter().filter_map(row).collect()
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SensorMountResult {
    pub flange_from_s1_wxyz: [f64; 4],
    /// Angle between this mount and the active one, degrees.
    #[serde(rename = "from_in_force_deg")]
    pub from_active_deg: f64,
    /// Axes of the active mount that correspond to the measured x, y and z, if the two mounts differ only in names and
    /// signs of axes; unchanged if they agree. `None` if they differ in another way.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub axes: Option<SignedAxes>,
    pub mass_kg: f64,
    /// Bias of the sensor, N (`s1`).
    pub bias_n: [f64; 3],
}

impl SensorMountResult {
    /// A mount that differs from the active one by less than this agrees with it, degrees.
    pub const AGREES_DEG: f64 = 3.0;

    pub fn flange_from_s1(&self) -> UnitQuaternion<f64> {
        rotation(&self.flange_from_s1_wxyz)
    }

    pub fn agrees(&self) -> bool {
        self.from_active_deg <= Self::AGREES_DEG
    }
}

impl CalibrationResult for SensorMountResult {
    const KIND: &'static str = "sensor_mount";

    fn fault(&self) -> Option<&'static str> {
        let sound = (0.0..=180.0).contains(&self.from_active_deg)
            && self.mass_kg > 0.0
            && self.mass_kg.is_finite()
            && self.bias_n.iter().all(|x| x.is_finite());
        let fault = (!sound).then_some("an angle, the mass or the bias is out of range");
        rotation_fault(&self.flange_from_s1_wxyz).or(fault)
    }
}

/// One pose: direction of gravity in the flange's frame (unit length), and the measured force (N, `s1`).
#[derive(Clone, Copy, Debug)]
struct SensorMountRow {
    down: Vector3<f64>,
    force_n: Vector3<f64>,
}

/// `f = weight turn down + bias`.
#[derive(Clone, Copy, Debug)]
struct WeightModel {
    turn: Matrix3<f64>,
    weight_n: f64,
    bias_n: Vector3<f64>,
}

impl WeightModel {
    fn error_n(&self, row: &SensorMountRow) -> Vector3<f64> {
        row.force_n - self.turn * row.down * self.weight_n - self.bias_n
    }

    /// Returns the least-squares solution with this sign of the determinant: 1 for a rotation, -1 for a reflection.
    fn of(rows: &[SensorMountRow], sign: f64) -> Option<Self> {
        // `max` keeps the means finite without rows; the solution is then refused for its rank.
        let fraction = 1.0 / rows.len().max(1) as f64;
        let down = rows.iter().map(|row| row.down).sum::<Vector3<f64>>() * fraction;
        let force_n = rows.iter().map(|row| row.force_n).sum::<Vector3<f64>>() * fraction;
        let moment: Matrix3<f64> = rows.iter().map(|row| (row.force_n - force_n) * (row.down - down).transpose()).sum();
        let squares: f64 = rows.iter().map(|row| (row.down - down).norm_squared()).sum();
        let turn = nearest_orthogonal(&moment, sign)?;
        let weight_n = (turn.transpose() * moment).trace() / squares;
        let found = Self { turn, weight_n, bias_n: force_n - turn * down * weight_n };
        (weight_n.is_finite() && weight_n > 0.0).then_some(found)
    }
}

struct WeightFit {
    sign: f64,
}

impl Problem for WeightFit {
    type Row = SensorMountRow;
    type Model = WeightModel;
    const HYPOTHESIS: usize = 4;
    // 0.1 rad is a force error of a tenth of the weight.
    const FLOOR: RowMiss = RowMiss::of_angle(0.1);

    fn solve(&self, rows: &[SensorMountRow]) -> Option<WeightModel> {
        WeightModel::of(rows, self.sign)
    }

    /// Returns the error of the force as an angle of the weight.
    fn miss(&self, weighed: &WeightModel, row: &SensorMountRow) -> RowMiss {
        RowMiss::of_angle(libm::atan(weighed.error_n(row).norm() / weighed.weight_n))
    }
}

/// Returns the spread of the directions of gravity about their mean along the third axis.
fn spread(rows: &[SensorMountRow]) -> f64 {
    let mean = rows.iter().map(|row| row.down).sum::<Vector3<f64>>() / rows.len().max(1) as f64;
    let from_mean: Vec<Vector3<f64>> = rows.iter().map(|row| row.down - mean).collect();
    principal(&from_mean)[2]
}

impl Calibration for SensorMount {
    type Solution = SensorMountResult;

    fn needs(&self) -> Vec<CalibrationSource> {
        vec![CalibrationSource::Flange, CalibrationSource::Wrench]
    }

    fn carrier(&self) -> Carrier {
        Carrier::Flange
    }

    fn differs(&self, sample: &FrameSample, taken: &[FrameSample]) -> bool {
        let Some(down) = self.down_in_flange(sample) else { return false };
        taken.iter().filter_map(|sample| self.down_in_flange(sample)).all(|other| other.angle(&down) >= APART_RAD)
    }

    fn coverage(&self, taken: &[FrameSample]) -> FrameCoverage {
        FrameCoverage::min([
            (taken.len() as f64 / PLENTY as f64, MissingMotion::Poses),
            (spread(&self.rows(taken)) / PLENTY_SPREAD, MissingMotion::Directions),
        ])
    }

    fn fault(&self) -> Option<&'static str> {
        let sound =
            finite(&self.up_in_base) && self.up_in_base.norm() > 0.0 && (self.active.coords.norm() - 1.0).abs() < 1e-6;
        (!sound).then_some("the active mount or the upward direction is not finite")
    }

    fn attempt(&self, samples: &[FrameSample]) -> FrameReport<SensorMountResult> {
        let rows = self.rows(samples);
        let have = rows.len();
        let min = self.limits.min;
        if have < min {
            return FrameReport::nothing(have, FrameCause::TooFew { have, min });
        }
        let spread = spread(&rows);
        if below(spread, MIN_SPREAD) {
            return FrameReport::nothing(have, FrameCause::OnePlane { spread, min: MIN_SPREAD });
        }
        if let Some(mistake) = self.mirrored(&rows) {
            return FrameReport::nothing(have, FrameCause::Mistake { mistake });
        }
        let weightless = |weight_n, min_n| FrameReport::nothing(have, FrameCause::Weightless { weight_n, min_n });
        let Some(found) = examined(&WeightFit { sign: 1.0 }, &rows) else { return weightless(0.0, MIN_WEIGHT_N) };
        let kept: Vec<SensorMountRow> = found.kept.iter().map(|&i| rows[i]).collect();
        let weighed = found.model;
        // Seven unknowns: rotation, weight and bias.
        let freedom = (3 * kept.len()).saturating_sub(7).max(1);
        let squares_n2: f64 = kept.iter().map(|row| weighed.error_n(row).norm_squared()).sum();
        let variance_n2 = squares_n2 / freedom as f64;
        let min_n = MIN_WEIGHT_N.max(MIN_SIGNAL * variance_n2.sqrt());
        if below(weighed.weight_n, min_n) {
            return weightless(weighed.weight_n, min_n);
        }
        let region = turn_covariance(&kept, &weighed, variance_n2);
        let angle_deg = region.map(|region| radius_95(&region, freedom).to_degrees());
        let report = FrameReport::of(have, found, Sizes { place_m: None, angle_deg }, self.found(&weighed));
        report.judged(&self.limits)
    }

    fn mistakes(&self) -> Vec<(Mistake, Carrier)> {
        vec![(Mistake::SwappedArm, Carrier::Flange), (Mistake::InverseRotation, Carrier::Flange)]
    }
}

impl SensorMount {
    fn found(&self, weighed: &WeightModel) -> SensorMountResult {
        let turn = Rotation3::from_matrix_unchecked(weighed.turn.transpose());
        let flange_from_s1 = UnitQuaternion::from_rotation_matrix(&turn);
        let measured_from_expected = weighed.turn * self.active.to_rotation_matrix().into_inner();
        SensorMountResult {
            flange_from_s1_wxyz: wxyz(&flange_from_s1),
            from_active_deg: flange_from_s1.angle_to(&self.active).to_degrees(),
            axes: SignedAxes::nearest(&measured_from_expected),
            mass_kg: weighed.weight_n / GRAVITY_M_S2,
            bias_n: weighed.bias_n.into(),
        }
    }

    /// Detects forces that fit only in a mirror: an axis has the wrong sign, or two axes are swapped, which no mount
    /// can cause.
    fn mirrored(&self, rows: &[SensorMountRow]) -> Option<Mistake> {
        let error = |sign| {
            let found = WeightModel::of(rows, sign)?;
            let mut squares: Vec<f64> = rows.iter().map(|row| found.error_n(row).norm_squared()).collect();
            // The median, so that a single pose in which the tool was touched has no influence.
            let middle = squares.len() / 2;
            Some((*squares.select_nth_unstable_by(middle, f64::total_cmp).1, found))
        };
        let (mirror, found) = error(-1.0)?;
        // If no rotation yields a weight, only the mirror image remains.
        let turn = error(1.0).map_or(f64::INFINITY, |(turn, _)| turn);
        // Squared, because the errors are squares.
        if mirror >= MIRROR_FRACTION * MIRROR_FRACTION * turn {
            return None;
        }
        let measured_from_expected = found.turn * self.active.to_rotation_matrix().into_inner();
        Some(SignedAxes::nearest(&measured_from_expected).map_or(Mistake::Mirrored, Mistake::WrongAxes))
    }
}

/// Returns the covariance of the rotation (rotation vector in `s1`, rad), estimated together with the bias.
fn turn_covariance(rows: &[SensorMountRow], weighed: &WeightModel, variance_n2: f64) -> Option<Matrix3<f64>> {
    let slopes: Vec<Matrix3<f64>> =
        rows.iter().map(|row| -(weighed.turn * row.down * weighed.weight_n).cross_matrix()).collect();
    let mean = slopes.iter().sum::<Matrix3<f64>>() / rows.len() as f64;
    let normal: Matrix3<f64> = slopes.iter().map(|slope| (slope - mean).transpose() * (slope - mean)).sum();
    Some(normal.cholesky()?.inverse() * variance_n2)
}
