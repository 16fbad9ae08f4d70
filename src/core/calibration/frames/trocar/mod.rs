//! The trocar: the point about which the instrument pivots, from lines of its shaft; and monitoring of it afterwards.
//!
//! The least-squares point `x` for all lines (point `p_i`, direction `d_i`) solves `sum (I - d_i d_i^T) (x - p_i) = 0`.

mod watch;

use nalgebra::{Isometry3, Matrix3, Point3, Vector3};
use serde::{Deserialize, Serialize};

use super::{
    Calibration, CalibrationSource, Carrier, FrameCause, FrameCoverage, FrameLimits, FrameReport, FrameSample,
    MissingMotion, Mistake, Sizes,
    examine::{Problem, RowMiss, examined},
    record::{CalibrationResult, place_fault},
    report::finite,
    spread::{below, ellipsoid_95},
};
use crate::kinematics::Arm;
pub use watch::{TrocarState, TrocarWatch};

/// Minimum root mean square tilt of the lines from their mean, degrees. At that tilt an error of 0.25 mm across the
/// lines becomes 3.6 mm along them.
const MIN_TILT_DEG: f64 = 4.0;
/// Minimum angle between two lines, rad: 2 degrees, so that a shaft that hardly moves does not fill the session with
/// equal lines. Design choice.
const APART_RAD: f64 = 0.035;
/// A session is complete with this number of lines. With 40, 95 % of 200 simulated calibrations with a tracker have an
/// error of at most 0.36 mm (`docs/results/frames.md`).
const PLENTY: usize = 40;
const PLENTY_TILT_DEG: f64 = 10.0;

/// The axis of the instrument's shaft.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShaftLine {
    pub point_m: Vector3<f64>,
    /// Direction of the shaft towards the tip, unit length.
    pub direction: Vector3<f64>,
}

impl ShaftLine {
    /// Returns the shaft in the flange's frame, from the mount of the wrist sensor: its z axis.
    pub fn of_arm(arm: &Arm) -> Self {
        let flange_from_s1 = arm.flange_from_s1();
        Self { point_m: flange_from_s1.translation.vector, direction: flange_from_s1.rotation * Vector3::z() }
    }

    #[must_use]
    pub fn in_frame(&self, target_from_source: &Isometry3<f64>) -> Self {
        let point_m = (target_from_source * Point3::from(self.point_m)).coords;
        Self { point_m, direction: target_from_source.rotation * self.direction }
    }

    /// Returns the vector from a point to the nearest point of the line, m.
    pub fn miss_m(&self, point_m: &Vector3<f64>) -> Vector3<f64> {
        across(&self.direction) * (self.point_m - point_m)
    }
}

/// Returns `I - d d^T`, which projects a vector across a direction.
fn across(direction: &Vector3<f64>) -> Matrix3<f64> {
    Matrix3::identity() - direction * direction.transpose()
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrocarSettings {
    /// Source of the shaft's pose: marker or flange.
    pub carrier: Carrier,
    /// The shaft in the frame of the marker or of the flange.
    pub shaft: ShaftLine,
    pub limits: FrameLimits,
}

impl TrocarSettings {
    pub fn by_arm(arm: &Arm) -> Self {
        Self::of(Carrier::Flange, ShaftLine::of_arm(arm))
    }

    /// Creates the settings for the tracker, with the hand-eye calibration `flange_from_m`.
    pub fn by_tracker(arm: &Arm, flange_from_m: &Isometry3<f64>) -> Self {
        Self::of(Carrier::Marker, ShaftLine::of_arm(arm).in_frame(&flange_from_m.inverse()))
    }

    fn of(carrier: Carrier, shaft: ShaftLine) -> Self {
        let limits =
            FrameLimits { min: 30, held_out: Sizes::place(2.0e-3), uncertainty: Sizes::place(1.0e-3), outliers: 0.25 };
        Self { carrier, shaft, limits }
    }

    /// Returns the shaft in the frame of the camera or of the arm's base; `None` if the sample lacks the pose.
    pub fn line(&self, sample: &FrameSample) -> Option<ShaftLine> {
        Some(self.shaft.in_frame(sample.pose(self.carrier)?))
    }

    fn lines<'a>(&'a self, samples: &'a [FrameSample]) -> impl Iterator<Item = ShaftLine> + 'a {
        samples.iter().filter_map(|sample| self.line(sample))
    }
}

/// A calibrated trocar, in the frame of the camera or of the arm's base.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrocarResult {
    /// Source of the lines: marker (frame of the camera) or flange (frame of the base).
    pub carrier: Carrier,
    pub trocar_m: [f64; 3],
    /// Mean direction of the shaft, into the body; unit length.
    pub inward: [f64; 3],
    /// Half axes of the 95 % ellipsoid, the longest first, m.
    pub ellipsoid_m: [[f64; 3]; 3],
}

impl CalibrationResult for TrocarResult {
    const KIND: &'static str = "trocar";

