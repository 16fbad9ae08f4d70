//! Renders images of the scene: through one lens, or through two with their images side by side.

use std::time::Duration;

use nalgebra::Isometry3;
use nima_endoscope::{Camera, Checkerboard, time_code};
use nima_simulation::scene::Scene;

use super::{EmulatedEndoscope, EndoscopeInstrument, board::BoardDrawing, draw::Painter, push};
use crate::emulators::EmulatedFault;

/// The objects in front of the lens.
pub(super) enum ShotSubject {
    Scene(Box<Scene>),
    /// Scene for the calibration of one lens.
    Board(Checkerboard),
}

/// Their state at one time.
pub(super) enum ShotState {
    Instruments(Vec<EndoscopeInstrument>),
    /// The board's pose in front of the lens.
    Board(Isometry3<f64>),
}

/// The renderer of a subject.
enum ScenePainter {
    /// One painter for each lens, and the same for the pushed endoscope once it has been pushed.
    Scene {
        here: Vec<Painter>,
        moved: Option<Vec<Painter>>,
        scene: Box<Scene>,
    },
    Board(Box<BoardDrawing>),
}

pub(super) struct SceneRenderer {
    emulated: EmulatedEndoscope,
    easel: ScenePainter,
    rgb: Vec<u8>,
    size_px: [usize; 2],
}

/// An image with three bytes per pixel.
pub(super) struct Shot<'a> {
    pub(super) rgb: &'a [u8],
    pub(super) size_px: [usize; 2],
}

impl SceneRenderer {
    /// Takes some tenths of a second.
    pub(super) fn new(emulated: EmulatedEndoscope, subject: &ShotSubject) -> Self {
        let easel = match subject {
            ShotSubject::Scene(scene) => {
                let here = painters(emulated.camera, emulated.baseline_m, scene);
                ScenePainter::Scene { here, moved: None, scene: scene.clone() }
            }
            ShotSubject::Board(board) => {
                ScenePainter::Board(Box::new(BoardDrawing::new(*board, &emulated.camera.lens)))
            }
        };
        Self { emulated, easel, rgb: Vec::new(), size_px: [0; 2] }
    }

    /// Renders the view at this time (since 1970), black or at half the size if that is the fault; a frozen camera
    /// repeats the last image, if there is one.
    pub(super) fn take(&mut self, since: Duration, seen: &ShotState, fault: EmulatedFault) -> Shot<'_> {
        if fault == EmulatedFault::Freeze && !self.rgb.is_empty() {
            return Shot { rgb: &self.rgb, size_px: self.size_px };
        }
        self.draw(seen, fault == EmulatedFault::Moved);
        if self.emulated.square_px > 0 {
            time_code::draw(since.as_micros() as u64, self.emulated.square_px, &mut self.rgb, self.size_px[0]);
        }
        match fault {
            EmulatedFault::Black => self.rgb.fill(0),
            EmulatedFault::WrongSize => (self.rgb, self.size_px) = halved(&self.rgb, self.size_px),
            _ => {}
        }
        Shot { rgb: &self.rgb, size_px: self.size_px }
    }

    fn draw(&mut self, seen: &ShotState, is_moved: bool) {
        let EmulatedEndoscope { camera, baseline_m, .. } = self.emulated;
        let [width, height] = camera.lens.size_px;
        match (&mut self.easel, seen) {
            (ScenePainter::Scene { here, moved, scene }, ShotState::Instruments(instruments)) => {
                let there = || Camera { world_from_camera: push() * camera.world_from_camera, ..camera };
                let painters =
                    if is_moved { moved.get_or_insert_with(|| painters(there(), baseline_m, scene)) } else { here };
                self.size_px = [width * painters.len(), height];
                self.rgb.resize(3 * self.size_px[0] * height, 0);
                for (number, painter) in painters.iter_mut().enumerate() {
                    let rows = painter.draw(instruments).chunks_exact(3 * width);
                    for (whole, row) in self.rgb.chunks_exact_mut(3 * self.size_px[0]).zip(rows) {
                        whole[3 * width * number..][..3 * width].copy_from_slice(row);
                    }
                }
            }
            (ScenePainter::Board(drawn), ShotState::Board(camera_from_board)) => {
                self.size_px = [width, height];
                self.rgb.clear();
                self.rgb.extend_from_slice(drawn.draw(camera_from_board));
            }
            // The emulator always creates them in matching pairs.
            (ScenePainter::Scene { .. }, ShotState::Board(_)) | (ScenePainter::Board(_), ShotState::Instruments(_)) => {
            }
        }
    }
}

/// Creates one painter for each lens.
fn painters(camera: Camera, baseline_m: Option<f64>, scene: &Scene) -> Vec<Painter> {
    let second = baseline_m.map(|baseline_m| camera.beside(baseline_m));
    [Some(camera), second].into_iter().flatten().map(|camera| Painter::new(camera, scene)).collect()
}

/// Keeps every second pixel of every second row.
fn halved(rgb: &[u8], [width, height]: [usize; 2]) -> (Vec<u8>, [usize; 2]) {
    let half_px = [width / 2, height / 2];
    let rows = rgb.chunks_exact(3 * width).step_by(2).take(half_px[1]);
    let half = rows.flat_map(|row| row.chunks_exact(3).step_by(2).take(half_px[0]).flatten().copied()).collect();
    (half, half_px)
}
