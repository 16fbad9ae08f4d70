//! What the tracker's camera sees of a side's marker and of the endoscope's.

use nalgebra::{UnitQuaternion, Vector3};
use nima_core::frames::from_roll_pitch_yaw_deg;
use nima_devices::Tracked;
use nima_machine::rig::{ArmSet, EndoscopeSettings};

use crate::scene::Scene;

/// Distance of the camera from the workspace's middle, m.
const CAMERA_M: f64 = 1.5;
/// Where it looks from where no scene says: level along the workspace's y (roll, pitch, yaw of `world_from_c`, degrees).
const CAMERA_DEG: Vector3<f64> = Vector3::new(90.0, 0.0, 0.0);
/// The marker sits so far down the shaft from the wrist sensor, m.
const MARKER_M: f64 = 0.08;
/// Residual of a marker that is well seen, m.
const MARKER_ERROR_M: f64 = 0.000_15;

/// Where the camera is, and how the marker sits on the instrument.
#[derive(Clone, Copy, Debug)]
pub(super) struct Camera {
    c_from_world: UnitQuaternion<f64>,
    s1_from_m: UnitQuaternion<f64>,
}

impl Camera {
    /// For a scene that has been made fit for its side.
    pub(super) fn new(scene: &Scene, set: &ArmSet) -> Self {
        let camera_deg = scene.tissue_sensor.map_or(CAMERA_DEG, |sensor| sensor.world_from_c_deg);
        let marker_deg = set.s1_from_m_deg.unwrap_or_else(Vector3::zeros);
        Self {
            c_from_world: from_roll_pitch_yaw_deg(&camera_deg).inverse(),
            s1_from_m: from_roll_pitch_yaw_deg(&marker_deg),
        }
    }

    /// The marker on the endoscope.
    pub(super) fn endoscope(&self, world_from_view: &UnitQuaternion<f64>, endoscope: &EndoscopeSettings) -> Tracked {
        let view_from_n = from_roll_pitch_yaw_deg(&endoscope.n_from_view_deg).inverse();
        seen(self.c_from_world * world_from_view * view_from_n, Vector3::zeros())
    }

    /// The marker on an instrument whose wrist sensor is turned like this, with its origin here (m); `noisy` is its
    /// orientation (`c_from_m`) with the tracker's noise, if the scene has it.
    pub(super) fn marker(
        &self,
        world_from_s1: &UnitQuaternion<f64>,
        sensor_m: &Vector3<f64>,
        noisy: Option<UnitQuaternion<f64>>,
    ) -> Tracked {
        let marker_m = sensor_m + world_from_s1 * Vector3::new(0.0, 0.0, MARKER_M);
        let c_from_m = noisy.unwrap_or(self.c_from_world * world_from_s1 * self.s1_from_m);
        seen(c_from_m, self.c_from_world * marker_m)
    }
}

/// At this place as seen from the middle of the workspace, m; the camera looks along its own -z.
fn seen(c_from_tool: UnitQuaternion<f64>, from_middle_m: Vector3<f64>) -> Tracked {
    Tracked::Seen {
        c_from_tool,
        position_in_c_m: from_middle_m - Vector3::new(0.0, 0.0, CAMERA_M),
        error_m: MARKER_ERROR_M,
        at_the_edge: false,
    }
}
