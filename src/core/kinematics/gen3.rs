//! The chain of the Kinova Gen3 with seven joints and spherical wrist.
//!
//! Angles in rad, lengths in m, in the frame the base is mounted in. Constants from `ros2_kortex`
//! (`kortex_description/arms/gen3/7dof/urdf/gen3_macro.xacro`, BSD-3-Clause), with exact right angles where that file
//! rounds them.

use super::arm_model::{ArmModel, JOINTS, LinkTurn};

/// Maximum speed of each joint, rad/s: 80 and 70 degrees per second (`gen3_macro.xacro`, `velocity`).
pub const SPEED_RAD_S: [f64; JOINTS] = [1.3963, 1.3963, 1.3963, 1.3963, 1.2218, 1.2218, 1.2218];

/// Maximum acceleration of each joint, rad/s^2: the hard joint limits of `ros_kortex`.
pub const ACCELERATION_RAD_S2: [f64; JOINTS] = [4.94, 4.94, 4.94, 4.94, 9.5, 9.5, 9.5];

/// Largest angle of each joint in both directions, rad (`gen3_macro.xacro`, `limit`); infinite for a continuous joint.
pub const LIMIT_RAD: [f64; JOINTS] = [f64::INFINITY, 2.24, f64::INFINITY, 2.57, f64::INFINITY, 2.09, f64::INFINITY];

/// Height of the shoulder (joint 2) above the base, m (`gen3_macro.xacro`: base to joint 1, plus joint 1 to joint 2).
const SHOULDER_M: f64 = 0.284_81;
/// Maximum distance of the flange from the shoulder, m: the sum of the links in a straight line, plus 2 mm because the
/// joints are not exactly on one line.
/// The three links are `d` of joints 3, 5 and 7 in Kinova's DH table.
const REACH_M: f64 = 0.420_76 + 0.314_36 + 0.167_455 + 0.002;

/// From each joint to the next: translation (m) in the frame of the previous one, then rotation. The last one is the
/// flange.
/// From the URDF with exact quarter turns instead of its 1.5708, so that errors of 4e-6 rad per joint do not add up.
const LINKS: [([f64; 3], LinkTurn); JOINTS + 1] = [
    ([0.0, 0.0, 0.156_43], LinkTurn::Half),
    ([0.0, 0.005_375, -0.128_38], LinkTurn::Quarter),
    ([0.0, -0.210_38, -0.006_375], LinkTurn::QuarterBack),
    ([0.0, 0.006_375, -0.210_38], LinkTurn::Quarter),
    ([0.0, -0.208_43, -0.006_375], LinkTurn::QuarterBack),
    ([0.0, 0.000_175_05, -0.105_93], LinkTurn::Quarter),
    ([0.0, -0.105_93, -0.000_175_05], LinkTurn::QuarterBack),
    ([0.0, 0.0, -0.061_525], LinkTurn::Half),
];

const fn lowest(high_rad: [f64; JOINTS]) -> [f64; JOINTS] {
    let mut low_rad = high_rad;
    let mut joint = 0;
    while joint < JOINTS {
        low_rad[joint] = -high_rad[joint];
        joint += 1;
    }
    low_rad
}

impl ArmModel {
    /// The Kinova Gen3 with seven joints.
    pub const GEN3: Self = Self {
        joints: JOINTS,
        links: LINKS,
        low_rad: lowest(LIMIT_RAD),
        high_rad: LIMIT_RAD,
        speed_rad_s: SPEED_RAD_S,
        acceleration_rad_s2: ACCELERATION_RAD_S2,
        high_joints: [3, 5],
        shoulder_m: [0.0, 0.0, SHOULDER_M],
        reach_m: REACH_M,
    };
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use nalgebra::{Isometry3, IsometryMatrix3, Matrix3, Vector3};

    use super::*;
    use crate::kinematics::{JointChain, Joints};

    fn flange(joint_rad: &Joints) -> IsometryMatrix3<f64> {
        JointChain::new(&ArmModel::GEN3, &IsometryMatrix3::identity(), joint_rad).world_from_flange
    }

    fn random_joints() -> Joints {
        Joints::from_fn(|_, _| (fastrand::f64() - 0.5) * 2.0 * PI)
    }

