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
use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use nima_endoscope::{Board, Camera};
use nima_simulation::{
    camera::{camera_of, usual},
    scene::Scene,
};

use self::shot::{Seen, Subject};
use super::Emulator;

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
/// How a push moves the endoscope in the workspace ([`EmulatedFault::Moved`](super::EmulatedFault)): it turns in its own trocar, which gives way.
pub fn push() -> Isometry3<f64> {
    let trocar_m = Vector3::new(0.0, -0.15, 0.14);
    let turn = UnitQuaternion::from_euler_angles(0.03, -0.02, 0.06);
    Isometry3::from_parts((trocar_m + Vector3::new(0.006, 0.004, -0.002)).into(), turn)
        * Isometry3::from_parts((-trocar_m).into(), UnitQuaternion::identity())
}
