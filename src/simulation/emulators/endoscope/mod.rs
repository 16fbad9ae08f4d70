//! An emulated endoscope: renders the simulated scene through a lens that bends the picture, and serves it on loopback: as motion JPEG over HTTP
//! and, in a program with the feature `h264`, as H.264 over RTSP at the same port; and into a named pipe.
//!
//! What is seen comes from its [`Body`], a closure of the emulator's time; or it sees a board for the calibration, in somebody's [`Hands`]. A code in the upper left corner of the picture tells when it was
//! rendered. Pictures are made only while somebody watches. Faults that concern the meaning are its own (`freeze`, `black`, `torn`, `late`,
//! `wrong-size`, `other-format`); a client that does not take its pictures is cut off.

pub(super) mod alone;
mod board;
mod draw;
mod pipe;
mod rtsp;
mod serve;
mod shot;
#[cfg(test)]
mod tests;
mod workshop;

use std::path::PathBuf;

pub use board::{Hands, held};
use nalgebra::{Isometry3, UnitQuaternion, Vector2, Vector3};
use nima_core::frames::from_roll_pitch_yaw_deg;
use nima_endoscope::{Bend, Board, Camera, Lens};
use nima_machine::config::EndoscopeCamera;

use self::shot::{Seen, Subject};
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
#[derive(Clone, Debug, PartialEq)]
pub struct Emulated {
    /// TCP port; 0 takes a free one.
    pub port: u16,
    /// Pictures a second.
    pub rate_hz: f64,
    /// Its lens and its place; of two lenses the left one.
    pub camera: Camera,
    /// How far a second lens is to the right of the first, m: their pictures lie side by side. `None` for one lens.
    pub baseline_m: Option<f64>,
    /// Side of a square of the time code, px; 0 draws none.
    pub square_px: usize,
    /// Quality of the JPEGs, 1 to 100.
    pub quality: u8,
    /// Where pictures are also written, one after the other: H.264 if it ends so, else JPEGs.
    pub pipe: Option<PathBuf>,
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
            baseline_m: None,
            square_px: SQUARE_PX,
            quality: 80,
            pipe: None,
            gives_way: false,
        }
    }

    /// With what it sees.
    pub fn with(self, scene: &Scene, mut body: Body) -> Box<dyn Emulator> {
        let seen = Box::new(move |now_s: f64| Seen::Instruments(body(now_s)));
        Box::new(serve::Endoscope::new(self, Subject::Scene(Box::new(scene.clone())), seen))
    }

    /// With a board for the calibration before its one lens, and without a time code, which would cover it.
    pub fn with_board(self, board: Board, mut hands: Hands) -> Box<dyn Emulator> {
        let seen = Box::new(move |now_s: f64| Seen::Board(hands(now_s)));
        let emulated = Self { square_px: 0, baseline_m: None, ..self };
        Box::new(serve::Endoscope::new(emulated, Subject::Board(board), seen))
    }
}

/// Side of a square of the time code, px: a JPEG has half the resolution for colours.
pub const SQUARE_PX: usize = 16;
/// Distance of the lenses of the usual endoscope with two of them, m.
pub const BASELINE_M: f64 = 0.004;
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

/// How a push moves the endoscope in the workspace ([`EmulatedFault::Moved`](super::EmulatedFault)): it turns in its own trocar, which gives way.
pub fn push() -> Isometry3<f64> {
    let trocar_m = Vector3::new(0.0, -0.15, 0.14);
    let turn = UnitQuaternion::from_euler_angles(0.03, -0.02, 0.06);
    Isometry3::from_parts((trocar_m + Vector3::new(0.006, 0.004, -0.002)).into(), turn)
        * Isometry3::from_parts((-trocar_m).into(), UnitQuaternion::identity())
}

/// The lens that a rig file describes.
pub fn lens_of(settings: &EndoscopeCamera) -> Lens {
    let EndoscopeCamera { size_px, focal_px, focal_y_px, centre_px, k1, k2, p1, p2, .. } = *settings;
    let middle_px = Vector2::from(size_px.map(|side| 0.5 * side as f64));
    let focal_px = Vector2::new(focal_px, focal_y_px.unwrap_or(focal_px));
    Lens { size_px, focal_px, centre_px: centre_px.map_or(middle_px, Vector2::from), bend: Bend { k1, k2, p1, p2 } }
}

/// The camera that a rig file describes; at the workspace's origin where its place is not known.
pub fn camera_of(settings: &EndoscopeCamera) -> Camera {
    let rotation: UnitQuaternion<f64> = from_roll_pitch_yaw_deg(&settings.world_from_camera_deg.unwrap_or_default());
    let place_m = settings.position_m.unwrap_or_default();
    Camera { lens: lens_of(settings), world_from_camera: Isometry3::from_parts(place_m.into(), rotation) }
}
