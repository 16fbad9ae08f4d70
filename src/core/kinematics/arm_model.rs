//! The kinematic model of an arm: six or seven revolute joints in series, their limits, and the flange.
//!
//! Angles in rad, lengths in m, in the frame of the arm's base. An arm of six joints has an unused seventh joint, which
//! never moves and moves nothing.

use nalgebra::{Isometry3, Matrix3, Vector3};
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Number of joints that a model has room for.
pub const JOINTS: usize = 7;
/// Smallest number of joints that can hold a shaft in a trocar and move it in all three directions with one to spare.
const JOINTS_MIN: usize = 6;
/// Longest distance between two joints, m. A longer one is a length in another unit.
const LINK_MAX_M: f64 = 3.0;
/// Largest speed and acceleration of a joint, rad/s and rad/s^2. Larger ones are in degrees.
const SPEED_MAX_RAD_S: f64 = 20.0;
const ACCELERATION_MAX_RAD_S2: f64 = 200.0;
/// Largest angle of a joint with a limit, rad. A larger one is in degrees.
const ANGLE_MAX_RAD: f64 = 30.0;
/// Smallest range of a joint, rad, because joints stay some hundredths of a radian away from both ends.
const RANGE_MIN_RAD: f64 = 0.2;
/// A rotation may differ from a unit quaternion by rounding only.
const ROUNDING: f64 = 1e-6;

/// One joint of a chain.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ChainJoint {
    /// Pose in the frame of the previous joint, or of the base, while the previous joint is at zero.
    pub from_previous: Isometry3<f64>,
    /// Axis in the frame of the joint, any length except zero; positive angles are right-handed about it.
    pub axis: Vector3<f64>,
    /// Lowest and highest angle, rad; infinite for a joint that turns without end.
    pub range_rad: [f64; 2],
    pub speed_rad_s: f64,
    pub acceleration_rad_s2: f64,
}

/// The joints of an arm from its base to its flange, as read from a description.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ArmChain {
    pub joints: Vec<ChainJoint>,
    /// Pose of the flange in the frame of the last joint; its z points away from the arm.
    pub last_from_flange: Isometry3<f64>,
}

/// Reason why a chain is not an arm that can be moved.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum ArmModelError {
    #[error("the arm has {joints} moving joints between its base and its flange: use an arm with 6 or 7")]
    Joints { joints: usize },
    #[error("joint {joint} of the arm: its {what} is {value}, but it must be {wanted}")]
    Value {
        /// Counted from 1; one more than the last joint is the flange.
        joint: usize,
        what: &'static str,
        value: f64,
        wanted: &'static str,
    },
    #[error(
        "joint {joint} of the arm has the range {low_rad} to {high_rad} rad: enter its lower and upper limit in rad"
    )]
    Range {
        /// Counted from 1.
        joint: usize,
        low_rad: f64,
        high_rad: f64,
    },
}

/// Rotation from one joint to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum LinkTurn {
    /// By 180, 90 and -90 degrees about x.
    Half,
    Quarter,
    QuarterBack,
    Any(Matrix3<f64>),
}

impl LinkTurn {
    /// Returns `rotation * Rx(angle)`, exact because only columns and signs are swapped, or `rotation * any`.
    pub(super) fn after(self, rotation: &Matrix3<f64>) -> Matrix3<f64> {
        let [x, y, z] = [0, 1, 2].map(|i| rotation.column(i).into_owned());
        match self {
            Self::Half => Matrix3::from_columns(&[x, -y, -z]),
            Self::Quarter => Matrix3::from_columns(&[x, z, -y]),
            Self::QuarterBack => Matrix3::from_columns(&[x, -z, y]),
            Self::Any(turn) => rotation * turn,
        }
    }
}

/// An arm of at most [`JOINTS`] joints. By value, so that a tick needs no allocation.
///
/// ```
/// use nima_core::kinematics::{ArmModel, Joints};
///
/// let gen3 = ArmModel::GEN3;
/// let mut joints = Joints::zeros();
/// assert!(gen3.limit_margin_rad(&joints) > 0.0);
/// joints[1] = gen3.range_rad(1)[1] + 0.1;
/// assert!((gen3.limit_margin_rad(&joints) + 0.1).abs() < 1e-12, "negative beyond a limit");
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmModel {
    pub(super) joints: usize,
    /// From each joint to the next: translation (m) in the frame of the previous one, then rotation. The last one is the
    /// flange. Every joint turns about the z of its frame.
    pub(super) links: [([f64; 3], LinkTurn); JOINTS + 1],
    /// Range of an unused joint: from zero to zero.
    pub(super) low_rad: [f64; JOINTS],
    pub(super) high_rad: [f64; JOINTS],
    pub(super) speed_rad_s: [f64; JOINTS],
    pub(super) acceleration_rad_s2: [f64; JOINTS],
    /// Joints whose positions (elbow, wrist) must stay above the patient.
    pub(super) high_joints: [usize; 2],
    /// The shoulder on the axis of joint 1, m.
    pub(super) shoulder_m: [f64; 3],
    /// Maximum distance of the flange from the shoulder, m.
    pub(super) reach_m: f64,
}

