//! Speed and acceleration limits of the joints. [`Inverse`](super::Inverse) plans within them; a driver only checks
//! them.
//!
//! Only the inverse kinematics may slow the joints down. Slowing a single joint would take the shaft out of the trocar:
//! all joints must be slowed along the same path, which only the inverse kinematics can compute.

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
    pub speed_rad_s: Joints,
    /// Largest acceleration, rad/s^2; infinite if only the path matters.
    pub acceleration_rad_s2: Joints,
    /// Maximum difference between commanded and measured angle, rad; an arm that is further behind is blocked.
    pub lead_rad: f64,
}

impl JointLimits {
    /// Returns only the speed limits of the arm, for the search of poses.
    pub fn speed_only() -> Self {
        Self {
            speed_rad_s: Joints::from(SPEED_RAD_S),
            acceleration_rad_s2: Joints::repeat(f64::INFINITY),
            lead_rad: f64::INFINITY,
        }
    }

    /// Returns the limits of an arm that may use this fraction of its speed, above 0 to 1.
    pub fn of_arm(speed_fraction: f64, lead_rad: f64) -> Self {
        Self {
            speed_rad_s: Joints::from(SPEED_RAD_S) * speed_fraction.clamp(0.0, 1.0),
            acceleration_rad_s2: Joints::from(ACCELERATION_RAD_S2),
            lead_rad,
        }
    }

    /// Returns the longest time to brake from full speed with one common factor for all joints, s.
    pub fn braking_s(&self) -> f64 {
        (0..JOINTS).map(|joint| self.speed_rad_s[joint] / self.acceleration_rad_s2[joint]).fold(0.0, f64::max)
    }
}
