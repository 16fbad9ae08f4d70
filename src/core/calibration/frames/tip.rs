//! Pivot calibration: the tip in the frame of its marker, or of the arm's flange, from poses while the tip stays in a
//! dimple.
//!
//! With the pose `(R_i, p_i)` of the carrier, the tip `t` in it and the dimple `b`, `R_i t + p_i = b` for all i. Both
//! follow from one linear least-squares problem: the algebraic one-step method (Yaniv, "Which pivot calibration?",
//! Proc. SPIE 9415, 2015). A consensus first removes the poses in which the tip had left the dimple.

use nalgebra::{Isometry3, Matrix3, Vector3};
use serde::{Deserialize, Serialize};

use super::{
    Calibration, CalibrationSource, Carrier, FrameCause, FrameCoverage, FrameLimits, FrameReport, FrameSample,
    MissingMotion, Mistake, Sizes,
    examine::{Problem, RowMiss, examined},
    record::{CalibrationResult, place_fault},
    spread::{Turns, lever_matrix, radius_95},
};
use crate::calibration::Verdict;

/// Minimum rotation between two poses, rad: 4 degrees, so that a person who hardly moves does not fill the session with
/// equal poses. Design choice.
pub(super) const APART_RAD: f64 = 0.07;
/// A session is complete with this number of poses, and with these rotations in degrees. With 20 poses, 95 % of 200
/// simulated calibrations with a tracker have an error of at most 0.40 mm (`docs/results/frames.md`).
const PLENTY: usize = 20;
const PLENTY_DEG: f64 = 15.0;
const PLENTY_SECOND_DEG: f64 = 10.0;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TipSettings {
    /// The carrier that moves about the tip: marker or flange.
    pub carrier: Carrier,
    pub limits: FrameLimits,
}

impl TipSettings {
    /// Creates the settings for the tip in the marker's frame, with the tracker.
    pub const fn by_tracker() -> Self {
        let limits =
            FrameLimits { min: 12, held_out: Sizes::place(1.5e-3), uncertainty: Sizes::place(1.0e-3), outliers: 0.25 };
        Self { carrier: Carrier::Marker, limits }
    }

    /// Creates the settings for the tip in the flange's frame, with the arm alone. An arm is less accurate than a
    /// tracker.
    pub const fn by_arm() -> Self {
        let tracker = Self::by_tracker();
        let held_out = Sizes::place(2.5e-3);
        Self { carrier: Carrier::Flange, limits: FrameLimits { held_out, ..tracker.limits } }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TipResult {
    pub carrier: Carrier,
    /// The tip in the frame of the marker or of the flange, m.
    pub tip_in_carrier_m: [f64; 3],
    /// The dimple in the frame of the camera or of the arm's base, m.
    pub pivot_m: [f64; 3],
}

impl CalibrationResult for TipResult {
    const KIND: &'static str = "tip";

    fn fault(&self) -> Option<&'static str> {
        place_fault(&self.tip_in_carrier_m).or_else(|| place_fault(&self.pivot_m))
    }
}

#[derive(Clone, Copy, Debug)]
struct Pivot {
    tip_m: Vector3<f64>,
    dimple_m: Vector3<f64>,
    /// Covariance of the tip, for a variance of one per axis and pose.
    covariance: Matrix3<f64>,
}

struct PivotFit;

impl Problem for PivotFit {
    type Row = Isometry3<f64>;
    type Model = Pivot;
    const HYPOTHESIS: usize = 4;
    const FLOOR: RowMiss = RowMiss::of_place(1.5e-3);

    fn solve(&self, rows: &[Isometry3<f64>]) -> Option<Pivot> {
        let fraction = 1.0 / rows.len() as f64;
        let mut turn = Matrix3::zeros();
        let mut place_m = Vector3::zeros();
        let mut seen_m = Vector3::zeros();
        for row in rows {
            turn += row.rotation.to_rotation_matrix().into_inner() * fraction;
            place_m += row.translation.vector * fraction;
            seen_m += row.rotation.inverse() * row.translation.vector * fraction;
        }
        let inverse = lever_matrix(rows.iter())?.cholesky()?.inverse();
        let tip_m = inverse * (turn.transpose() * place_m - seen_m);
        let dimple_m = turn * tip_m + place_m;
        Some(Pivot { tip_m, dimple_m, covariance: inverse * fraction })
    }

