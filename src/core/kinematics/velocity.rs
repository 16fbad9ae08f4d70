//! Converts a motion of the shaft to a step of the joints: three tasks in order of priority, each in the null space of
//! the previous ones.
//!
//! - First, the shaft's axis passes through the trocar (2 rows).
//! - Second, the shaft rotates about the trocar and slides in it (3 rows; damped near singularities).
//! - Third, the posture is improved (in the remaining freedom: the elbow, the rotation about the shaft).
//!
//! Because the second task is solved in the null space of the first, damping or slowing it reduces speed but never
//! moves the shaft out of the trocar. Null-space projection after Siciliano and Slotine (1991); damping after Nakamura
//! and Hanafusa (1986), but per singular direction; joints near a limit are weighted less, as in Chan and Dubey (1995).
//! Everything in `world`, m and rad, without allocation.

use nalgebra::{Matrix2, SMatrix, SymmetricEigen, Vector2, Vector3};

use super::{arm_model::JOINTS, instrument::InstrumentPose, joint_chain::Joints};

type Rows2 = SMatrix<f64, 2, JOINTS>;
type Rows3 = SMatrix<f64, 3, JOINTS>;

/// Length that makes rotation comparable with sliding, m: about the length of the shaft outside the body.
pub(super) const LENGTH_M: f64 = 0.3;

/// Singular value below which a direction is damped, m/rad; also the damping at a singular value of zero.
/// The damping starts at `DAMPED_BELOW`; near a singular pose it limits the joints to about 1 / (2 `DAMPING`) rad/s
/// per m/s.
const DAMPED_BELOW: f64 = 0.05;
const DAMPING: f64 = 0.02;
/// Added to denominators to keep divisions finite; negligible otherwise.
/// The square of a micrometre per radian, far below any real motion of the shaft.
const TINY: f64 = 1e-12;

#[derive(Clone, Copy)]
pub(super) struct VelocityTask {
    /// Velocity of the shaft at the trocar along `InstrumentPose::across`, m/s per rad/s.
    at_trocar: Rows2,
    /// Rotation of the shaft towards `InstrumentPose::across`, times [`LENGTH_M`], and sliding inwards, m/s per rad/s.
    motion: Rows3,
}

pub(super) struct StepParts {
    /// Brings the axis back to the trocar.
    pub correction: Joints,
    /// The complete motion to the target.
    pub motion: Joints,
    /// The part of the motion that follows the target's own motion.
    pub carried: Joints,
    /// Continues as in the last period, without moving the axis at the trocar.
    pub coast: Joints,
    /// Fraction of the correction that the last period's step already makes.
    pub returning: f64,
    /// Improves the posture without affecting the other tasks.
    pub posture: Joints,
    /// Smallest singular value of the shaft's motion with the axis held in the trocar, m/rad.
    pub dexterity: f64,
}

#[derive(Default)]
pub(super) struct MotionRequest {
    /// Displacement of the axis at the trocar along `InstrumentPose::across`, m.
    pub at_trocar_m: Vector2<f64>,
    /// Rotation along `InstrumentPose::across` times [`LENGTH_M`], and sliding inwards, m.
    pub motion_m: Vector3<f64>,
    /// The same for the motion of the target itself in this period.
    pub carried_m: Vector3<f64>,
    pub moved_rad: Joints,
    /// Change of the joints that improves the posture, rad.
    pub posture_rad: Joints,
}

impl VelocityTask {
    pub(super) fn new(pose: &InstrumentPose, trocar_m: &Vector3<f64>) -> Self {
        let mut at_trocar = Rows2::zeros();
        let mut motion = Rows3::zeros();
        let on_axis_m = trocar_m + pose.axis_miss_m(trocar_m);
        for joint in 0..JOINTS {
            let shift = pose.chain.point_per_joint(joint, &on_axis_m);
            let turn = pose.chain.axis[joint].cross(&pose.direction) * LENGTH_M;
            for (row, across) in pose.across.iter().enumerate() {
                at_trocar[(row, joint)] = shift.dot(across);
                motion[(row, joint)] = turn.dot(across);
            }
            // All points of the shaft slide along it at the same speed.
            motion[(2, joint)] = shift.dot(&pose.direction);
        }
        Self { at_trocar, motion }
    }

    /// Returns the square of the product of the five singular values: Yoshikawa's manipulability (1985).
    pub(super) fn manipulability_squared(&self) -> f64 {
        let held = self.at_trocar * self.at_trocar.transpose();
        let cross = self.motion * self.at_trocar.transpose();
        let free = self.motion * self.motion.transpose() - cross * inverse2(&held) * cross.transpose();
        held.determinant() * free.determinant()
    }

