//! The instrument's own wrist: roll about the shaft, then pitch, then yaw of the jaws: `s1_from_jaws = Rz(roll) Rx(pitch) Ry(yaw)`.

use nalgebra::{Rotation3, UnitQuaternion, Vector3};

/// Largest pitch, rad: at a quarter turn roll and yaw would coincide.
/// About 75 degrees: the other 15 keep roll and yaw defined despite small errors of the pitch.
pub const PITCH_MAX_RAD: f64 = 1.3;

/// Angles of the instrument's wrist, rad.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WristJaws {
    pub roll_rad: f64,
    /// Rotation across the shaft.
    pub pitch_rad: f64,
    /// Rotation perpendicular to both axes.
    pub yaw_rad: f64,
}

impl WristJaws {
    pub fn s1_from_jaws(&self) -> UnitQuaternion<f64> {
        UnitQuaternion::from_axis_angle(&Vector3::z_axis(), self.roll_rad)
            * UnitQuaternion::from_axis_angle(&Vector3::x_axis(), self.pitch_rad)
            * UnitQuaternion::from_axis_angle(&Vector3::y_axis(), self.yaw_rad)
    }

    /// Returns the angles for an orientation, each within half a turn of the angles of `near`, with pitch limited to
    /// [`PITCH_MAX_RAD`].
    pub fn of(s1_from_jaws: &UnitQuaternion<f64>, near: &Self) -> Self {
        let r: Rotation3<f64> = s1_from_jaws.to_rotation_matrix();
        let pitch_rad = libm::asin(r[(2, 1)].clamp(-1.0, 1.0));
        let roll_rad = libm::atan2(-r[(0, 1)], r[(1, 1)]);
        let yaw_rad = libm::atan2(-r[(2, 0)], r[(2, 2)]);
        Self {
            roll_rad: nearest(roll_rad, near.roll_rad),
            pitch_rad: pitch_rad.clamp(-PITCH_MAX_RAD, PITCH_MAX_RAD),
            yaw_rad: nearest(yaw_rad, near.yaw_rad),
        }
    }
}

/// Returns the equivalent angle that is nearest to `near_rad`.
fn nearest(angle_rad: f64, near_rad: f64) -> f64 {
    angle_rad + std::f64::consts::TAU * ((near_rad - angle_rad) / std::f64::consts::TAU).round()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn angles_and_orientation_are_each_others_inverse(roll_rad in -9.0..9.0f64, pitch_rad in -1.29..1.29f64, yaw_rad in -3.0..3.0f64) {
            let jaws = WristJaws { roll_rad, pitch_rad, yaw_rad };
            let back = WristJaws::of(&jaws.s1_from_jaws(), &jaws);
            prop_assert!((back.roll_rad - roll_rad).abs() < 1e-9);
            prop_assert!((back.pitch_rad - pitch_rad).abs() < 1e-9);
            prop_assert!((back.yaw_rad - yaw_rad).abs() < 1e-9);
        }
    }
}
