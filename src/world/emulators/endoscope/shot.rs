//! Takes pictures of the scene: through one lens, or through two whose pictures lie side by side.

use std::time::{Duration, SystemTime, UNIX_EPOCH};

use nima_endoscope::time_code;

use super::{Body, Emulated, draw::Painter};
use crate::{emulators::EmulatedFault, scene::Scene};

pub(super) struct Studio {
    emulated: Emulated,
    scene: Scene,
    body: Body,
    /// One for each lens, made when the first picture is wanted.
    painters: Vec<Painter>,
    rgb: Vec<u8>,
    size_px: [usize; 2],
}

/// A picture of three bytes a pixel.
pub(super) struct Shot<'a> {
    pub(super) rgb: &'a [u8],
    pub(super) size_px: [usize; 2],
    /// When it was taken, since 1970.
    pub(super) since: Duration,
}

impl Studio {
    pub(super) fn new(emulated: Emulated, scene: &Scene, body: Body) -> Self {
        Self { emulated, scene: scene.clone(), body, painters: Vec::new(), rgb: Vec::new(), size_px: [0; 2] }
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
        let instruments = (self.body)(now_s);
        if self.painters.is_empty() {
            let camera = self.emulated.camera;
            let second = self.emulated.baseline_m.map(|baseline_m| camera.beside(baseline_m));
            let lenses = [Some(camera), second].into_iter().flatten();
            self.painters = lenses.map(|camera| Painter::new(camera, &self.scene)).collect();
        }
        let [width, height] = self.emulated.camera.lens.size_px;
        let size_px = [width * self.painters.len(), height];
        self.rgb.resize(3 * size_px[0] * height, 0);
        for (number, painter) in self.painters.iter_mut().enumerate() {
            let rows = painter.draw(&instruments).chunks_exact(3 * width);
            for (whole, row) in self.rgb.chunks_exact_mut(3 * size_px[0]).zip(rows) {
                whole[3 * width * number..][..3 * width].copy_from_slice(row);
            }
        }
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