    /// Solves for the joint step; `weight` (above 0, at most 1) sets how freely each joint may be used. Returns `None`
    /// if the result cannot be computed.
    pub(super) fn solve(&self, wish: &MotionRequest, weight: &Joints) -> Option<StepParts> {
        let root = weight.map(f64::sqrt);
        let mut trocar = self.at_trocar;
        let mut motion = self.motion;
        for joint in 0..JOINTS {
            trocar.column_mut(joint).scale_mut(root[joint]);
            motion.column_mut(joint).scale_mut(root[joint]);
        }
        let held = inverse2(&(trocar * trocar.transpose()));
        let correction = trocar.transpose() * (held * wish.at_trocar_m);
        let free = motion - (motion * trocar.transpose()) * held * trocar;
        let eigen = SymmetricEigen::try_new(free * free.transpose(), f64::EPSILON, 60)?;
        let through = |gain: &dyn Fn(f64) -> f64, v: Vector3<f64>| {
            let along = eigen.eigenvectors.transpose() * v;
            free.transpose() * (eigen.eigenvectors * along.zip_map(&eigen.eigenvalues, |v, square| v * gain(square)))
        };
        let moved = through(&damped_inverse, wish.motion_m - motion * correction);
        let carried = through(&damped_inverse, wish.carried_m);
        let drifting_m = self.at_trocar * wish.moved_rad;
        let bend = trocar.transpose() * (held * drifting_m);
        let mut posture = wish.posture_rad.component_div(&root);
        posture -= trocar.transpose() * (held * (trocar * posture));
        posture -= through(&|square| 1.0 / square.max(TINY), free * posture);
        let parts = StepParts {
            correction: correction.component_mul(&root),
            motion: moved.component_mul(&root),
            carried: carried.component_mul(&root),
            coast: wish.moved_rad - bend.component_mul(&root),
            returning: drifting_m.dot(&wish.at_trocar_m) / (wish.at_trocar_m.norm_squared() + TINY * TINY),
            posture: posture.component_mul(&root),
            dexterity: eigen.eigenvalues.min().max(0.0).sqrt(),
        };
        let all = [&parts.correction, &parts.motion, &parts.carried, &parts.coast, &parts.posture];
        let finite = all.iter().all(|v| v.iter().all(|x| x.is_finite()));
        finite.then_some(parts)
    }
}

/// Returns `1 / (s^2 + l^2)` with the damping `l` growing from zero as the singular value `s` falls below
/// [`DAMPED_BELOW`].
fn damped_inverse(square: f64) -> f64 {
    let fraction = (square.max(0.0) / (DAMPED_BELOW * DAMPED_BELOW)).min(1.0);
    1.0 / (square.max(0.0) + DAMPING * DAMPING * (1.0 - fraction) + TINY)
}

/// Returns the inverse of a symmetric positive 2 x 2 matrix, finite even if it is singular.
fn inverse2(matrix: &Matrix2<f64>) -> Matrix2<f64> {
    let [a, b, d] = [matrix[(0, 0)] + TINY, matrix[(0, 1)], matrix[(1, 1)] + TINY];
    let determinant = (a * d - b * b).max(TINY * TINY);
    Matrix2::new(d, -b, -b, a) / determinant
}

/// Returns the joint step (rad) towards a tip position and shaft direction by damped least squares, from any start; for
/// the search of a pose, not for the loop.
pub(super) fn towards(pose: &InstrumentPose, tip_m: &Vector3<f64>, direction: &Vector3<f64>) -> (Joints, f64) {
    let mut rows = SMatrix::<f64, 5, JOINTS>::zeros();
    let mut miss_m = SMatrix::<f64, 5, 1>::zeros();
    let turn = turn_towards(pose, direction) * LENGTH_M;
    miss_m.fixed_rows_mut::<3>(0).copy_from(&(tip_m - pose.tip_m));
    miss_m.fixed_rows_mut::<2>(3).copy_from(&turn);
    for joint in 0..JOINTS {
        rows.fixed_view_mut::<3, 1>(0, joint).copy_from(&pose.chain.point_per_joint(joint, &pose.tip_m));
        for (row, across) in pose.across.iter().enumerate() {
            rows[(3 + row, joint)] = pose.chain.axis[joint].cross(&pose.direction).dot(across) * LENGTH_M;
        }
    }
    // Far from the goal the damping limits the step; near the goal it vanishes, so that the last steps are Newton
    // steps.
    let damping = (0.01 * miss_m.norm_squared()).min(1e-3) + TINY;
    let square = rows * rows.transpose() + SMatrix::<f64, 5, 5>::identity() * damping;
    let step = square.cholesky().map_or_else(Joints::zeros, |c| rows.transpose() * c.solve(&miss_m));
    (step, miss_m.norm())
}

/// Returns the rotation from the shaft's direction to another one, along `InstrumentPose::across`, rad.
pub(super) fn turn_towards(pose: &InstrumentPose, direction: &Vector3<f64>) -> Vector2<f64> {
    let [x, y] = pose.across.map(|across| across.dot(direction));
    let sideways = libm::hypot(x, y);
    let angle_rad = libm::atan2(sideways, pose.direction.dot(direction));
    if sideways > TINY {
        Vector2::new(x, y) * (angle_rad / sideways)
    } else {
        // Parallel directions need no rotation; for opposite directions any axis will do.
        Vector2::new(angle_rad, 0.0)
    }
}
