//! An emulated endoscope: renders the simulated scene through a lens that bends the picture, and serves it as motion JPEG over HTTP on loopback.
//!
//! What is seen comes from its [`Body`], a closure of the emulator's time. A code in the upper left corner of the picture tells when it was
//! rendered. Pictures are made only while somebody watches. Faults that concern the meaning are its own (`freeze`, `black`, `torn`, `late`,
//! `wrong-size`, `other-format`); a client that does not take its pictures is cut off.

pub(super) mod alone;
mod draw;
mod serve;
#[cfg(test)]
mod tests;
mod workshop;

use nalgebra::{Isometry3, UnitQuaternion, Vector2, Vector3};
use nima_core::frames::from_roll_pitch_yaw_deg;
use nima_endoscope::{Camera, Lens};
use nima_machine::config::EndoscopeCamera;

use super::Emulator;
use crate::scene::Scene;

/// One instrument as an endoscope sees it, in the workspace.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instrument {
    /// Its tip, m.
    pub tip_m: Vector3<f64>,
    /// Its trocar, m.
    pub trocar_m: Vector3<f64>,
}

/// The instruments at a time, s since the emulator began.
pub type Body = Box<dyn FnMut(f64) -> Vec<Instrument> + Send>;

/// How an emulated endoscope is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emulated {
    /// TCP port; 0 takes a free one.
    pub port: u16,
    /// Pictures a second.
    pub rate_hz: f64,
    /// Its lens and its place.
    pub camera: Camera,
    /// Side of a square of the time code, px; 0 draws none.
    pub square_px: usize,
    /// Quality of the JPEGs, 1 to 100.
    pub quality: u8,
    /// Pictures are made with less claim to a processor than other threads have: beside emulators that serve a loop.
    pub gives_way: bool,
}

impl Emulated {
    /// The usual endoscope of a scene, on this port.
    pub fn of(scene: &Scene, port: u16) -> Self {
        Self {
            port,
            rate_hz: 30.0,
            camera: camera_of(&usual(scene)),
            square_px: SQUARE_PX,
            quality: 80,
            gives_way: false,
        }
    }

    /// With what it sees.
    pub fn with(self, scene: &Scene, body: Body) -> Box<dyn Emulator> {
        Box::new(serve::Endoscope::new(self, scene, body))
    }
}

/// Side of a square of the time code, px: a JPEG has half the resolution for colours.
pub const SQUARE_PX: usize = 16;
/// Size of the usual picture, px, and its radial distortion: a barrel, as most endoscopes have.
const SIZE_PX: [usize; 2] = [1280, 720];
const K1: f64 = -0.3;
/// Vertical opening angle without distortion, rad; distance from the middle of the field, m; angle above the horizon, rad: those of the
/// console's drawn view.
const FIELD_OF_VIEW: f64 = 0.92;
const DISTANCE_M: f64 = 0.128;
const PITCH: f64 = 0.72;
const MIDDLE_M: Vector3<f64> = Vector3::new(0.0, 0.0, 0.006);

/// The usual camera of a scene, as a rig file has it: between two instruments, or beside a single one.
pub fn usual(scene: &Scene) -> EndoscopeCamera {
    let yaw: f64 = if scene.left.is_some() || scene.wire.is_some() { 0.0 } else { -0.55 };
    let back_m = Vector3::new(yaw.sin() * PITCH.cos(), -yaw.cos() * PITCH.cos(), PITCH.sin()) * DISTANCE_M;
    EndoscopeCamera {
        size_px: SIZE_PX,
        focal_px: 0.5 * SIZE_PX[1] as f64 / (0.5 * FIELD_OF_VIEW).tan(),
        centre_px: None,
        k1: K1,
        position_m: MIDDLE_M + back_m,
        world_from_camera_deg: Vector3::new(-90.0 - PITCH.to_degrees(), 0.0, yaw.to_degrees()),
    }
}

/// The camera that a rig file describes.
pub fn camera_of(settings: &EndoscopeCamera) -> Camera {
    let EndoscopeCamera { size_px, focal_px, centre_px, k1, position_m, world_from_camera_deg } = *settings;
    let middle_px = Vector2::from(size_px.map(|side| 0.5 * side as f64));
    let lens = Lens { size_px, focal_px, centre_px: centre_px.map_or(middle_px, Vector2::from), k1 };
    let rotation: UnitQuaternion<f64> = from_roll_pitch_yaw_deg(&world_from_camera_deg);
    Camera { lens, world_from_camera: Isometry3::from_parts(position_m.into(), rotation) }
}
