//! Forward kinematics and Jacobian of an arm. Nothing is checked here: a joint angle that is not finite gives a pose that
//! is not finite.

use nalgebra::{IsometryMatrix3, Matrix3, Rotation3, SMatrix, SVector, Translation3, Vector3};

use super::arm_model::{ArmModel, JOINTS};

/// One number per joint, from the base to the flange; zero for an unused joint.
pub type Joints = SVector<f64, JOINTS>;

/// Positions and axes of all joints for one set of joint angles, in the frame `world` in which the base is mounted.
#[derive(Clone, Copy, Debug)]
pub struct JointChain {
    /// A point on each joint's axis, m.
    pub origin_m: [Vector3<f64>; JOINTS],
    /// Axis of each joint, unit length; positive angles are right-handed about it. Zero for an unused joint.
    pub axis: [Vector3<f64>; JOINTS],
    /// The flange (the manufacturer's tool frame); z points away from the arm.
    pub world_from_flange: IsometryMatrix3<f64>,
}

impl JointChain {
    /// Computes the forward kinematics of an arm with its base at `world_from_base`.
    pub fn new(model: &ArmModel, world_from_base: &IsometryMatrix3<f64>, joint_rad: &Joints) -> Self {
        let mut rotation = *world_from_base.rotation.matrix();
        let mut place_m = world_from_base.translation.vector;
        let mut origin_m = [Vector3::zeros(); JOINTS];
        let mut axis = [Vector3::zeros(); JOINTS];
        for (i, (shift_m, turn)) in model.links.iter().enumerate() {
            place_m += rotation * Vector3::from(*shift_m);
            rotation = turn.after(&rotation);
            if i == JOINTS {
                break;
            }
            origin_m[i] = place_m;
            if i < model.joints {
                axis[i] = rotation.column(2).into_owned();
                rotation = turned_about_z(&rotation, joint_rad[i]);
            }
        }
        let rotation = Rotation3::from_matrix_unchecked(rotation);
        Self { origin_m, axis, world_from_flange: IsometryMatrix3::from_parts(Translation3::from(place_m), rotation) }
    }

    /// Returns the velocity (m/s) of a point (m) that is fixed to the flange, per rad/s of one joint.
    pub fn point_per_joint(&self, joint: usize, point_m: &Vector3<f64>) -> Vector3<f64> {
        self.axis[joint].cross(&(point_m - self.origin_m[joint]))
    }

    /// Returns the geometric Jacobian of a point (m) fixed to the flange: rows velocity (m/s) and angular velocity
    /// (rad/s), in `world`.
    pub fn jacobian(&self, point_m: &Vector3<f64>) -> SMatrix<f64, 6, JOINTS> {
        let mut jacobian = SMatrix::<f64, 6, JOINTS>::zeros();
        for joint in 0..JOINTS {
            jacobian.fixed_view_mut::<3, 1>(0, joint).copy_from(&self.point_per_joint(joint, point_m));
            jacobian.fixed_view_mut::<3, 1>(3, joint).copy_from(&self.axis[joint]);
        }
        jacobian
    }
}

/// Returns `rotation * Rz(angle)`.
fn turned_about_z(rotation: &Matrix3<f64>, angle_rad: f64) -> Matrix3<f64> {
    let (sin, cos) = libm::sincos(angle_rad);
    let [x, y, z] = [0, 1, 2].map(|i| rotation.column(i).into_owned());
    Matrix3::from_columns(&[x * cos + y * sin, y * cos - x * sin, z])
}
