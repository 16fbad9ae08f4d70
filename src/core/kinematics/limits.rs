//! How fast the joints may move. [`Inverse`](super::Inverse) plans within these limits; a driver checks them and changes nothing.
//!
//! One owner, because a joint that is slowed down alone takes the shaft out of the trocar: whoever slows a joint down must slow down
//! all of them along the same path, and only the inverse kinematics knows that path.

use super::gen3::{ACCELERATION_RAD_S2, JOINTS, Joints, SPEED_RAD_S};

/// Limits of every joint. The ranges are [`LIMIT_RAD`](super::LIMIT_RAD).
///
/// ```
/// use nima_core::kinematics::JointLimits;
///
/// let (half, full) = (JointLimits::of_arm(0.5, 0.1), JointLimits::of_arm(1.0, 0.1));
/// assert!((half.braking_s() - 0.5 * full.braking_s()).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointLimits {
    /// Highest speed, rad/s.
    pub speed_rad_s: Joints,
    /// Highest acceleration, rad/s^2; infinite where only the path counts.
    pub acceleration_rad_s2: Joints,
    /// The most that a command may be ahead of the measured angle, rad: something holds an arm that is further behind.
    pub lead_rad: f64,
}

impl JointLimits {
    /// The arm's speeds alone: for a search of poses, where time does not count.
    pub fn speed_only() -> Self {
        Self {
            speed_rad_s: Joints::from(SPEED_RAD_S),
            acceleration_rad_s2: Joints::repeat(f64::INFINITY),
            lead_rad: f64::INFINITY,
        }
    }

    /// An arm that may use a share of its speeds, above 0 to 1.
    pub fn of_arm(speed_fraction: f64, lead_rad: f64) -> Self {
        Self {
            speed_rad_s: Joints::from(SPEED_RAD_S) * speed_fraction.clamp(0.0, 1.0),
            acceleration_rad_s2: Joints::from(ACCELERATION_RAD_S2),
            lead_rad,
        }
    }

    /// Longest time to brake from full speed with one factor for all joints, s.
    pub fn braking_s(&self) -> f64 {
        (0..JOINTS).map(|joint| self.speed_rad_s[joint] / self.acceleration_rad_s2[joint]).fold(0.0, f64::max)
    }
}
