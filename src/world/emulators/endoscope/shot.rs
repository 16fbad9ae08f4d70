//! Takes pictures of the scene: through one lens, or through two whose pictures lie side by side.

use std::time::{Duration, SystemTime, UNIX_EPOCH};

use nima_endoscope::{Board, time_code};

use super::{
    Body, Emulated,
    board::{Drawn, Hands},
    draw::Painter,
};
use crate::{emulators::EmulatedFault, scene::Scene};

pub(super) struct Studio {
    emulated: Emulated,
    shown: Shown,
    rgb: Vec<u8>,
    size_px: [usize; 2],
}

/// What is before the lens; how it is drawn is made when the first picture is wanted.
pub(super) enum Shown {
    /// A scene with its instruments, drawn for each lens.
    Scene(Box<Scene>, Body, Vec<Painter>),
    /// A board for the calibration of one lens.
    Board(Board, Hands, Option<Drawn>),
}

impl Shown {
    /// The picture at a time, and its size.
    fn draw(&mut self, emulated: &Emulated, now_s: f64, rgb: &mut Vec<u8>) -> [usize; 2] {
        let camera = emulated.camera;
        let [width, height] = camera.lens.size_px;
        match self {
            Self::Scene(scene, body, painters) => {
                let instruments = body(now_s);
                if painters.is_empty() {
                    let second = emulated.baseline_m.map(|baseline_m| camera.beside(baseline_m));
                    let lenses = [Some(camera), second].into_iter().flatten();
                    *painters = lenses.map(|camera| Painter::new(camera, scene)).collect();
                }
                let size_px = [width * painters.len(), height];
                rgb.resize(3 * size_px[0] * height, 0);
                for (number, painter) in painters.iter_mut().enumerate() {
                    let rows = painter.draw(&instruments).chunks_exact(3 * width);
                    for (whole, row) in rgb.chunks_exact_mut(3 * size_px[0]).zip(rows) {
                        whole[3 * width * number..][..3 * width].copy_from_slice(row);
                    }
                }
                size_px
            }
            Self::Board(board, hands, drawn) => {
                let camera_from_board = hands(now_s);
                let drawn = drawn.get_or_insert_with(|| Drawn::new(*board, &camera.lens));
                rgb.clear();
                rgb.extend_from_slice(drawn.draw(&camera_from_board));
                [width, height]
            }
        }
    }
}

/// A picture of three bytes a pixel.
pub(super) struct Shot<'a> {
    pub(super) rgb: &'a [u8],
    pub(super) size_px: [usize; 2],
    /// When it was taken, since 1970.
    pub(super) since: Duration,
}

impl Studio {
    pub(super) fn new(emulated: Emulated, shown: Shown) -> Self {
        Self { emulated, shown, rgb: Vec::new(), size_px: [0; 2] }
    }

    /// The last picture again, as a camera that hangs sends it; the picture of this time if there was none.
    pub(super) fn again(&mut self, now_s: f64) -> Shot<'_> {
        if self.rgb.is_empty() {
            return self.take(now_s, EmulatedFault::None);
        }
        let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        Shot { rgb: &self.rgb, size_px: self.size_px, since }
    }

    /// The picture of this time, black or half as large where that is the fault.
    pub(super) fn take(&mut self, now_s: f64, fault: EmulatedFault) -> Shot<'_> {
        // Before it is looked: whoever reads this time knows that nothing in the picture is older.
        let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        let size_px = self.shown.draw(&self.emulated, now_s, &mut self.rgb);
        if self.emulated.square_px > 0 {
            time_code::draw(since.as_micros() as u64, self.emulated.square_px, &mut self.rgb, size_px[0]);
        }
        self.size_px = size_px;
        match fault {
            EmulatedFault::Black => self.rgb.fill(0),
            EmulatedFault::WrongSize => (self.rgb, self.size_px) = halved(&self.rgb, size_px),
            _ => {}
        }
        Shot { rgb: &self.rgb, size_px: self.size_px, since }
    }
}

/// Every second pixel of every second row.
fn halved(rgb: &[u8], [width, height]: [usize; 2]) -> (Vec<u8>, [usize; 2]) {
    let half_px = [width / 2, height / 2];
    let rows = rgb.chunks_exact(3 * width).step_by(2).take(half_px[1]);
    let half = rows.flat_map(|row| row.chunks_exact(3).step_by(2).take(half_px[0]).flatten().copied()).collect();
    (half, half_px)
}