    fn miss(&self, pivot: &Pivot, row: &Isometry3<f64>) -> RowMiss {
        RowMiss::of_place((row.rotation * pivot.tip_m + row.translation.vector - pivot.dimple_m).norm())
    }
}

impl Calibration for TipSettings {
    type Solution = TipResult;

    fn needs(&self) -> Vec<CalibrationSource> {
        vec![self.carrier.source()]
    }

    fn carrier(&self) -> Carrier {
        self.carrier
    }

    fn differs(&self, sample: &FrameSample, taken: &[FrameSample]) -> bool {
        turned(sample, taken, self.carrier)
    }

    fn coverage(&self, taken: &[FrameSample]) -> FrameCoverage {
        of_turns(taken, self.carrier)
    }

    fn attempt(&self, samples: &[FrameSample]) -> FrameReport<TipResult> {
        let rows: Vec<Isometry3<f64>> =
            samples.iter().filter_map(|sample| sample.pose(self.carrier)).copied().collect();
        let have = rows.len();
        let min = self.limits.min;
        if have < min {
            return FrameReport::nothing(have, FrameCause::TooFew { have, min });
        }
        if let Some(cause) = Turns::of(rows.iter()).lacking() {
            return FrameReport::nothing(have, cause);
        }
        let Some(found) = examined(&PivotFit, &rows) else {
            return FrameReport::nothing(have, FrameCause::OneAxis { second_deg: 0.0, min_deg: 0.0 });
        };
        if let Some(cause) = Turns::of(found.kept.iter().map(|&i| &rows[i])).lacking() {
            return FrameReport::nothing(have, cause);
        }
        let freedom = (3 * found.kept.len()).saturating_sub(6).max(1);
        let radius_m = radius_95(&(found.model.covariance * (found.squares_m2() / freedom as f64)), freedom);
        let Pivot { tip_m, dimple_m, .. } = found.model;
        let value = TipResult { carrier: self.carrier, tip_in_carrier_m: tip_m.into(), pivot_m: dimple_m.into() };
        let uncertainty = Sizes::place(radius_m);
        let report = FrameReport::of(have, found, uncertainty, value).judged(&self.limits);
        // Inverted poses fit as well, with tip and dimple swapped; but a camera is always farther away than an
        // instrument is long.
        let exchanged = self.carrier == Carrier::Marker && tip_m.norm() > dimple_m.norm();
        if exchanged && report.verdict == Verdict::Accepted {
            return report.because(FrameCause::Mistake { mistake: Mistake::InversePose });
        }
        report
    }

    fn mistakes(&self) -> Vec<(Mistake, Carrier)> {
        let shown = Mistake::of_pivoting(self.carrier).into_iter().filter(|&mistake| mistake != Mistake::InversePose);
        shown.map(|mistake| (mistake, self.carrier)).collect()
    }
}

/// Returns whether a carrier is turned relative to every pose already taken.
pub(super) fn turned(sample: &FrameSample, taken: &[FrameSample], carrier: Carrier) -> bool {
    let Some(pose) = sample.pose(carrier) else { return false };
    let mut others = taken.iter().filter_map(|sample| sample.pose(carrier));
    others.all(|other| other.rotation.angle_to(&pose.rotation) >= APART_RAD)
}

/// Returns the coverage by poses and their turns.
pub(super) fn of_turns(taken: &[FrameSample], carrier: Carrier) -> FrameCoverage {
    let turns = Turns::of(taken.iter().filter_map(|sample| sample.pose(carrier)));
    FrameCoverage::min([
        (taken.len() as f64 / PLENTY as f64, MissingMotion::Poses),
        (turns.max_deg / PLENTY_DEG, MissingMotion::Turns),
        (turns.min_deg / PLENTY_SECOND_DEG, MissingMotion::SecondAxis),
    ])
}