    fn fault(&self) -> Option<&'static str> {
        let unit = (Vector3::from(self.inward).norm() - 1.0).abs() < 1e-6;
        let fault = self.ellipsoid_m.iter().chain([&self.trocar_m]).find_map(place_fault);
        fault.or((!unit).then_some("inward does not have length one"))
    }
}

struct Centre {
    point_m: Vector3<f64>,
    /// Covariance for a variance of one across each line.
    covariance: Matrix3<f64>,
}

struct ShaftLines;

impl Problem for ShaftLines {
    type Row = ShaftLine;
    type Model = Centre;
    const HYPOTHESIS: usize = 4;
    const FLOOR: RowMiss = RowMiss::of_place(1.5e-3);

    fn solve(&self, rows: &[ShaftLine]) -> Option<Centre> {
        let mut normal = Matrix3::zeros();
        let mut right = Vector3::zeros();
        for row in rows {
            let across = across(&row.direction);
            normal += across;
            right += across * row.point_m;
        }
        let covariance = normal.cholesky()?.inverse();
        Some(Centre { point_m: covariance * right, covariance })
    }

    fn miss(&self, centre: &Centre, row: &ShaftLine) -> RowMiss {
        RowMiss::of_place(row.miss_m(&centre.point_m).norm())
    }
}

/// Returns the root mean square tilt of lines from their mean direction, degrees.
fn tilt_deg(lines: impl Iterator<Item = ShaftLine>) -> f64 {
    let mut sum = Matrix3::zeros();
    let mut count = 0.0;
    for line in lines {
        sum += across(&line.direction);
        count += 1.0;
    }
    if count == 0.0 {
        return 0.0;
    }
    libm::asin((sum / count).symmetric_eigenvalues().min().max(0.0).sqrt()).to_degrees()
}

impl Calibration for TrocarSettings {
    type Solution = TrocarResult;

    fn needs(&self) -> Vec<CalibrationSource> {
        vec![self.carrier.source()]
    }

    fn carrier(&self) -> Carrier {
        self.carrier
    }

    /// Lines are recorded in motion, because all joints are read at one moment, and so is a marker.
    fn hold_s(&self) -> f64 {
        0.0
    }

    fn differs(&self, sample: &FrameSample, taken: &[FrameSample]) -> bool {
        self.line(sample)
            .is_some_and(|line| self.lines(taken).all(|other| other.direction.angle(&line.direction) >= APART_RAD))
    }

    fn coverage(&self, taken: &[FrameSample]) -> FrameCoverage {
        FrameCoverage::min([
            (taken.len() as f64 / PLENTY as f64, MissingMotion::Poses),
            (tilt_deg(self.lines(taken)) / PLENTY_TILT_DEG, MissingMotion::Tilt),
        ])
    }

    fn fault(&self) -> Option<&'static str> {
        let unit = (self.shaft.direction.norm() - 1.0).abs() < 1e-6;
        (!(unit && finite(&self.shaft.point_m)))
            .then_some("the shaft's line is not finite, or its direction does not have length one")
    }

    fn attempt(&self, samples: &[FrameSample]) -> FrameReport<TrocarResult> {
        let rows: Vec<ShaftLine> = self.lines(samples).collect();
        let have = rows.len();
        let min = self.limits.min;
        if have < min {
            return FrameReport::nothing(have, FrameCause::TooFew { have, min });
        }
        let parallel = |rows: &mut dyn Iterator<Item = ShaftLine>| {
            let tilt_deg = tilt_deg(rows);
            below(tilt_deg, MIN_TILT_DEG).then_some(FrameCause::NearlyParallel { tilt_deg, min_deg: MIN_TILT_DEG })
        };
        if let Some(cause) = parallel(&mut rows.iter().copied()) {
            return FrameReport::nothing(have, cause);
        }
        let Some(found) = examined(&ShaftLines, &rows) else {
            return FrameReport::nothing(have, FrameCause::NearlyParallel { tilt_deg: 0.0, min_deg: MIN_TILT_DEG });
        };
        // Tested again without the outliers, because they may have been the only tilted lines.
        if let Some(cause) = parallel(&mut found.kept.iter().map(|&i| rows[i])) {
            return FrameReport::nothing(have, cause);
        }
        let freedom = (2 * found.kept.len()).saturating_sub(3).max(1);
        let axes = ellipsoid_95(&(found.model.covariance * (found.squares_m2() / freedom as f64)), freedom);
        // The sum, not the mean: only its direction is used.
        let inward: Vector3<f64> = found.kept.iter().map(|&i| rows[i].direction).sum();
        let value = TrocarResult {
            carrier: self.carrier,
            trocar_m: found.model.point_m.into(),
            inward: inward.normalize().into(),
            ellipsoid_m: axes.map(Into::into),
        };
        let uncertainty = Sizes::place(axes[0].norm());
        FrameReport::of(have, found, uncertainty, value).judged(&self.limits)
    }

    fn mistakes(&self) -> Vec<(Mistake, Carrier)> {
        Mistake::of_pivoting(self.carrier).map(|mistake| (mistake, self.carrier)).to_vec()
    }
}
