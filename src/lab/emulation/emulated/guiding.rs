//! Hand guiding: joint angles (rad) for the way in which a person holds the tool.
//!
//! A person determines the tilt of the tool, or the position of its tip and the direction of its shaft; the arm, whose
//! brakes are open, takes the required joint angles. Damped least squares; a joint at its limit is left out, and the
//! remaining freedom pulls the joints towards a comfortable pose. Lengths in m, in `world`.

use std::f64::consts::{PI, TAU};

use nalgebra::{SMatrix, SVector, UnitQuaternion, Vector3};
use nima_core::{
    kinematics::{Arm, ArmModel, InstrumentPose, JOINTS, Joints},
    noise::Noise,
};

/// Length that makes a rotation comparable with a displacement, m. About the length of an instrument outside the body,
/// because the tip should count as much as the hand.
const LENGTH_M: f64 = 0.3;
/// Keeps the step finite near a singular pose, where the exact solution would turn a joint by any angle.
const DAMPING: f64 = 1e-4;
/// A person stays this far from a joint's limit, rad. A person feels the end stop coming, and the calibration would
/// refuse a pose at the limit.
const KEEP_OFF_RAD: f64 = 0.1;
/// Fraction of the distance to the comfortable pose covered in one second.
const COMFORT_PER_S: f64 = 0.5;
/// Parameters of the search: number of random starts, steps from each, maximum step, rad, and the error at which it
/// ends, m. Several starts, because the search ends in the nearest minimum, which may be out of reach.
const STARTS: usize = 40;
const STEPS: usize = 150;
const LONGEST_RAD: f64 = 0.25;
const CLOSE_M: f64 = 1e-5;

/// Way in which a person holds the tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum ToolHold {
    /// Gravity acts in this direction of the sensor (unit, `s1`); the position of the tool does not matter.
    Tilt(Vector3<f64>),
    /// The tip is here, and the shaft points in this direction (unit); rotation about the shaft does not matter.
    Tip { tip_m: Vector3<f64>, along: Vector3<f64> },
    /// The tip is here, and the tool has this orientation, including its rotation about the shaft.
    Pose { tip_m: Vector3<f64>, world_from_s1: UnitQuaternion<f64> },
}

/// The arm in a person's hands.
#[derive(Clone, Copy, Debug)]
pub(super) struct Guide {
    arm: Arm,
    comfort_rad: Joints,
}

/// Maximum number of conditions of a hold; unused rows are zero.
const CONDITIONS: usize = 6;
type GuidingRows = SMatrix<f64, CONDITIONS, JOINTS>;
type GuidingMiss = SVector<f64, CONDITIONS>;

impl Guide {
    /// `comfort_rad` are the joint angles that a person prefers.
    pub(super) const fn new(arm: &Arm, comfort_rad: Joints) -> Self {
        Self { arm: *arm, comfort_rad }
    }

    /// Guides the joints towards this hold for `dt_s`, limited by their speed; returns the remaining error, m.
    pub(super) fn step(&self, joint_rad: &mut Joints, hold: &ToolHold, dt_s: f64) -> f64 {
        let (step_rad, miss_m) = self.towards(joint_rad, hold, COMFORT_PER_S * dt_s);
        let fraction = step_rad
            .iter()
            .zip(self.arm.model().speed_rad_s())
            .map(|(step, max)| step.abs() / (max * dt_s))
            .fold(1.0, f64::max);
        *joint_rad += step_rad / fraction;
        miss_m
    }

    /// Returns the joint angles for this hold that are closest to `from_rad`; `None` if the arm cannot reach it.
    pub(super) fn find(&self, from_rad: &Joints, hold: &ToolHold) -> Option<Joints> {
        let mut noise = Noise::new(0x6a_1d);
        let mut random = || self.arm.model().within_ranges(|| 2.0 * noise.uniform() - 1.0);
        let starts = [*from_rad, self.comfort_rad].into_iter().chain((0..STARTS).map(|_| random()));
        let found = starts
            .filter_map(|start| self.converged(start, hold))
            .map(|found| nearest_turn(self.arm.model(), from_rad, &found));
        found.min_by(|a, b| (a - from_rad).amax().total_cmp(&(b - from_rad).amax()))
    }

    /// Returns whether the arm can move to this hold from its current pose without taking another pose first.
    pub(super) fn reaches(&self, from_rad: &Joints, hold: &ToolHold) -> bool {
        self.converged(*from_rad, hold).is_some()
    }

    fn converged(&self, start_rad: Joints, hold: &ToolHold) -> Option<Joints> {
        let mut joint_rad = start_rad;
        for _ in 0..STEPS {
            let (step_rad, miss_m) = self.towards(&joint_rad, hold, 0.0);
            if miss_m < CLOSE_M {
                return (self.arm.model().limit_margin_rad(&joint_rad) >= KEEP_OFF_RAD).then_some(joint_rad);
            }
            joint_rad += step_rad * (LONGEST_RAD / step_rad.amax().max(LONGEST_RAD));
        }
        None
    }

