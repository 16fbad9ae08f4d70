//! Hand-eye calibration: finds the poses of the marker on the flange and of the tracker next to the arm simultaneously.
//!
//! In every pose `base_from_flange * flange_from_m = base_from_c * c_from_m`, in short `A X = Y B`. A published solver
//! gives the start ([`HandEyeSolver`]); a Gauss-Newton method on the rigid motions refines it, with the errors weighted by a
//! tracker's noise. The errors are evaluated at the tip: its position from the tracker is compared with its position
//! from the joints.

mod refine;
mod solvers;

use nalgebra::{Isometry3, Point3, Vector3};
use serde::{Deserialize, Serialize};

use self::refine::RefinedFrames;
use super::{
    Calibration, CalibrationSource, Carrier, FrameCause, FrameCoverage, FrameLimits, FrameReport, FrameSample, Mistake,
    Sizes, StoredPose,
    examine::{Problem, RowMiss, examined},
    record::CalibrationResult,
    report::finite,
    spread::{Turns, radius_95},
    tip::{of_turns, turned},
};

/// Published solver that gives the start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HandEyeSolver {
    /// Park and Martin, "Robot sensor calibration: solving AX = XB on the Euclidean group", IEEE Trans. Robot. Autom. 10, 1994:
    /// `X` from the motions between all pairs of poses, then `Y` as a mean.
    ParkMartin,
    /// Shah, "Solving the robot-world/hand-eye calibration problem using the Kronecker product", J. Mech. Robot. 5,
    /// 2013: both rotations from one singular vector, then both positions.
    Shah,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HandEyeSettings {
    /// The tip in the flange's frame, m, where the errors are evaluated.
    pub tip_in_flange_m: Vector3<f64>,
    pub solver: HandEyeSolver,
    pub refine: bool,
    pub limits: FrameLimits,
}

impl HandEyeSettings {
    /// Creates the settings for an instrument with its tip at this position in the flange's frame, m.
    pub const fn new(tip_in_flange_m: Vector3<f64>) -> Self {
        let limits = FrameLimits {
            min: 10,
            held_out: Sizes::both(2.0e-3, 0.4),
            uncertainty: Sizes::both(1.0e-3, 0.2),
            outliers: 0.25,
        };
        Self { tip_in_flange_m, solver: HandEyeSolver::Shah, refine: true, limits }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HandEyeResult {
    /// The marker on the flange.
    pub flange_from_m: StoredPose,
    /// The tracker's camera in the frame of the arm's base.
    pub base_from_c: StoredPose,
}

impl CalibrationResult for HandEyeResult {
    const KIND: &'static str = "hand_eye";

    fn fault(&self) -> Option<&'static str> {
        self.flange_from_m.fault().or_else(|| self.base_from_c.fault())
    }
}

/// `A` and `B` of one pose.
#[derive(Clone, Copy, Debug)]
pub(super) struct HandEyeRow {
    base_from_flange: Isometry3<f64>,
    c_from_m: Isometry3<f64>,
}

/// `X` and `Y`.
#[derive(Clone, Copy, Debug)]
pub(super) struct HandEyeFrames {
    flange_from_m: Isometry3<f64>,
    base_from_c: Isometry3<f64>,
}

impl Problem for HandEyeSettings {
    type Row = HandEyeRow;
    type Model = HandEyeFrames;
    const HYPOTHESIS: usize = 4;
    /// Rows within this distance fit, whatever the median says: noise of tracker and arm together, at the tip.
    const FLOOR: RowMiss = RowMiss { place_m: Some(2.0e-3), angle_rad: Some(0.006) };

    /// The cheaper solver, because a random hypothesis only has to separate good rows from bad ones.
    fn guess(&self, rows: &[HandEyeRow]) -> Option<HandEyeFrames> {
        solvers::park_martin(rows)
    }

    fn solve(&self, rows: &[HandEyeRow]) -> Option<HandEyeFrames> {
        let start = match self.solver {
            HandEyeSolver::ParkMartin => solvers::park_martin(rows),
            HandEyeSolver::Shah => solvers::shah(rows),
        }?;
        Some(if self.refine { refine::refined(rows, start)?.frames } else { start })
    }

    fn miss(&self, frames: &HandEyeFrames, row: &HandEyeRow) -> RowMiss {
        let seen = frames.base_from_c * row.c_from_m * frames.flange_from_m.inverse();
        let tip_m = Point3::from(self.tip_in_flange_m);
        // At the tip, because an error of the frames matters there.
        let place_m = (seen * tip_m - row.base_from_flange * tip_m).norm();
        RowMiss { place_m: Some(place_m), angle_rad: Some(seen.rotation.angle_to(&row.base_from_flange.rotation)) }
    }
}

impl Calibration for HandEyeSettings {
    type Solution = HandEyeResult;

