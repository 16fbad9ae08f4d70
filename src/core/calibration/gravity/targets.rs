//! Orientations that together cover all directions of gravity.

use nalgebra::{UnitQuaternion, Vector3};

/// A target orientation of the tool. Gravity does not depend on rotation about the vertical, so only tilt matters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseTarget {
    pub name: &'static str,
    /// Direction of gravity in `s1` in this pose (z along the shaft towards the tip), not normalised.
    pub down_s1: [f64; 3],
}

impl PoseTarget {
    /// Returns the orientation of the sensor with the smallest rotation from the base's frame.
    pub fn world_from_s1(&self) -> UnitQuaternion<f64> {
        let from = Vector3::from(self.down_s1);
        let to = -Vector3::z();
        // For the opposite direction, use a half turn about a horizontal axis.
        UnitQuaternion::rotation_between(&from, &to)
            .unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI))
    }
}

const fn target(name: &'static str, down_s1: [f64; 3]) -> PoseTarget {
    PoseTarget { name, down_s1 }
}

/// Twelve directions: along the axes, then in between, the easy ones first. Every direction is within 45 degrees of one
/// of them.
pub const TARGETS: [PoseTarget; 12] = [
    target("shaft down", [0.0, 0.0, 1.0]),
    target("shaft level, +x side down", [1.0, 0.0, 0.0]),
    target("shaft level, +y side down", [0.0, 1.0, 0.0]),
    target("shaft level, -x side down", [-1.0, 0.0, 0.0]),
    target("shaft level, -y side down", [0.0, -1.0, 0.0]),
    target("half down, between +x and +y", [0.6, 0.6, 0.7]),
    target("half down, between -x and +y", [-0.6, 0.6, 0.7]),
    target("half down, between -x and -y", [-0.6, -0.6, 0.7]),
    target("half down, between +x and -y", [0.6, -0.6, 0.7]),
    target("half up, between +x and +y", [0.7, 0.7, -0.5]),
    target("half up, between -x and -y", [-0.7, -0.7, -0.5]),
    target("shaft up", [0.0, 0.0, -1.0]),
];
