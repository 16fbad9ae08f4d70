//! Pose of the camera in the workspace, from corners of a board at rest: seen by the camera, and touched with the tip
//! of an instrument whose position is known.

use nalgebra::{Isometry3, Matrix3, Translation3, Vector2, Vector3};
use nima_core::calibration::Verdict;
use nima_endoscope::{Camera, Checkerboard, Lens};

use crate::{
    BoardSight,
    fit::{FitCorners, refined_pose},
    plane,
};

/// Minimum number of touched corners. Three points determine the pose; the fourth shows whether they agree.
const TOUCHES: usize = 4;
/// Minimum spread of the touched corners in their shorter direction, in squares; they must span a plane. Points close
/// to one line leave the rotation about that line undetermined.
const SPREAD: f64 = 1.0;
/// Maximum distance between touched corners and a rigid board, m. The error of a touch with the tip; a larger one is a
/// bent board or a wrong size of its squares.
const RIGID_M: f64 = 0.002;
/// Maximum error of held-out corners, as a fraction of the image width: 10 px of 1280.
const HELD_OUT: f64 = 10.0 / 1280.0;
const STEPS: usize = 40;

/// A touched corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TouchedCorner {
    /// Column and row of the corner, from zero.
    pub corner: [usize; 2],
    /// Position of the tip in the workspace, m.
    pub tip_m: Vector3<f64>,
}

/// Why the pose cannot be computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlaceError {
    /// Too few corners were touched.
    TooFew {
        /// Number of touched corners.
        touched: usize,
        /// Required number of corners.
        needed: usize,
    },
    /// The touched corners are on one line.
    OneLine,
    /// No pose of the board fits the corners in the image.
    NotSeen,
}

/// Why a pose is rejected.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlaceLack {
    /// The touched points do not fit a flat board with these squares: a corner was missed, or the board moved.
    NotRigid {
        /// The corner that is farthest away.
        corner: [usize; 2],
        /// Distance, m.
        by_m: f64,
    },
    /// Touched points are too far from their positions in the camera image.
    HeldOut {
        /// Root mean square, px.
        rms_px: f64,
        /// Limit, px.
        max_px: f64,
    },
}

/// Pose of the camera.
#[derive(Clone, Debug)]
pub struct CameraPlacement {
    pub world_from_camera: Isometry3<f64>,
    /// Root mean square of the distances of the touched points from a rigid board, m.
    pub fitted_m: f64,
    /// Root mean square of the distances of touched points from the seen corners, each with the camera's pose computed
    /// without it, px.
    pub held_out_px: f64,
    /// Maximum of these distances, px.
    pub held_out_max_px: f64,
    /// The reason why the pose is rejected; `None` if it is accepted.
    pub lack: Option<PlaceLack>,
}

impl CameraPlacement {
    /// Returns whether the pose may be used.
    pub const fn verdict(&self) -> Verdict {
        if self.lack.is_some() { Verdict::PoorData } else { Verdict::Accepted }
    }
}

/// Returns the pose of a board in front of a lens.
pub fn board_pose(board: &Checkerboard, lens: &Lens, sight: &BoardSight) -> Option<Isometry3<f64>> {
    let view = FitCorners { places_m: board.places_m(), seen_px: sight.corners_px.clone() };
    let first = plane::pose(lens, &view.places_m, &view.seen_px)?;
    refined_pose(lens, &view, first, STEPS)
}

/// Computes the camera's pose from touched corners of a board that it sees.
///
/// # Errors
/// [`PlaceError`] if the pose cannot be computed.
pub fn place(
    board: &Checkerboard,
    lens: &Lens,
    sight: &BoardSight,
    touches: &[TouchedCorner],
) -> Result<CameraPlacement, PlaceError> {
    if touches.len() < TOUCHES {
        return Err(PlaceError::TooFew { touched: touches.len(), needed: TOUCHES });
    }
    let on_board = |touch: &TouchedCorner| {
        let [across, down] = touch.corner.map(|at| at as f64 * board.square_m());
        Vector3::new(across, down, 0.0)
    };
    let spread_m = plane::spread(&touches.iter().map(on_board).collect::<Vec<_>>())[1];
    if spread_m < SPREAD * board.square_m() {
        return Err(PlaceError::OneLine);
    }
    let camera_from_board = board_pose(board, lens, sight).ok_or(PlaceError::NotSeen)?;
    let world_from_board = |touches: &[TouchedCorner]| {
        rigid(
            &touches.iter().map(on_board).collect::<Vec<_>>(),
            &touches.iter().map(|touch| touch.tip_m).collect::<Vec<_>>(),
        )
    };
    let whole = world_from_board(touches).ok_or(PlaceError::OneLine)?;
    let away = |touch: &TouchedCorner| {
        (whole * nalgebra::Point3::from(on_board(touch)) - nalgebra::Point3::from(touch.tip_m)).norm()
    };
    let camera_at = |world_from_board: &Isometry3<f64>| Camera {
        lens: *lens,
        world_from_camera: world_from_board * camera_from_board.inverse(),
    };
    let mut errors_px = Vec::new();
    for (at, left_out) in touches.iter().enumerate() {
        let others: Vec<TouchedCorner> =
            touches.iter().enumerate().filter(|(other, _)| *other != at).map(|(_, touch)| *touch).collect();
        let seen: Option<&Vector2<f64>> = sight.corners_px.get(board.index(left_out.corner));
        let predicted = world_from_board(&others).and_then(|found| camera_at(&found).project(&left_out.tip_m));
        errors_px.push(seen.zip(predicted).map_or(f64::INFINITY, |(seen, predicted)| (seen - predicted).norm()));
    }
    let root = |sum: f64| (sum / touches.len() as f64).sqrt();
    let held_out_px = root(errors_px.iter().map(|error| error * error).sum());
    let farthest = touches.iter().max_by(|a, b| away(a).total_cmp(&away(b)));
    let max_px = HELD_OUT * lens.size_px[0] as f64;
    let is_rigid = touches.iter().all(|touch| away(touch) <= RIGID_M);
    let is_predicted = held_out_px <= max_px;
    let lack = match farthest {
        Some(touch) if !is_rigid => Some(PlaceLack::NotRigid { corner: touch.corner, by_m: away(touch) }),
        _ if !is_predicted => Some(PlaceLack::HeldOut { rms_px: held_out_px, max_px }),
        _ => None,
    };
    Ok(CameraPlacement {
        world_from_camera: camera_at(&whole).world_from_camera,
        fitted_m: root(touches.iter().map(|touch| away(touch).powi(2)).sum()),
        held_out_px,
        held_out_max_px: errors_px.into_iter().fold(0.0, f64::max),
        lack,
    })
}

/// Returns the rigid motion that best maps points to other points (Kabsch 1976); points on one line do not determine
/// it.
fn rigid(from: &[Vector3<f64>], to: &[Vector3<f64>]) -> Option<Isometry3<f64>> {
    let count = from.len().min(to.len()).max(1) as f64;
    let [a, b] = [from, to].map(|points| points.iter().sum::<Vector3<f64>>() / count);
    let [longest, shorter, _] = plane::spread(from);
    if shorter <= 1e-3 * longest {
        return None;
    }
    let crossed: Matrix3<f64> = from.iter().zip(to).map(|(p, q)| (q - b) * (p - a).transpose()).sum();
    let rotation = plane::nearest_rotation(&crossed)?;
    Some(Isometry3::from_parts(Translation3::from(b - rotation * a), rotation))
}
