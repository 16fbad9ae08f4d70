//! Position of a Gen3's tool in the arm's base frame, from the kinematics in `nima-core`; used by this driver and by
//! the emulator.
//!
//! Angles in rad, lengths in m, in the arm's base frame.

use nalgebra::{Isometry3, IsometryMatrix3, Matrix6, SMatrix, UnitQuaternion, Vector6};
use nima_core::kinematics::{ArmModel, JointChain, Joints};

use crate::ARM_JOINTS;

fn chain(joint_rad: &[f64; ARM_JOINTS]) -> JointChain {
    JointChain::new(&ArmModel::GEN3, &IsometryMatrix3::identity(), &Joints::from(*joint_rad))
}

/// Returns position and orientation of the tool in the base frame.
pub fn tool(joint_rad: &[f64; ARM_JOINTS]) -> Isometry3<f64> {
    let flange = chain(joint_rad).world_from_flange;
    Isometry3::from_parts(flange.translation, UnitQuaternion::from_rotation_matrix(&flange.rotation))
}

/// Returns the orientation angles that the arm reports for a pose, rad: `R = Rz(theta_z) Ry(theta_y) Rx(theta_x)`. No
/// published source confirms this convention; with it the manufacturer's home pose gives 90, 0, 90 degrees.
pub fn theta_rad(rotation: &UnitQuaternion<f64>) -> [f64; 3] {
    let (x, y, z) = rotation.euler_angles();
    [x, y, z]
}

/// Returns the Jacobian: linear (m/s) above angular (rad/s) velocity of the tool in the base frame, per joint speed.
pub fn jacobian(joint_rad: &[f64; ARM_JOINTS]) -> SMatrix<f64, 6, ARM_JOINTS> {
    let chain = chain(joint_rad);
    chain.jacobian(&chain.world_from_flange.translation.vector)
}

/// Returns the joint speeds, rad/s, that move the tool with `twist` (base frame), with damping near singular poses.
pub fn joint_speeds(joint_rad: &[f64; ARM_JOINTS], twist: &Vector6<f64>) -> [f64; ARM_JOINTS] {
    // The square of 0.01: singular values below that are damped, which limits joint speeds near a singular pose.
    const DAMPING: f64 = 1e-4;
    let jacobian = jacobian(joint_rad);
    let damped = jacobian * jacobian.transpose() + Matrix6::identity() * DAMPING;
    let speeds = damped.cholesky().map(|factor| jacobian.transpose() * factor.solve(twist));
    speeds.map_or([0.0; ARM_JOINTS], Into::into)
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix3, Vector3};

    use super::*;

    #[test]
    fn known_poses_come_out() {
        let at = |degrees: [f64; ARM_JOINTS]| tool(&degrees.map(f64::to_radians));
        let near = |pose: &Isometry3<f64>, expected: [f64; 3], within: f64| {
            assert!((pose.translation.vector - Vector3::from(expected)).amax() < within, "{pose}");
        };
        near(&at([0.0; 7]), [0.0, -0.02485, 1.187_385], 1e-6);
        let home = at([0.0, 15.0, 180.0, 230.0, 0.0, 55.0, 90.0]);
        near(&home, [0.456_665, 0.001_350, 0.433_724], 1e-6);
        let rotation = home.rotation.to_rotation_matrix();
        assert!((rotation.matrix() - Matrix3::new(0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0)).amax() < 1e-9);
        let theta_deg = theta_rad(&home.rotation).map(f64::to_degrees);
        assert!((Vector3::from(theta_deg) - Vector3::new(90.0, 0.0, 90.0)).amax() < 1e-6);
        near(&at([0.0, 340.0, 180.0, 214.0, 0.0, 310.0, 90.0]), [0.122_095, 0.00135, 0.328_372], 1e-6);
    }

    #[test]
    fn the_jacobian_is_the_derivative() {
        let joint_rad = [0.3, -0.5, 1.0, -1.2, 0.7, 0.9, -2.0];
        let jacobian = jacobian(&joint_rad);
        let h = 1e-6;
        for j in 0..ARM_JOINTS {
            let mut before = joint_rad;
            let mut after = joint_rad;
            before[j] -= h;
            after[j] += h;
            let before = tool(&before);
            let after = tool(&after);
            let linear = (after.translation.vector - before.translation.vector) / (2.0 * h);
            let angular = (after.rotation * before.rotation.inverse()).scaled_axis() / (2.0 * h);
            assert!((jacobian.fixed_view::<3, 1>(0, j) - linear).amax() < 1e-7);
            assert!((jacobian.fixed_view::<3, 1>(3, j) - angular).amax() < 1e-7);
        }
        let twist = Vector6::new(0.1, 0.0, -0.05, 0.2, 0.0, 0.1);
        let reached = jacobian * SMatrix::<f64, ARM_JOINTS, 1>::from(joint_speeds(&joint_rad, &twist));
        assert!((reached - twist).amax() < 2e-3);
    }
}
