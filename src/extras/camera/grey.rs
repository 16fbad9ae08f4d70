//! A grey image.

use nalgebra::Vector2;
use nima_endoscope::DecodedImage;

/// Weights of red, green and blue in brightness (BT.601).
const FRACTIONS: [f32; 3] = [0.299, 0.587, 0.114];

/// Brightness of each pixel, 0 to 255, row by row from the upper left corner. The centre of a pixel is half a pixel
/// from its edges.
#[derive(Clone, Debug, PartialEq)]
pub struct Grey {
    size_px: [usize; 2],
    values: Vec<f32>,
}

impl Grey {
    /// `None` if the numbers of values and pixels differ.
    pub fn new(size_px: [usize; 2], values: Vec<f32>) -> Option<Self> {
        let is_whole = values.len() == size_px[0] * size_px[1] && !values.is_empty();
        is_whole.then_some(Self { size_px, values })
    }

    /// Returns the brightness of an image.
    pub fn of(image: &DecodedImage) -> Option<Self> {
        let grey =
            |pixel: &[u8]| pixel.iter().zip(FRACTIONS).map(|(value, fraction)| f32::from(*value) * fraction).sum();
        Self::new(image.size_px, image.rgba.chunks_exact(4).map(|pixel| grey(&pixel[..3])).collect())
    }

    /// Returns the width and height, px.
    pub const fn size_px(&self) -> [usize; 2] {
        self.size_px
    }

    pub fn values(&self) -> &[f32] {
        &self.values
    }

    pub(crate) fn row(&self, y: usize) -> &[f32] {
        &self.values[y * self.size_px[0]..][..self.size_px[0]]
    }

    /// Returns the brightness at a position (px), interpolated between pixels.
    pub(crate) fn at(&self, place_px: &Vector2<f64>) -> f64 {
        let [width, height] = self.size_px;
        let within = |at: f64, side: usize| (at - 0.5).clamp(0.0, (side - 1) as f64);
        let x = within(place_px.x, width);
        let y = within(place_px.y, height);
        let [left, top] = [x as usize, y as usize];
        let [right, bottom] = [(left + 1).min(width - 1), (top + 1).min(height - 1)];
        let [u, v] = [x - left as f64, y - top as f64];
        let value = |x: usize, y: usize| f64::from(self.values[y * width + x]);
        let upper = value(left, top) * (1.0 - u) + value(right, top) * u;
        let lower = value(left, bottom) * (1.0 - u) + value(right, bottom) * u;
        upper * (1.0 - v) + lower * v
    }

    /// Smooths by a Gaussian with this standard deviation, px.
    pub(crate) fn smooth(&self, sigma_px: f32) -> Self {
        let [width, height] = self.size_px;
        let reach = (3.0 * sigma_px).ceil() as usize;
        let weight = |k: usize| (-0.5 * (k as f32 / sigma_px).powi(2)).exp();
        let sum: f32 = weight(0) + 2.0 * (1..=reach).map(weight).sum::<f32>();
        let kernel: Vec<f32> = (0..=reach).map(|k| weight(k) / sum).collect();
        let mut across = Vec::with_capacity(self.values.len());
        let mut padded = vec![0.0; width + 2 * reach];
        for y in 0..height {
            let row = self.row(y);
            padded[..reach].fill(row[0]);
            padded[reach..reach + width].copy_from_slice(row);
            padded[reach + width..].fill(row[width - 1]);
            across.extend((0..width).map(|x| {
                let pairs = (1..=reach).map(|k| kernel[k] * (padded[x + reach - k] + padded[x + reach + k]));
                kernel[0] * padded[x + reach] + pairs.sum::<f32>()
            }));
        }
        let mut values = vec![0.0; self.values.len()];
        for (y, out) in values.chunks_exact_mut(width).enumerate() {
            for step in 0..=2 * reach {
                let from = (y + step).saturating_sub(reach).min(height - 1);
                let fraction = kernel[step.abs_diff(reach)];
                for (to, value) in out.iter_mut().zip(&across[from * width..][..width]) {
                    *to += fraction * value;
                }
            }
        }
        Self { size_px: self.size_px, values }
    }

    /// Returns the image at half its width and height: the mean of four pixels each; `None` if nothing would remain.
    pub(crate) fn halved(&self) -> Option<Self> {
        let [width, height] = self.size_px.map(|side| side / 2);
        let mut values = Vec::with_capacity(width * height);
        for y in 0..height {
            let upper = self.row(2 * y);
            let lower = self.row(2 * y + 1);
            let pairs = upper.chunks_exact(2).zip(lower.chunks_exact(2)).take(width);
            values.extend(pairs.map(|(above, below)| 0.25 * (above[0] + above[1] + below[0] + below[1])));
        }
        Self::new([width, height], values)
    }
}
