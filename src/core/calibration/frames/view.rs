//! The endoscope's view: orientation of the camera image relative to the arm, the camera or the handle, from moves seen
//! in the image.
//!
//! The operator moves the tip (or the handle) to the right in the image, up, into it, and back the same way. Each
//! displacement in the frame of base, camera or leader corresponds to a known direction in the frame `view` (x right, y
//! down, z into the image); the rotation between the two sets is Wahba's problem (Markley 1988). The product of both
//! rotations is the argument of [`crate::kinematics::MotionMapping::new`]: "right" on the handle is then right in the image.

use nalgebra::{Isometry3, Matrix3, Point3, Rotation3, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

use super::{
    Calibration, CalibrationSource, Carrier, FrameCause, FrameCoverage, FrameLimits, FrameReport, FrameSample,
    MissingMotion, Mistake, Sizes,
    examine::{Problem, RowMiss, examined},
    record::{CalibrationResult, rotation, rotation_fault, wxyz},
    report::finite,
    spread::{below, nearest_orthogonal, principal, radius_95},
};

/// Minimum length of a move, m: sixty times the noise of a tracker (0.25 mm), so that the direction is known within 2
/// degrees.
const MIN_M: f64 = 0.015;
/// Minimum root mean square of the moves' directions along the second and third axis of all; 0.58 for orthogonal moves.
/// Below half of that, hardly any move went along the axis.
const MIN_SECOND: f64 = 0.3;
const MIN_THIRD: f64 = 0.2;
/// A mirror explains the moves if its error is below this fraction of the rotation's.
const MIRROR_FRACTION: f64 = 0.5;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ViewMove {
    Right,
    Up,
    Deeper,
    Left,
    Down,
    Back,
}

impl ViewMove {
    /// The moves in the order in which they are requested. The last one ends at the start of the first.
    pub const ALL: [Self; 6] = [Self::Right, Self::Up, Self::Deeper, Self::Left, Self::Down, Self::Back];

    /// Returns the direction in the frame `view`, unit length.
    pub fn in_view(self) -> Vector3<f64> {
        match self {
            Self::Right => Vector3::x(),
            Self::Up => -Vector3::y(),
            Self::Deeper => Vector3::z(),
            Self::Left => -Vector3::x(),
            Self::Down => Vector3::y(),
            Self::Back => -Vector3::z(),
        }
    }
}

/// Settings of the view's calibration. The samples are a starting point and then the ends of the moves of
/// [`ViewMove::ALL`], repeated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewSettings {
    /// The carrier that moves: the tip (by flange or marker) or the handle.
    pub carrier: Carrier,
    /// The point that moves, in the carrier's frame, m: the tip, or zero for the handle.
    pub point_in_carrier_m: Vector3<f64>,
    /// Limits for the verdict, suited to a person's hand.
    pub limits: FrameLimits,
}

impl ViewSettings {
    /// Creates the settings for the tip and the arm: finds `base_from_view`.
    pub const fn by_arm(tip_in_flange_m: Vector3<f64>) -> Self {
        Self::of(Carrier::Flange, tip_in_flange_m)
    }

    /// Creates the settings for the tip and the tracker: finds `c_from_view`.
    pub const fn by_tracker(tip_in_m_m: Vector3<f64>) -> Self {
        Self::of(Carrier::Marker, tip_in_m_m)
    }

    pub fn by_handle() -> Self {
        Self::of(Carrier::Handle, Vector3::zeros())
    }

    const fn of(carrier: Carrier, point_in_carrier_m: Vector3<f64>) -> Self {
        let limits =
            FrameLimits { min: 6, held_out: Sizes::angle(15.0), uncertainty: Sizes::angle(15.0), outliers: 0.25 };
        Self { carrier, point_in_carrier_m, limits }
    }

    fn points(&self, samples: &[FrameSample]) -> Vec<Vector3<f64>> {
        let point = Point3::from(self.point_in_carrier_m);
        samples.iter().filter_map(|sample| Some((sample.pose(self.carrier)? * point).coords)).collect()
    }

    /// Returns the move to request after these samples; `None` before the starting point.
    pub fn asked(&self, taken: usize) -> Option<ViewMove> {
        Some(ViewMove::ALL[taken.checked_sub(1)? % ViewMove::ALL.len()])
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ViewResult {
    /// The carrier that moved: flange (`base_from_view`), marker (`c_from_view`) or handle (`leader_from_view`).
    pub carrier: Carrier,
    /// Rotation from `view` to the carrier's frame.
    pub from_view_wxyz: [f64; 4],
}

impl ViewResult {
    /// Returns the rotation from `view` to the frame of base, camera or leader.
    pub fn from_view(&self) -> UnitQuaternion<f64> {
        rotation(&self.from_view_wxyz)
    }

    /// Returns the orientation of the image relative to a marker `n` on the endoscope, `n_from_view`, from the marker's
    /// orientation while the moves were recorded with the arm, and the hand-eye calibration. With it the view follows
    /// the endoscope.
    pub fn n_from_view(
        &self,
        base_from_c: &UnitQuaternion<f64>,
        c_from_n: &UnitQuaternion<f64>,
    ) -> UnitQuaternion<f64> {
        (base_from_c * c_from_n).inverse() * self.from_view()
    }
}

impl CalibrationResult for ViewResult {
    const KIND: &'static str = "view";

    fn fault(&self) -> Option<&'static str> {
        rotation_fault(&self.from_view_wxyz)
    }
}

/// Directions of one move, unit length.
#[derive(Clone, Copy, Debug)]
struct ViewRow {
    in_view: Vector3<f64>,
    measured: Vector3<f64>,
}

struct ViewMoves;

fn moment(rows: &[ViewRow]) -> Matrix3<f64> {
    rows.iter().map(|row| row.measured * row.in_view.transpose()).sum()
}

impl Problem for ViewMoves {
    type Row = ViewRow;
    type Model = Matrix3<f64>;
    const HYPOTHESIS: usize = 3;
    const FLOOR: RowMiss = RowMiss::of_angle(0.7);

