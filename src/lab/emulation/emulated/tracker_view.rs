//! The tracker camera's view of a side's marker and of the endoscope's.

use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use nima_core::{frames::from_roll_pitch_yaw_deg, noise::Noise};
use nima_devices::TrackedTool;
use nima_machine::rig::{ArmSet, EndoscopeSettings};
use nima_simulation::scene::Scene;

use crate::emulators::endoscope::push;

/// Distance of the camera from the workspace's middle, m. Well within the measurement volume of a Polaris Vega, which
/// cannot see markers closer than about 0.95 m (data sheet).
const CAMERA_M: f64 = 1.5;
/// Viewing direction if the scene does not set it: horizontal along the workspace's y (roll, pitch, yaw of
/// `world_from_c`, degrees).
const CAMERA_DEG: Vector3<f64> = Vector3::new(90.0, 0.0, 0.0);
/// Distance of the marker from the wrist sensor, down the shaft, m.
const MARKER_M: f64 = 0.08;
/// Position of the endoscope's marker before the endoscope is pushed: on its shaft outside the patient, m.
const ENDOSCOPE_M: Vector3<f64> = Vector3::new(0.0, -0.25, 0.26);
/// Noise of a marker's position per axis, m. Twice the 0.12 mm RMS that the data sheet of a Polaris Vega states,
/// because its own markers are not the ones used here.
const MARKER_NOISE_M: f64 = 0.000_25;
/// Residual of a marker in good view, m.
const MARKER_ERROR_M: f64 = 0.000_15;

/// Pose of the camera, and mounting of the marker on the instrument.
#[derive(Clone, Debug)]
pub(super) struct CameraMount {
    c_from_world: UnitQuaternion<f64>,
    s1_from_m: UnitQuaternion<f64>,
    noise: Noise,
}

impl CameraMount {
    /// Creates the camera for a scene adapted to its side.
    pub(super) fn new(scene: &Scene, set: &ArmSet) -> Self {
        let camera_deg = scene.tissue_sensor.map_or(CAMERA_DEG, |sensor| sensor.world_from_c_deg);
        let marker_deg = set.s1_from_m_deg.unwrap_or_else(Vector3::zeros);
        Self {
            c_from_world: from_roll_pitch_yaw_deg(&camera_deg).inverse(),
            s1_from_m: from_roll_pitch_yaw_deg(&marker_deg),
            noise: Noise::new(scene.seed ^ 0xca_3e),
        }
    }

    /// Returns the marker on the endoscope, before or after a push.
    pub(super) fn endoscope(
        &mut self,
        world_from_view: &UnitQuaternion<f64>,
        endoscope: &EndoscopeSettings,
        is_moved: bool,
    ) -> TrackedTool {
        let view_from_n = from_roll_pitch_yaw_deg(&endoscope.n_from_view_deg).inverse();
        let mut world_from_n = Isometry3::from_parts(ENDOSCOPE_M.into(), world_from_view * view_from_n);
        if is_moved {
            world_from_n = push() * world_from_n;
        }
        let miss_m = self.miss_m();
        seen(self.c_from_world * world_from_n.rotation, self.c_from_world * world_from_n.translation.vector + miss_m)
    }

    fn miss_m(&mut self) -> Vector3<f64> {
        Vector3::from_fn(|_, _| MARKER_NOISE_M * self.noise.gaussian())
    }

    /// Returns the marker on an instrument whose wrist sensor has this orientation and position (m); `noisy` is the
    /// marker's orientation (`c_from_m`) with the tracker's noise, if the scene has it.
    pub(super) fn marker(
        &mut self,
        world_from_s1: &UnitQuaternion<f64>,
        sensor_m: &Vector3<f64>,
        noisy: Option<UnitQuaternion<f64>>,
    ) -> TrackedTool {
        let marker_m = sensor_m + world_from_s1 * Vector3::new(0.0, 0.0, MARKER_M);
        let c_from_m = noisy.unwrap_or(self.c_from_world * world_from_s1 * self.s1_from_m);
        let miss_m = self.miss_m();
        seen(c_from_m, self.c_from_world * marker_m + miss_m)
    }

    /// Returns the true frames that a hand-eye calibration determines: the marker in the wrist sensor's frame, and the
    /// camera in the workspace.
    pub(super) fn truth(&self) -> [Isometry3<f64>; 2] {
        let marker_m = Vector3::new(0.0, 0.0, MARKER_M);
        let world_from_c = self.c_from_world.inverse();
        let camera_m = world_from_c * Vector3::new(0.0, 0.0, CAMERA_M);
        [Isometry3::from_parts(marker_m.into(), self.s1_from_m), Isometry3::from_parts(camera_m.into(), world_from_c)]
    }
}

/// Returns a tool at this position relative to the middle of the workspace, m; the camera looks along its own -z.
fn seen(c_from_tool: UnitQuaternion<f64>, from_middle_m: Vector3<f64>) -> TrackedTool {
    TrackedTool::Seen {
        c_from_tool,
        position_in_c_m: from_middle_m - Vector3::new(0.0, 0.0, CAMERA_M),
        error_m: MARKER_ERROR_M,
        at_the_edge: false,
    }
}
