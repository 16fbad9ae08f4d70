//! Speed and acceleration limits of the joints. [`Inverse`](super::Inverse) plans within them; a driver only checks
//! them.
//!
//! Only the inverse kinematics may slow the joints down. Slowing a single joint would take the shaft out of the trocar:
//! all joints must be slowed along the same path, which only the inverse kinematics can compute.

use super::{
    arm_model::{ArmModel, JOINTS},
    joint_chain::Joints,
};

/// Limits of every joint.
///
/// ```
/// use nima_core::kinematics::{ArmModel, JointLimits};
///
/// let [half, full] = [0.5, 1.0].map(|fraction| JointLimits::of_arm(&ArmModel::GEN3, fraction, 0.1));
/// assert!((half.braking_s() - 0.5 * full.braking_s()).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointLimits {
    /// Lowest and highest angle, rad; infinite for a joint that turns without end.
    pub low_rad: Joints,
    pub high_rad: Joints,
    pub speed_rad_s: Joints,
    /// Largest acceleration, rad/s^2; infinite if only the path matters.
    pub acceleration_rad_s2: Joints,
    /// Maximum difference between commanded and measured angle, rad; an arm that is further behind is blocked.
    pub lead_rad: f64,
}

impl JointLimits {
    /// Returns only the speed limits of the arm, for the search of poses.
    pub fn speed_only(model: &ArmModel) -> Self {
        let acceleration_rad_s2 = Joints::repeat(f64::INFINITY);
        Self { acceleration_rad_s2, ..Self::of_arm(model, 1.0, f64::INFINITY) }
    }

    /// Returns the limits of an arm that may use this fraction of its speed, above 0 to 1.
    pub fn of_arm(model: &ArmModel, speed_fraction: f64, lead_rad: f64) -> Self {
        Self {
            low_rad: Joints::from(model.low_rad),
            high_rad: Joints::from(model.high_rad),
            speed_rad_s: Joints::from(model.speed_rad_s) * speed_fraction.clamp(0.0, 1.0),
            acceleration_rad_s2: Joints::from(model.acceleration_rad_s2),
            lead_rad,
        }
    }

    /// Returns the longest time to brake from full speed with one common factor for all joints, s.
    pub fn braking_s(&self) -> f64 {
        (0..JOINTS).map(|joint| self.speed_rad_s[joint] / self.acceleration_rad_s2[joint]).fold(0.0, f64::max)
    }
}