impl ArmModel {
    /// Creates a model from a checked chain.
    ///
    /// # Errors
    /// [`ArmModelError`] for a chain without 6 or 7 joints, and for numbers that no arm has.
    pub fn new(chain: &ArmChain) -> Result<Self, ArmModelError> {
        let joints = chain.joints.len();
        if !(JOINTS_MIN..=JOINTS).contains(&joints) {
            return Err(ArmModelError::Joints { joints });
        }
        for (place, joint) in chain.joints.iter().enumerate() {
            check_joint(place + 1, joint)?;
        }
        check_pose(joints + 1, &chain.last_from_flange)?;
        // Turned so that every joint rotates about z; the next link undoes it.
        let mut undone = nalgebra::UnitQuaternion::identity();
        let mut links = [([0.0; 3], LinkTurn::Any(Matrix3::identity())); JOINTS + 1];
        let mut model = Self {
            joints,
            links,
            low_rad: [0.0; JOINTS],
            high_rad: [0.0; JOINTS],
            // Values that never limit the other joints.
            speed_rad_s: [1.0; JOINTS],
            acceleration_rad_s2: [f64::INFINITY; JOINTS],
            high_joints: [0; 2],
            shoulder_m: [0.0; 3],
            reach_m: 0.0,
        };
        let link = |from: nalgebra::UnitQuaternion<f64>, pose: &Isometry3<f64>, to: nalgebra::UnitQuaternion<f64>| {
            let shift_m: [f64; 3] = (from * pose.translation.vector).into();
            (shift_m, LinkTurn::Any((from * pose.rotation * to).to_rotation_matrix().into_inner()))
        };
        for (place, joint) in chain.joints.iter().enumerate() {
            let onto_axis = z_onto(&joint.axis.normalize());
            links[place] = link(undone, &joint.from_previous, onto_axis);
            undone = onto_axis.inverse();
            [model.low_rad[place], model.high_rad[place]] = joint.range_rad;
            model.speed_rad_s[place] = joint.speed_rad_s;
            model.acceleration_rad_s2[place] = joint.acceleration_rad_s2;
        }
        links[JOINTS] = link(undone, &chain.last_from_flange, nalgebra::UnitQuaternion::identity());
        model.links = links;
        model.measure();
        Ok(model)
    }

    /// Computes shoulder, reach, elbow and wrist from the links.
    fn measure(&mut self) {
        let length_m = |link: &([f64; 3], LinkTurn)| Vector3::from(link.0).norm();
        let first = &self.links[0];
        let to_second = Vector3::from(self.links[1].0);
        let turn = first.1.after(&Matrix3::identity());
        self.shoulder_m = (Vector3::from(first.0) + turn.column(2) * to_second.z).into();
        // Distance of each joint from joint 2 along the arm; no pose is longer.
        let mut along_m = [0.0; JOINTS];
        for joint in 2..JOINTS {
            along_m[joint] = along_m[joint - 1] + length_m(&self.links[joint]);
        }
        let whole_m = along_m[JOINTS - 1] + length_m(&self.links[JOINTS]);
        self.reach_m = to_second.xy().norm() + whole_m;
        let from_middle_m = |joint: &usize| (along_m[*joint] - 0.5 * whole_m).abs();
        let wrist = self.joints - 2;
        let elbow = (2..wrist).min_by(|a, b| from_middle_m(a).total_cmp(&from_middle_m(b)));
        self.high_joints = [elbow.unwrap_or(2), wrist];
    }

    /// Returns the number of joints, 6 or 7.
    pub const fn joints(&self) -> usize {
        self.joints
    }

    /// Returns lowest and highest angle of a joint (from 0), rad; infinite if it turns without end.
    pub const fn range_rad(&self, joint: usize) -> [f64; 2] {
        [self.low_rad[joint], self.high_rad[joint]]
    }