    #[test]
    fn the_reference_poses_of_the_maker_are_met() {
        let degrees = |angles: [f64; JOINTS]| Joints::from(angles).map(f64::to_radians);
        let zero = flange(&Joints::zeros()).translation.vector;
        assert!((zero - Vector3::new(0.0, -0.024_85, 1.187_385)).norm() < 1e-6, "{zero}");
        let home = flange(&degrees([0.0, 15.0, 180.0, 230.0, 0.0, 55.0, 90.0]));
        assert!((home.translation.vector - Vector3::new(0.456_665, 0.001_350, 0.433_724)).norm() < 1e-6);
        let expected = Matrix3::new(0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0);
        assert!((home.rotation.matrix() - expected).norm() < 1e-12);
        let retract = flange(&degrees([0.0, 340.0, 180.0, 214.0, 0.0, 310.0, 90.0]));
        assert!((retract.translation.vector - Vector3::new(0.122_095, 0.001_35, 0.328_372)).norm() < 1e-6);
    }

    #[test]
    fn the_makers_table_of_denavit_and_hartenberg_gives_the_same_flange() {
        // alpha, a, d, offset of theta; the first row is the base.
        const ROWS: [[f64; 3]; JOINTS] = [
            [FRAC_PI_2, -0.284_81, 0.0],
            [FRAC_PI_2, -0.011_75, PI],
            [FRAC_PI_2, -0.420_76, PI],
            [FRAC_PI_2, -0.012_75, PI],
            [FRAC_PI_2, -0.314_36, PI],
            [FRAC_PI_2, -0.000_350_1, PI],
            [PI, -0.167_455, PI],
        ];
        fastrand::seed(3);
        for _ in 0..300 {
            let joint_rad = random_joints();
            let mut expected = Isometry3::rotation(Vector3::x() * PI);
            for ([alpha, d, offset], q) in ROWS.iter().zip(joint_rad.iter()) {
                expected *= Isometry3::rotation(Vector3::z() * (q + offset))
                    * Isometry3::translation(0.0, 0.0, *d)
                    * Isometry3::rotation(Vector3::x() * *alpha);
            }
            let ours = flange(&joint_rad);
            assert!((ours.translation.vector - expected.translation.vector).norm() < 1e-12);
            let rotation = expected.rotation.to_rotation_matrix();
            assert!((ours.rotation.matrix() - rotation.matrix()).norm() < 1e-12);
        }
    }

    #[test]
    fn the_jacobian_is_the_slope_of_the_forward_kinematics() {
        const H: f64 = 1e-6;
        fastrand::seed(4);
        let mount = IsometryMatrix3::new(Vector3::new(0.3, -0.2, 0.1), Vector3::new(0.4, 0.3, -1.0));
        for _ in 0..50 {
            let joint_rad = random_joints();
            let chain = JointChain::new(&ArmModel::GEN3, &mount, &joint_rad);
            let on_flange_m = Vector3::new(0.02, -0.01, 0.4);
            let point_m = chain.world_from_flange * nalgebra::Point3::from(on_flange_m);
            let jacobian = chain.jacobian(&point_m.coords);
            for joint in 0..JOINTS {
                let at = |step: f64| {
                    let mut moved = joint_rad;
                    moved[joint] += step;
                    JointChain::new(&ArmModel::GEN3, &mount, &moved).world_from_flange
                };
                let before = at(-H);
                let after = at(H);
                let place = (after * nalgebra::Point3::from(on_flange_m)
                    - before * nalgebra::Point3::from(on_flange_m))
                    / (2.0 * H);
                let between = (after.rotation * before.rotation.inverse()).into_inner();
                // Twice the sine of the small angle.
                let turn = Vector3::new(
                    between[(2, 1)] - between[(1, 2)],
                    between[(0, 2)] - between[(2, 0)],
                    between[(1, 0)] - between[(0, 1)],
                ) / (4.0 * H);
                assert!((jacobian.fixed_view::<3, 1>(0, joint) - place).norm() < 1e-8);
                assert!((jacobian.fixed_view::<3, 1>(3, joint) - turn).norm() < 1e-8);
            }
        }
    }

    #[test]
    fn the_flange_never_leaves_its_reach() {
        fastrand::seed(5);
        let shoulder_m = Vector3::z() * SHOULDER_M;
        let furthest = (0..20_000)
            .map(|_| (flange(&random_joints()).translation.vector - shoulder_m).norm())
            .chain([(flange(&Joints::zeros()).translation.vector - shoulder_m).norm()])
            .fold(0.0, f64::max);
        assert!(furthest <= REACH_M && furthest > REACH_M - 0.005, "{furthest}");
    }
}
