use nalgebra::{UnitQuaternion, Vector3};
use nima_core::{
    frames::from_roll_pitch_yaw_deg,
    kinematics::{MotionMapping, view_from_omega},
};
use serde::{Deserialize, Serialize};

/// Mapping from the hand's motion to the tip's: `world_from_view * view_from_leader`, and the scale.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Teleoperation {
    /// Travel of the tip per travel of the hand.
    pub scale: f64,
    /// Orientation of the endoscope: roll, pitch, yaw of `world_from_view`, degrees (image: x right, y down, z into the
    /// image).
    pub world_from_view_deg: Vector3<f64>,
    /// Orientation of the leader relative to the image.
    pub leader: LeaderMount,
    /// Measured orientation of the leader: roll, pitch, yaw of `view_from_leader`, degrees; replaces
    /// [`leader`](Self::leader).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub view_from_leader_deg: Option<Vector3<f64>>,
}

impl Default for Teleoperation {
    fn default() -> Self {
        Self {
            scale: 1.0,
            world_from_view_deg: Vector3::zeros(),
            leader: LeaderMount::Workspace,
            view_from_leader_deg: None,
        }
    }
}

/// Orientation of a leader relative to the image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LeaderMount {
    /// The leader's axes coincide with the image axes.
    #[default]
    Workspace,
    /// An Omega below the screen, with its base facing the user.
    Omega,
}

impl Teleoperation {
    /// Returns the mapping; the default mapping if the numbers are not finite (which [`RigConfig::validate`] refuses).
    pub fn mapping(&self) -> MotionMapping {
        self.seen(&from_roll_pitch_yaw_deg(&self.world_from_view_deg), self.scale)
    }

    /// Returns the mapping for an endoscope with this orientation; the default mapping if the numbers are not finite.
    pub fn seen(&self, world_from_view: &UnitQuaternion<f64>, scale: f64) -> MotionMapping {
        MotionMapping::new(world_from_view, &self.view_from_leader(), scale).unwrap_or_default()
    }

    /// Returns the orientation of the leader relative to the image: the measured one, otherwise the typical one for its
    /// mount.
    pub fn view_from_leader(&self) -> UnitQuaternion<f64> {
        match (&self.view_from_leader_deg, self.leader) {
            (Some(measured_deg), _) => from_roll_pitch_yaw_deg(measured_deg),
            (None, LeaderMount::Workspace) => UnitQuaternion::identity(),
            (None, LeaderMount::Omega) => view_from_omega(),
        }
    }
}