    fn needs(&self) -> Vec<CalibrationSource> {
        vec![CalibrationSource::Flange, CalibrationSource::Marker]
    }

    fn carrier(&self) -> Carrier {
        Carrier::Flange
    }

    fn differs(&self, sample: &FrameSample, taken: &[FrameSample]) -> bool {
        turned(sample, taken, Carrier::Flange)
    }

    fn coverage(&self, taken: &[FrameSample]) -> FrameCoverage {
        of_turns(taken, Carrier::Flange)
    }

    fn fault(&self) -> Option<&'static str> {
        (!finite(&self.tip_in_flange_m)).then_some("the tip in the flange's frame is not finite")
    }

    fn attempt(&self, samples: &[FrameSample]) -> FrameReport<HandEyeResult> {
        let row = |sample: &FrameSample| {
            Some(HandEyeRow { base_from_flange: sample.base_from_flange?, c_from_m: sample.c_from_m? })
        };
        let rows: Vec<HandEyeRow> = samples.iter().filter_map(row).collect();
        let have = rows.len();
        let min = self.limits.min;
        if have < min {
            return FrameReport::nothing(have, FrameCause::TooFew { have, min });
        }
        if let Some(cause) = lacking(&rows) {
            return FrameReport::nothing(have, cause);
        }
        let Some(found) = examined(self, &rows) else {
            return FrameReport::nothing(have, FrameCause::OneAxis { second_deg: 0.0, min_deg: 0.0 });
        };
        let kept: Vec<HandEyeRow> = found.kept.iter().map(|&i| rows[i]).collect();
        if let Some(cause) = lacking(&kept) {
            return FrameReport::nothing(have, cause);
        }
        let uncertainty = self.uncertainty(&kept, found.model);
        let HandEyeFrames { flange_from_m, base_from_c } = found.model;
        let value =
            HandEyeResult { flange_from_m: StoredPose::of(&flange_from_m), base_from_c: StoredPose::of(&base_from_c) };
        FrameReport::of(have, found, uncertainty, value).judged(&self.limits)
    }

    /// If arm and marker belong to different sides, and both sides move, either could be the wrong one; the marker is
    /// reported. If the other side is at rest, the swapped part is reported.
    fn mistakes(&self) -> Vec<(Mistake, Carrier)> {
        let mut mistakes = vec![
            (Mistake::SwappedMarker, Carrier::Marker),
            (Mistake::SwappedArm, Carrier::Flange),
            (Mistake::InversePose, Carrier::Marker),
            (Mistake::InverseRotation, Carrier::Marker),
            (Mistake::LeftHanded, Carrier::Marker),
        ];
        // Try every combination of signs, single axes first, because each single axis has its own verdict. Flipping all
        // three gives a rotated left-handed frame.
        let signs = [[true, false, false], [false, true, false], [false, false, true]];
        let more = [[true, true, false], [true, false, true], [false, true, true]];
        mistakes.extend(signs.into_iter().chain(more).map(|axes| (Mistake::WrongSign(axes), Carrier::Marker)));
        mistakes
    }
}

/// Returns the missing motion, if any. Arm and marker must both turn: a turning flange with a marker that does not turn
/// is not a hand-eye motion, but a swapped arm or marker.
fn lacking(rows: &[HandEyeRow]) -> Option<FrameCause> {
    let flange = Turns::of(rows.iter().map(|row| &row.base_from_flange));
    let marker = Turns::of(rows.iter().map(|row| &row.c_from_m));
    flange.lacking().or_else(|| marker.lacking())
}

impl HandEyeSettings {
    /// Returns the uncertainty at the tip, averaged over the poses, in the frame of the base, from the covariance of
    /// the refinement. Empty if it is not determined.
    fn uncertainty(&self, rows: &[HandEyeRow], frames: HandEyeFrames) -> Sizes {
        let Some(RefinedFrames { covariance, freedom, .. }) = refine::unmoved(rows, frames) else {
            return Sizes::default();
        };
        let regions = rows.iter().map(|row| {
            let [place, turn] = refine::slopes_at_tip(row, &frames, &self.tip_in_flange_m);
            [place * covariance * place.transpose(), turn * covariance * turn.transpose()]
        });
        let [mut place, mut turn] = [nalgebra::Matrix3::zeros(); 2];
        for region in regions {
            place += region[0] / rows.len() as f64;
            turn += region[1] / rows.len() as f64;
        }
        Sizes { place_m: Some(radius_95(&place, freedom)), angle_deg: Some(radius_95(&turn, freedom).to_degrees()) }
    }
}
