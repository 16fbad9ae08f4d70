//! The endoscope camera: the default camera of a scene, and conversion of a rig file's camera to the image's lens and
//! pose.

use nalgebra::{Isometry3, UnitQuaternion, Vector2, Vector3};
use nima_core::frames::from_roll_pitch_yaw_deg;
use nima_endoscope::{Bend, Camera, Lens};
use nima_machine::config::EndoscopeCamera;

use crate::scene::Scene;

/// Size of the default image, px, and its radial distortion: barrel, as in most endoscopes.
const SIZE_PX: [usize; 2] = [1280, 720];
const K1: f64 = -0.3;
/// Vertical opening angle without distortion, rad; distance from the middle of the field, m; angle above the horizon,
/// rad: the values of the console's drawn view.
const FIELD_OF_VIEW: f64 = 0.92;
const DISTANCE_M: f64 = 0.128;
const PITCH: f64 = 0.72;
const MIDDLE_M: Vector3<f64> = Vector3::new(0.0, 0.0, 0.006);

/// Returns the default camera of a scene in a rig file's form: between two instruments, or to the side of a single one.
pub fn usual(scene: &Scene) -> EndoscopeCamera {
    let yaw: f64 = if scene.left.is_some() || scene.wire.is_some() { 0.0 } else { -0.55 };
    let back_m = Vector3::new(yaw.sin() * PITCH.cos(), -yaw.cos() * PITCH.cos(), PITCH.sin()) * DISTANCE_M;
    EndoscopeCamera {
        size_px: SIZE_PX,
        focal_px: 0.5 * SIZE_PX[1] as f64 / (0.5 * FIELD_OF_VIEW).tan(),
        focal_y_px: None,
        centre_px: None,
        k1: K1,
        k2: 0.0,
        p1: 0.0,
        p2: 0.0,
        position_m: Some(MIDDLE_M + back_m),
        world_from_camera_deg: Some(Vector3::new(-90.0 - PITCH.to_degrees(), 0.0, yaw.to_degrees())),
        n_from_camera_m: None,
        n_from_camera_deg: None,
        checked_px: None,
    }
}

/// Returns the lens that a rig file describes.
pub fn lens_of(settings: &EndoscopeCamera) -> Lens {
    let EndoscopeCamera { size_px, focal_px, focal_y_px, centre_px, k1, k2, p1, p2, .. } = *settings;
    let middle_px = Vector2::from(size_px.map(|side| 0.5 * side as f64));
    let focal_px = Vector2::new(focal_px, focal_y_px.unwrap_or(focal_px));
    Lens { size_px, focal_px, centre_px: centre_px.map_or(middle_px, Vector2::from), bend: Bend { k1, k2, p1, p2 } }
}

/// Returns the camera that a rig file describes; at the workspace's origin if its pose is unknown.
pub fn camera_of(settings: &EndoscopeCamera) -> Camera {
    let rotation: UnitQuaternion<f64> = from_roll_pitch_yaw_deg(&settings.world_from_camera_deg.unwrap_or_default());
    let place_m = settings.position_m.unwrap_or_default();
    Camera { lens: lens_of(settings), world_from_camera: Isometry3::from_parts(place_m.into(), rotation) }
}