    /// Returns the step to this hold, with a fraction of the distance to the comfortable pose in the remaining freedom,
    /// and the error.
    fn towards(&self, joint_rad: &Joints, hold: &ToolHold, comfort: f64) -> (Joints, f64) {
        let (rows, miss) = missing(&self.arm.pose(joint_rad), hold);
        let relaxed = nearest_turn(self.arm.model(), joint_rad, &self.comfort_rad) - joint_rad;
        let model = self.arm.model();
        let mut free = [true; JOINTS];
        let mut step_rad = Joints::zeros();
        for _ in 0..model.joints() {
            step_rad = solve(&rows, &miss, &(relaxed * comfort), free);
            let mut stopped = false;
            for joint in 0..model.joints() {
                let now_rad = model.margin_rad(joint, joint_rad[joint]);
                let next_rad = model.margin_rad(joint, joint_rad[joint] + step_rad[joint]);
                if free[joint] && next_rad < KEEP_OFF_RAD && next_rad < now_rad {
                    free[joint] = false;
                    stopped = true;
                }
            }
            if !stopped {
                break;
            }
        }
        (step_rad, miss.norm())
    }
}

/// Returns the effect of each joint's step, and the remaining error: rotations times [`LENGTH_M`], m.
fn missing(pose: &InstrumentPose, hold: &ToolHold) -> (GuidingRows, GuidingMiss) {
    let jacobian = pose.chain.jacobian(&pose.tip_m);
    let place = jacobian.fixed_rows::<3>(0);
    let turn = jacobian.fixed_rows::<3>(3) * LENGTH_M;
    let mut rows = GuidingRows::zeros();
    let mut miss = GuidingMiss::zeros();
    match hold {
        ToolHold::Tilt(down_s1) => {
            // A rotation about the vertical does not change the tilt.
            let e = rotation(&(pose.world_from_s1.rotation * down_s1), &-Vector3::z()) * LENGTH_M;
            for axis in 0..2 {
                rows.row_mut(axis).copy_from(&turn.row(axis));
                miss[axis] = e[axis];
            }
        }
        ToolHold::Tip { tip_m, along } => {
            rows.fixed_rows_mut::<3>(0).copy_from(&place);
            miss.fixed_rows_mut::<3>(0).copy_from(&(tip_m - pose.tip_m));
            let e = rotation(&pose.direction, along) * LENGTH_M;
            for (row, across) in pose.across.iter().enumerate() {
                rows.row_mut(3 + row).copy_from(&(across.transpose() * turn));
                miss[3 + row] = across.dot(&e);
            }
        }
        ToolHold::Pose { tip_m, world_from_s1 } => {
            rows.fixed_rows_mut::<3>(0).copy_from(&place);
            miss.fixed_rows_mut::<3>(0).copy_from(&(tip_m - pose.tip_m));
            let e = (world_from_s1 * pose.orientation().inverse()).scaled_axis() * LENGTH_M;
            rows.fixed_rows_mut::<3>(3).copy_from(&turn);
            miss.fixed_rows_mut::<3>(3).copy_from(&e);
        }
    }
    (rows, miss)
}

/// Least squares with the free joints; the remaining freedom follows `relaxed`.
fn solve(rows: &GuidingRows, miss: &GuidingMiss, relaxed: &Joints, free: [bool; JOINTS]) -> Joints {
    let mut rows = *rows;
    let mut relaxed = *relaxed;
    for (joint, _) in free.iter().enumerate().filter(|(_, free)| !**free) {
        rows.column_mut(joint).fill(0.0);
        relaxed[joint] = 0.0;
    }
    let square = rows * rows.transpose() + SMatrix::<f64, CONDITIONS, CONDITIONS>::identity() * DAMPING;
    square.cholesky().map_or_else(Joints::zeros, |c| relaxed + rows.transpose() * c.solve(&(miss - rows * relaxed)))
}

/// Returns the rotation vector, rad, that rotates one unit vector into another; for opposite vectors, half a turn about
/// a horizontal axis.
fn rotation(from: &Vector3<f64>, to: &Vector3<f64>) -> Vector3<f64> {
    let axis = from.cross(to);
    let cos = from.dot(to);
    let sin = axis.norm();
    if sin > 1e-9 {
        return axis * (sin.atan2(cos) / sin);
    }
    if cos > 0.0 { Vector3::zeros() } else { Vector3::x() * PI }
}

/// Returns the same pose, with each continuous joint in the turn nearest to `from_rad`.
pub(super) fn nearest_turn(model: &ArmModel, from_rad: &Joints, joint_rad: &Joints) -> Joints {
    Joints::from_fn(|joint, _| {
        let from = from_rad[joint];
        let to = joint_rad[joint];
        if model.range_rad(joint).iter().all(|rad| rad.is_finite()) {
            to
        } else {
            to - TAU * ((to - from) / TAU).round()
        }
    })
}
