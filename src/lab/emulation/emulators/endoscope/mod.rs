//! An emulated endoscope: renders the simulated scene through a distorting lens and serves it on loopback: as motion
//! JPEG over HTTP and, in a program with the feature `h264`, as H.264 over RTSP at the same port; and into a named
//! pipe.
//!
//! The scene comes from an [`EndoscopeBody`], a closure of the emulator's time; or the camera sees a calibration board
//! in a person's [`BoardHands`]. A code in the upper left corner of the image contains the time of rendering. Images
//! are rendered only while a client is connected. Faults of the content are its own (`freeze`, `black`, `torn`, `late`,
//! `wrong-size`, `other-format`); a client that does not read its images is disconnected.

mod board;
mod draw;
mod pipe;
mod render;
mod render_thread;
mod rtsp;
mod serve;
pub(super) mod standalone;
#[cfg(test)]
mod tests;

use std::path::PathBuf;

pub use board::{BoardHands, held};
use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use nima_endoscope::{Camera, Checkerboard};
use nima_simulation::{
    camera::{camera_of, usual},
    scene::Scene,
};

use self::render::{ShotState, ShotSubject};
use super::Emulator;

/// One instrument in the workspace, as seen by an endoscope.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EndoscopeInstrument {
    pub tip_m: Vector3<f64>,
    pub trocar_m: Vector3<f64>,
}

/// Function that returns the instruments at a time, s since the emulator began.
pub type EndoscopeBody = Box<dyn FnMut(f64) -> Vec<EndoscopeInstrument> + Send>;

/// Properties of an emulated endoscope.
#[derive(Clone, Debug, PartialEq)]
pub struct EmulatedEndoscope {
    /// TCP port; 0 selects a free one.
    pub port: u16,
    /// Frames per second.
    pub rate_hz: f64,
    /// Lens and its pose; for a stereo endoscope the left lens.
    pub camera: Camera,
    /// Distance of a second lens to the right of the first, m; the two images are side by side. `None` for one lens.
    pub baseline_m: Option<f64>,
    /// Side of a square of the time code, px; 0 draws none.
    pub square_px: usize,
    /// JPEG quality, 1 to 100.
    pub quality: u8,
    /// File that also gets the images, one after the other: H.264 if it has that ending, otherwise JPEGs.
    pub pipe: Option<PathBuf>,
    /// Render at a low thread priority: next to emulators that serve a loop.
    pub gives_way: bool,
}

impl EmulatedEndoscope {
    /// Creates the default endoscope of a scene, on this port.
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

    /// Makes the emulator with a source of instruments.
    pub fn with(self, scene: &Scene, mut body: EndoscopeBody) -> Box<dyn Emulator> {
        let seen = Box::new(move |now_s: f64| ShotState::Instruments(body(now_s)));
        Box::new(serve::EndoscopeServer::new(self, ShotSubject::Scene(Box::new(scene.clone())), seen))
    }

    /// Creates the emulator with a calibration board in front of its single lens, and without a time code, which would
    /// cover the board.
    pub fn with_board(self, board: Checkerboard, mut hands: BoardHands) -> Box<dyn Emulator> {
        let seen = Box::new(move |now_s: f64| ShotState::Board(hands(now_s)));
        let emulated = Self { square_px: 0, baseline_m: None, ..self };
        Box::new(serve::EndoscopeServer::new(emulated, ShotSubject::Board(board), seen))
    }
}

/// Side of a square of the time code, px: large, because a JPEG has half the resolution for colours.
pub const SQUARE_PX: usize = 16;
/// Distance of the lenses of the default stereo endoscope, m.
pub const BASELINE_M: f64 = 0.004;
/// Returns the motion of the endoscope in the workspace by a push ([`EmulatedFault::Moved`](super::EmulatedFault)): it
/// rotates in its own trocar, which yields.
pub fn push() -> Isometry3<f64> {
    let trocar_m = Vector3::new(0.0, -0.15, 0.14);
    let turn = UnitQuaternion::from_euler_angles(0.03, -0.02, 0.06);
    Isometry3::from_parts((trocar_m + Vector3::new(0.006, 0.004, -0.002)).into(), turn)
        * Isometry3::from_parts((-trocar_m).into(), UnitQuaternion::identity())
}