    fn solve(&self, rows: &[ViewRow]) -> Option<Matrix3<f64>> {
        nearest_orthogonal(&moment(rows), 1.0)
    }

    fn miss(&self, turn: &Matrix3<f64>, row: &ViewRow) -> RowMiss {
        RowMiss::of_angle((turn * row.in_view).angle(&row.measured))
    }
}

impl Calibration for ViewSettings {
    type Solution = ViewResult;

    fn needs(&self) -> Vec<CalibrationSource> {
        vec![self.carrier.source()]
    }

    fn carrier(&self) -> Carrier {
        self.carrier
    }

    /// Only the last position counts, because the moves return to the first.
    fn differs(&self, sample: &FrameSample, taken: &[FrameSample]) -> bool {
        let last = taken.last().map(|last| self.points(&[*last]));
        let here = self.points(&[*sample]);
        last.is_none_or(|last| last.iter().zip(&here).all(|(last, here)| (last - here).norm() >= MIN_M))
    }

    fn coverage(&self, taken: &[FrameSample]) -> FrameCoverage {
        let next = self.asked(taken.len()).map_or(MissingMotion::Poses, MissingMotion::Move);
        FrameCoverage::min([(taken.len() as f64 / (ViewMove::ALL.len() + 1) as f64, next)])
    }

    fn fault(&self) -> Option<&'static str> {
        (!finite(&self.point_in_carrier_m)).then_some("the moving point is not finite")
    }

    fn attempt(&self, samples: &[FrameSample]) -> FrameReport<ViewResult> {
        let points = self.points(samples);
        let ways = points.windows(2).zip(ViewMove::ALL.iter().cycle());
        // A displacement that is too short has no direction; the others keep their names.
        let row = |(ends, asked): (&[Vector3<f64>], &ViewMove)| {
            let measured = (ends[1] - ends[0]).try_normalize(MIN_M)?;
            Some(ViewRow { in_view: asked.in_view(), measured })
        };
        let rows: Vec<ViewRow> = ways.filter_map(row).collect();
        let have = rows.len();
        let min = self.limits.min;
        if have < min {
            return FrameReport::nothing(have, FrameCause::TooFew { have, min });
        }
        let directions: Vec<Vector3<f64>> = rows.iter().map(|row| row.measured).collect();
        let [_, second, third] = principal(&directions);
        if below(second, MIN_SECOND) {
            return FrameReport::nothing(have, FrameCause::Collinear { spread: second, min: MIN_SECOND });
        }
        if below(third, MIN_THIRD) {
            return FrameReport::nothing(have, FrameCause::OnePlane { spread: third, min: MIN_THIRD });
        }
        // Before the fit: a rotation through mirrored moves exists, but is wrong by up to 180 degrees.
        if is_mirrored(&rows) {
            return FrameReport::nothing(have, FrameCause::Mistake { mistake: Mistake::Mirrored });
        }
        let Some(found) = examined(&ViewMoves, &rows) else {
            return FrameReport::nothing(have, FrameCause::Collinear { spread: 0.0, min: MIN_SECOND });
        };
        let turn = Rotation3::from_matrix_unchecked(found.model);
        let from_view_wxyz = wxyz(&UnitQuaternion::from_rotation_matrix(&turn));
        let value = ViewResult { carrier: self.carrier, from_view_wxyz };
        // Each direction determines two of the three rotation angles, so n directions spread over all axes determine each
        // angle 2 n / 3 times.
        let kept = found.kept.len();
        // At least one, because a session without freedom must give a wide region and not a division by zero.
        let freedom = (2 * kept).saturating_sub(3).max(1);
        let variance = found.squares_rad2() / freedom as f64 * 1.5 / kept as f64;
        let angle_deg = radius_95(&Matrix3::from_diagonal_element(variance), freedom).to_degrees();
        FrameReport::of(have, found, Sizes::angle(angle_deg), value).judged(&self.limits)
    }

    fn mistakes(&self) -> Vec<(Mistake, Carrier)> {
        match self.carrier {
            Carrier::Handle => Vec::new(),
            carrier => vec![(Mistake::swapped(carrier), carrier)],
        }
    }
}

/// Returns whether a reflection explains the moves far better than any rotation.
fn is_mirrored(rows: &[ViewRow]) -> bool {
    let squares = |sign| {
        let best = nearest_orthogonal(&moment(rows), sign)?;
        Some(rows.iter().map(|row| (row.measured - best * row.in_view).norm_squared()).sum::<f64>())
    };
    squares(-1.0).zip(squares(1.0)).is_some_and(|(mirror, turn)| mirror < MIRROR_FRACTION * turn)
}

/// A pose with only a position, for a device without a wrist.
impl From<Vector3<f64>> for FrameSample {
    fn from(handle_m: Vector3<f64>) -> Self {
        let pose = Isometry3::from_parts(handle_m.into(), UnitQuaternion::identity());
        Self { leader_from_handle: Some(pose), ..Self::default() }
    }
}
