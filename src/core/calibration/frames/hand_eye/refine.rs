//! Refinement of both frames: the Gauss-Newton method, damped after Levenberg and Marquardt, over two rigid motions.
//!
//! Compared with the tracker the joints are exact, so the errors are in `B` relative to `Y^-1 A X`, position and angle
//! each divided by its noise, as in Strobl and Hirzinger (IROS 2006). A step changes `X` to `X exp(x)` and `Y` to `Y
//! exp(y)` (position, then rotation vector).

use nalgebra::{Isometry3, Matrix3, SMatrix, SVector, UnitQuaternion, Vector3};

use super::{HandEyeFrames, HandEyeRow};

/// Two rigid motions with six unknowns each, because both frames are refined together.
const UNKNOWNS: usize = 12;
type Normal = SMatrix<f64, UNKNOWNS, UNKNOWNS>;
type RefineStep = SVector<f64, UNKNOWNS>;
type Slopes = SMatrix<f64, 3, UNKNOWNS>;

/// Noise of a tracker (0.25 mm and 0.02 degrees); only the ratio of the two matters here.
const NOISE_M: f64 = 0.25e-3;
const NOISE_RAD: f64 = 3.5e-4;
/// Several times what is needed, so that only data without a solution reach it.
const STEPS: usize = 10;
/// A step that reduces the sum of squares by a smaller fraction is the last one. From the start given by a solver, this
/// takes two or three steps.
const LAST_FRACTION: f64 = 1e-7;

pub(super) struct RefinedFrames {
    pub(super) frames: HandEyeFrames,
    /// Covariance of a step: `x`, then `y`.
    pub(super) covariance: Normal,
    /// Degrees of freedom of the variance.
    pub(super) freedom: usize,
}

struct RefineLinear {
    normal: Normal,
    right: RefineStep,
    squares: f64,
}

/// Returns the frames with the smallest weighted squares near `start`; `None` if the poses do not determine them.
pub(super) fn refined(rows: &[HandEyeRow], start: HandEyeFrames) -> Option<RefinedFrames> {
    let mut frames = start;
    let mut here = linear(rows, &frames);
    // Almost Gauss-Newton; the damping grows only if a step fails.
    let mut damping = 1e-6;
    for _ in 0..STEPS {
        let mut damped = here.normal;
        for i in 0..UNKNOWNS {
            damped[(i, i)] *= 1.0 + damping;
        }
        let step = damped.cholesky()?.solve(&here.right);
        let tried = moved(&frames, &step);
        let there = linear(rows, &tried);
        if there.squares <= here.squares {
            let last = here.squares - there.squares <= LAST_FRACTION * here.squares;
            frames = tried;
            here = there;
            damping *= 0.1;
            if last {
                break;
            }
        } else {
            // Faster than it is relaxed, so that a wrong direction is left quickly.
            damping *= 30.0;
        }
    }
    with_covariance(rows, frames, &here)
}

/// Returns the covariance at these frames, without a step.
pub(super) fn unmoved(rows: &[HandEyeRow], frames: HandEyeFrames) -> Option<RefinedFrames> {
    with_covariance(rows, frames, &linear(rows, &frames))
}

fn with_covariance(rows: &[HandEyeRow], frames: HandEyeFrames, here: &RefineLinear) -> Option<RefinedFrames> {
    // Six equations per row for twelve unknowns; at least one, so that the division is finite.
    let freedom = (6 * rows.len()).saturating_sub(UNKNOWNS).max(1);
    let covariance = here.normal.cholesky()?.inverse() * (here.squares / freedom as f64);
    Some(RefinedFrames { frames, covariance, freedom })
}

fn linear(rows: &[HandEyeRow], frames: &HandEyeFrames) -> RefineLinear {
    let mut linear = RefineLinear { normal: Normal::zeros(), right: RefineStep::zeros(), squares: 0.0 };
    let c_from_base = frames.base_from_c.inverse();
    for row in rows {
        let expected = c_from_base * row.base_from_flange * frames.flange_from_m;
        let turn = expected.rotation.to_rotation_matrix().into_inner();
        let place_m = expected.translation.vector;
        let mut slopes = Slopes::zeros();
        slopes.fixed_view_mut::<3, 3>(0, 0).copy_from(&turn);
        slopes.fixed_view_mut::<3, 3>(0, 6).copy_from(&-Matrix3::identity());
        slopes.fixed_view_mut::<3, 3>(0, 9).copy_from(&place_m.cross_matrix());
        // Divided by the noise, so that lengths and angles count by their accuracy.
        linear.add(&(slopes / NOISE_M), &((row.c_from_m.translation.vector - place_m) / NOISE_M));
        let mut slopes = Slopes::zeros();
        slopes.fixed_view_mut::<3, 3>(0, 3).copy_from(&Matrix3::identity());
        slopes.fixed_view_mut::<3, 3>(0, 9).copy_from(&-turn.transpose());
        let error = (expected.rotation.inverse() * row.c_from_m.rotation).scaled_axis();
        linear.add(&(slopes / NOISE_RAD), &(error / NOISE_RAD));
    }
    linear
}

impl RefineLinear {
    fn add(&mut self, slopes: &Slopes, error: &Vector3<f64>) {
        self.normal += slopes.transpose() * slopes;
        self.right += slopes.transpose() * error;
        self.squares += error.norm_squared();
    }
}

fn moved(frames: &HandEyeFrames, step: &RefineStep) -> HandEyeFrames {
    let motion = |from: usize| {
        let turn = UnitQuaternion::from_scaled_axis(step.fixed_rows::<3>(from + 3).into_owned());
        Isometry3::from_parts(step.fixed_rows::<3>(from).into_owned().into(), turn)
    };
    HandEyeFrames { flange_from_m: frames.flange_from_m * motion(0), base_from_c: frames.base_from_c * motion(6) }
}

/// Returns the change per step of the tip (m) and of its rotation vector (rad), as the tracker measures them in one
/// pose, in the base's frame.
pub(super) fn slopes_at_tip(row: &HandEyeRow, frames: &HandEyeFrames, tip_in_flange_m: &Vector3<f64>) -> [Slopes; 2] {
    let in_m = frames.flange_from_m.inverse() * nalgebra::Point3::from(*tip_in_flange_m);
    let in_c = row.c_from_m * in_m;
    let y = frames.base_from_c.rotation.to_rotation_matrix().into_inner();
    let yb = (frames.base_from_c.rotation * row.c_from_m.rotation).to_rotation_matrix().into_inner();
    let mut place = Slopes::zeros();
    let mut turn = Slopes::zeros();
    place.fixed_view_mut::<3, 3>(0, 0).copy_from(&-yb);
    place.fixed_view_mut::<3, 3>(0, 3).copy_from(&(yb * in_m.coords.cross_matrix()));
    place.fixed_view_mut::<3, 3>(0, 6).copy_from(&y);
    place.fixed_view_mut::<3, 3>(0, 9).copy_from(&(-y * in_c.coords.cross_matrix()));
    turn.fixed_view_mut::<3, 3>(0, 3).copy_from(&-yb);
    turn.fixed_view_mut::<3, 3>(0, 9).copy_from(&y);
    [place, turn]
}