    /// Returns the maximum speed of each joint, rad/s.
    pub const fn speed_rad_s(&self) -> &[f64; JOINTS] {
        &self.speed_rad_s
    }

    /// Returns the distance of a joint from the nearer end of its range, rad; negative beyond it.
    pub fn margin_rad(&self, joint: usize, angle_rad: f64) -> f64 {
        (self.high_rad[joint] - angle_rad).min(angle_rad - self.low_rad[joint])
    }

    /// Returns the smallest distance of a joint from its limit, rad; negative beyond it.
    pub fn limit_margin_rad(&self, joint_rad: &super::Joints) -> f64 {
        (0..self.joints).map(|joint| self.margin_rad(joint, joint_rad[joint])).fold(f64::INFINITY, f64::min)
    }

    /// Returns the angles (rad) at these fractions of the joints' ranges, from -1 to 1; an endless joint has one turn
    /// about zero.
    pub fn within_ranges(&self, mut fraction: impl FnMut() -> f64) -> super::Joints {
        super::Joints::from_fn(|joint, _| {
            let fraction = fraction();
            let middle_rad = self.middle_rad(joint);
            let low_rad = self.low_rad[joint].max(middle_rad - std::f64::consts::PI);
            let high_rad = self.high_rad[joint].min(middle_rad + std::f64::consts::PI);
            middle_rad + fraction * (0.5 * (high_rad - low_rad))
        })
    }

    /// Returns the same pose, each angle within half a turn of the middle of its range.
    pub(super) fn wrapped(&self, joint_rad: &super::Joints) -> super::Joints {
        super::Joints::from_fn(|joint, _| {
            let angle_rad = joint_rad[joint];
            let turns = ((angle_rad - self.middle_rad(joint)) / std::f64::consts::TAU).round();
            angle_rad - std::f64::consts::TAU * turns
        })
    }

    fn middle_rad(&self, joint: usize) -> f64 {
        let middle_rad = 0.5 * (self.low_rad[joint] + self.high_rad[joint]);
        // An endless joint has no middle.
        if middle_rad.is_finite() { middle_rad } else { 0.0 }
    }
}

/// Returns the shortest rotation that turns z into this unit vector.
fn z_onto(axis: &Vector3<f64>) -> nalgebra::UnitQuaternion<f64> {
    let turn = nalgebra::UnitQuaternion::rotation_between(&Vector3::z(), axis);
    // Opposite directions: any half turn across z.
    turn.unwrap_or_else(|| nalgebra::UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI))
}

fn check_pose(joint: usize, pose: &Isometry3<f64>) -> Result<(), ArmModelError> {
    let value = |what, value, good, wanted| {
        if good { Ok(()) } else { Err(ArmModelError::Value { joint, what, value, wanted }) }
    };
    let length_m = pose.translation.vector.norm();
    value(
        "distance from the joint before, m,",
        length_m,
        length_m <= LINK_MAX_M,
        "at most 3 m: lengths are in metres",
    )?;
    let norm = pose.rotation.quaternion().norm();
    value("rotation", norm, (norm - 1.0).abs() <= ROUNDING, "a unit quaternion")
}

fn check_joint(joint: usize, of: &ChainJoint) -> Result<(), ArmModelError> {
    check_pose(joint, &of.from_previous)?;
    let value = |what, value, good, wanted| {
        if good { Ok(()) } else { Err(ArmModelError::Value { joint, what, value, wanted }) }
    };
    let axis = of.axis.norm();
    value("axis length", axis, axis.is_finite() && axis > 1e-6, "above 0")?;
    let [low_rad, high_rad] = of.range_rad;
    let is_possible = |angle_rad: f64| angle_rad.is_infinite() || angle_rad.abs() <= ANGLE_MAX_RAD;
    // False for NaN.
    let is_wide = high_rad - low_rad >= RANGE_MIN_RAD;
    if !is_wide || !of.range_rad.into_iter().all(is_possible) {
        return Err(ArmModelError::Range { joint, low_rad, high_rad });
    }
    let speed = of.speed_rad_s;
    value("speed limit", speed, speed > 0.0 && speed <= SPEED_MAX_RAD_S, "above 0 and at most 20 rad/s")?;
    let acceleration = of.acceleration_rad_s2;
    let good = acceleration > 0.0 && acceleration <= ACCELERATION_MAX_RAD_S2;
    value("acceleration limit", acceleration, good, "above 0 and at most 200 rad/s^2")
}
