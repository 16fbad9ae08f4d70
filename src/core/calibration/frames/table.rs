//! The table: origin and plane of the workspace from points touched with the tip.
//!
//! The first point is the origin, the second is along +x, and the third is on the side of +y; further points may be
//! anywhere on the plane and verify it. The plane is the least-squares fit to all points.

use nalgebra::{Isometry3, Matrix3, Point3, Rotation3, SymmetricEigen, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

use super::{
    Calibration, CalibrationSource, Carrier, FrameCause, FrameCoverage, FrameLimits, FrameReport, FrameSample,
    MissingMotion, Mistake, Sizes, StoredPose,
    examine::{Problem, RowMiss, examined},
    record::CalibrationResult,
    report::finite,
    spread::{principal, radius_95},
};
use crate::calibration::Verdict;

/// Minimum distance between two points, m, so that a tip that rests does not fill the session with equal points.
/// Design choice.
const APART_M: f64 = 0.02;
/// Minimum root mean square spread of the points along the second axis of their plane, m; and of a complete session.
/// Points on one line do not determine the plane: it could turn about that line, because only rounding would hold it.
const MIN_SPREAD_M: f64 = 0.015;
const PLENTY_SPREAD_M: f64 = 0.03;
const PLENTY: usize = 6;
/// Noise of a touch per axis, m, and the degrees of freedom of this prior, which is needed because few points do not
/// determine their own noise.
const NOISE_M: f64 = 0.35e-3;
const NOISE_FREEDOM: usize = 8;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TableSettings {
    /// Source of the tip's pose: marker or flange.
    pub carrier: Carrier,
    /// The tip in the frame of the marker or of the flange, m.
    pub tip_in_carrier_m: Vector3<f64>,
    /// Upward direction in the frame of the camera or of the base, if known. A table whose z axis points down is then
    /// rejected, because its x and y axes must have been swapped.
    pub up: Option<Vector3<f64>>,
    pub limits: FrameLimits,
}

impl TableSettings {
    /// Creates the settings for the arm's joints, with the tip at this position in the flange's frame (m) and this
    /// upward direction in the base's frame.
    pub const fn by_arm(tip_in_flange_m: Vector3<f64>, up_in_base: Vector3<f64>) -> Self {
        Self::of(Carrier::Flange, tip_in_flange_m, Some(up_in_base))
    }

    /// Creates the settings for the tracker, with the tip at this position in the marker's frame (m).
    pub const fn by_tracker(tip_in_m_m: Vector3<f64>) -> Self {
        Self::of(Carrier::Marker, tip_in_m_m, None)
    }

    const fn of(carrier: Carrier, tip_in_carrier_m: Vector3<f64>, up: Option<Vector3<f64>>) -> Self {
        let held_out = Sizes::place(2.0e-3);
        let uncertainty = Sizes::both(3.0e-3, 2.0);
        Self { carrier, tip_in_carrier_m, up, limits: FrameLimits { min: 4, held_out, uncertainty, outliers: 0.25 } }
    }

    fn tip_m(&self, sample: &FrameSample) -> Option<Vector3<f64>> {
        Some((sample.pose(self.carrier)? * Point3::from(self.tip_in_carrier_m)).coords)
    }

    fn points(&self, samples: &[FrameSample]) -> Vec<Vector3<f64>> {
        samples.iter().filter_map(|sample| self.tip_m(sample)).collect()
    }
}

/// A calibrated table, in the frame of the camera or of the arm's base.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TableResult {
    /// Source of the points: marker (frame of the camera) or flange (frame of the base).
    pub carrier: Carrier,
    /// `c_from_table` or `base_from_table`: origin, x along the first two points, z up from the plane.
    pub from_table: StoredPose,
}

impl CalibrationResult for TableResult {
    const KIND: &'static str = "table";

    fn fault(&self) -> Option<&'static str> {
        self.from_table.fault()
    }
}

/// A plane through `middle_m`.
struct FittedPlane {
    middle_m: Vector3<f64>,
    normal: Vector3<f64>,
}

struct Touches;

impl Problem for Touches {
    type Row = Vector3<f64>;
    type Model = FittedPlane;
    /// Three points determine a plane.
    const HYPOTHESIS: usize = 3;
    const FLOOR: RowMiss = RowMiss::of_place(2.0e-3);

    fn solve(&self, rows: &[Vector3<f64>]) -> Option<FittedPlane> {
        if rows.len() < 3 {
            return None;
        }
        let (middle_m, scatter) = scatter(rows);
        let eigen = SymmetricEigen::try_new(scatter, f64::EPSILON, 100)?;
        Some(FittedPlane { middle_m, normal: eigen.eigenvectors.column(eigen.eigenvalues.imin()).into_owned() })
    }

    fn miss(&self, plane: &FittedPlane, row: &Vector3<f64>) -> RowMiss {
        RowMiss::of_place((row - plane.middle_m).dot(&plane.normal).abs())
    }
}

/// Returns the mean of the points, and the mean outer product of their distances from it.
fn scatter(points: &[Vector3<f64>]) -> (Vector3<f64>, Matrix3<f64>) {
    let fraction = 1.0 / points.len().max(1) as f64;
    let middle = points.iter().sum::<Vector3<f64>>() * fraction;
    (
        middle,
        points.iter().map(|point| (point - middle) * (point - middle).transpose()).sum::<Matrix3<f64>>() * fraction,
    )
}

/// Returns the spread of the points along the second axis of their plane, m.
fn second_spread_m(points: &[Vector3<f64>]) -> f64 {
    let (middle, _) = scatter(points);
    let from_middle: Vec<Vector3<f64>> = points.iter().map(|point| point - middle).collect();
    principal(&from_middle)[1]
}

