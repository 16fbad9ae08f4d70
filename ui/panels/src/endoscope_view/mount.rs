//! Pose of the camera: fixed in the workspace, or on the endoscope's marker, which the tracker sees.

use nalgebra::Isometry3;
use nima_core::frames::from_roll_pitch_yaw_deg;
use nima_endoscope::{Camera, Lens};
use nima_machine::config::EndoscopeCamera;
use nima_simulation::camera::{camera_of, lens_of};

/// Averaging time of the tracker's noise, s. At the tips, some decimetres from the marker, the noise of a single reading is
/// visible.
pub(super) const STEADY_S: f64 = 0.25;

/// Mounting of the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Mount {
    Fixed(Camera),
    OnMarker { lens: Lens, n_from_camera: Isometry3<f64> },
}

impl Mount {
    /// Creates the mount from the rig file; `None` if the file has no camera pose.
    pub(super) fn of(settings: &EndoscopeCamera) -> Option<Self> {
        if let Some((position_m, turn_deg)) = settings.n_from_camera_m.zip(settings.n_from_camera_deg) {
            let n_from_camera = Isometry3::from_parts(position_m.into(), from_roll_pitch_yaw_deg(&turn_deg));
            return Some(Self::OnMarker { lens: lens_of(settings), n_from_camera });
        }
        settings.position_m.is_some().then(|| Self::Fixed(camera_of(settings)))
    }

    /// Returns the camera in the workspace, with its marker; `None` while the pose of the marker is unknown.
    pub(super) fn camera(&self, world_from_n: Option<&Isometry3<f64>>) -> Option<Camera> {
        match self {
            Self::Fixed(camera) => Some(*camera),
            Self::OnMarker { lens, n_from_camera } => {
                Some(Camera { lens: *lens, world_from_camera: world_from_n? * n_from_camera })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;

    #[test]
    fn a_camera_on_the_marker_goes_where_the_marker_goes() {
        let scene = nima_simulation::scene::Scene::load("bimanual").unwrap();
        let mut settings = nima_simulation::camera::usual(&scene);
        let fixed = Mount::of(&settings).unwrap().camera(None).unwrap();
        settings.position_m = None;
        settings.world_from_camera_deg = None;
        assert_eq!(Mount::of(&settings), None);
        settings.n_from_camera_m = Some(Vector3::new(0.0, 0.01, 0.3));
        settings.n_from_camera_deg = Some(Vector3::new(0.0, 0.0, 90.0));
        let mount = Mount::of(&settings).unwrap();
        assert_eq!(mount.camera(None), None);
        let n_from_camera = Isometry3::from_parts(
            Vector3::new(0.0, 0.01, 0.3).into(),
            from_roll_pitch_yaw_deg(&Vector3::new(0.0, 0.0, 90.0)),
        );
        let world_from_n = fixed.world_from_camera * n_from_camera.inverse();
        let camera = mount.camera(Some(&world_from_n)).unwrap();
        let tip_m = Vector3::new(0.01, 0.02, 0.004);
        assert!((camera.project(&tip_m).unwrap() - fixed.project(&tip_m).unwrap()).norm() < 1e-9);
    }
}