/// Returns the axes of the table from its plane and the three points that define them; `None` if these are on one line.
fn axes(plane: &FittedPlane, [origin, along, beside]: [Vector3<f64>; 3]) -> Option<Isometry3<f64>> {
    let onto = |v: Vector3<f64>| v - plane.normal * v.dot(&plane.normal);
    // Half the minimum distance of two points: a shorter vector has no reliable direction.
    let x = onto(along - origin).try_normalize(APART_M / 2.0)?;
    let way = onto(beside - origin);
    let y = (way - x * way.dot(&x)).try_normalize(APART_M / 2.0)?;
    let turn = Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[x, y, x.cross(&y)]));
    let place = origin - plane.normal * (origin - plane.middle_m).dot(&plane.normal);
    Some(Isometry3::from_parts(place.into(), UnitQuaternion::from_rotation_matrix(&turn)))
}

impl Calibration for TableSettings {
    type Solution = TableResult;

    fn needs(&self) -> Vec<CalibrationSource> {
        vec![self.carrier.source()]
    }

    fn carrier(&self) -> Carrier {
        self.carrier
    }

    fn differs(&self, sample: &FrameSample, taken: &[FrameSample]) -> bool {
        self.tip_m(sample).is_some_and(|tip_m| self.points(taken).iter().all(|point| (point - tip_m).norm() >= APART_M))
    }

    fn coverage(&self, taken: &[FrameSample]) -> FrameCoverage {
        let points = self.points(taken);
        let (middle, _) = scatter(&points);
        let from_middle: Vec<Vector3<f64>> = points.iter().map(|point| point - middle).collect();
        let [first, second, _] = principal(&from_middle);
        FrameCoverage::min([
            (points.len() as f64 / PLENTY as f64, MissingMotion::Poses),
            (first / PLENTY_SPREAD_M, MissingMotion::Distance),
            (second / PLENTY_SPREAD_M, MissingMotion::Beside),
        ])
    }

    fn fault(&self) -> Option<&'static str> {
        let sound = finite(&self.tip_in_carrier_m) && self.up.is_none_or(|up| finite(&up) && up.norm() > 0.0);
        (!sound).then_some("the tip or the upward direction is not finite")
    }

    fn attempt(&self, samples: &[FrameSample]) -> FrameReport<TableResult> {
        let points = self.points(samples);
        let have = points.len();
        let collinear = |spread| FrameReport::nothing(have, FrameCause::Collinear { spread, min: MIN_SPREAD_M });
        let &[origin, along, beside, ..] = points.as_slice() else {
            return FrameReport::nothing(have, FrameCause::TooFew { have, min: self.limits.min });
        };
        let wide = |points: &[Vector3<f64>]| second_spread_m(points) >= MIN_SPREAD_M;
        if !wide(&points) {
            return collinear(second_spread_m(&points));
        }
        let Some(found) = examined(&Touches, &points) else { return collinear(0.0) };
        let kept: Vec<Vector3<f64>> = found.kept.iter().map(|&i| points[i]).collect();
        // The points that define the axes must be on the plane, and the remaining points must not be collinear apart
        // from a single one.
        let alone = (0..kept.len()).any(|i| {
            let others: Vec<Vector3<f64>> = kept.iter().enumerate().filter(|(j, _)| *j != i).map(|(_, p)| *p).collect();
            kept.len() > 3 && second_spread_m(&others) < 0.5 * MIN_SPREAD_M
        });
        if alone || !wide(&kept) {
            return collinear(second_spread_m(&kept));
        }
        let Some(from_table) = axes(&found.model, [origin, along, beside]) else { return collinear(0.0) };
        let value = TableResult { carrier: self.carrier, from_table: StoredPose::of(&from_table) };
        let uncertainty = uncertainty(&kept, found.squares_m2(), (along - origin).norm());
        let lost = found.outliers.iter().find(|&&i| i < 3).copied();
        let report = FrameReport::of(have, found, uncertainty, value).judged(&self.limits);
        if lost.is_some() {
            return report.because(FrameCause::Outliers { fraction: 1.0 / 3.0, max: 0.0 });
        }
        let z = from_table.rotation * Vector3::z();
        let down = self.up.is_some_and(|up| up.dot(&z) < 0.0);
        if down && report.verdict == Verdict::Accepted {
            return report.because(FrameCause::Mistake { mistake: Mistake::Mirrored });
        }
        report
    }

    fn mistakes(&self) -> Vec<(Mistake, Carrier)> {
        vec![(Mistake::swapped(self.carrier), self.carrier)]
    }
}

/// Returns the half lengths of the 95 % intervals of the origin and of the table's orientation (tilt of the plane,
/// rotation of x in it).
fn uncertainty(points: &[Vector3<f64>], squares_m2: f64, x_m: f64) -> Sizes {
    let freedom = points.len().saturating_sub(3) + NOISE_FREEDOM;
    let variance_m2 = (squares_m2 + NOISE_FREEDOM as f64 * NOISE_M * NOISE_M) / freedom as f64;
    let spread_m = second_spread_m(points);
    // Variances about the normal (two touches define x) and about x, the less certain axis of the tilt.
    let about_normal = 2.0 * variance_m2 / (x_m * x_m);
    let tilt = variance_m2 / (points.len() as f64 * spread_m * spread_m);
    let turn = Matrix3::from_diagonal(&Vector3::new(tilt, tilt, about_normal));
    let place = Matrix3::from_diagonal_element(variance_m2);
    Sizes { place_m: Some(radius_95(&place, freedom)), angle_deg: Some(radius_95(&turn, freedom).to_degrees()) }
}
