//! Saddle points of an image, as at the corners of a board, where four squares meet.

use std::f64::consts::TAU;

use nalgebra::Vector2;

use crate::Grey;

/// A saddle must be the strongest within this many pixels.
const APART: usize = 4;
/// Minimum strength of a saddle relative to the strongest; uneven light causes a factor of 25, blur some more.
const WEAKEST: f32 = 0.002;
/// Maximum number of candidates examined, and of saddles kept. A texture has thousands of saddles, and the time for one
/// image must stay bounded.
const LOOKED_AT: usize = 3000;
const KEPT: usize = 900;
/// Number of samples on the ring around a candidate, and the radius of the ring, px.
const RING: usize = 32;
const RADIUS_PX: f64 = 5.0;
/// Minimum difference of light and dark on the ring, of 255. Above the noise of a dark endoscope image.
const CONTRAST: f64 = 14.0;
/// Minimum length of a quarter of the ring, samples; the four together are 32. At a corner all four quarters are
/// visible, even if the board is seen at an angle.
const QUARTER: usize = 3;

/// A point where light and dark meet crosswise.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Saddle {
    pub(crate) place_px: Vector2<f64>,
    /// Difference between light and dark around it.
    pub(crate) contrast: f64,
}

/// Returns all saddles of a smooth image, the strongest first.
pub(crate) fn saddles(smooth: &Grey) -> Vec<Saddle> {
    let [width, height] = smooth.size_px();
    if width < 4 * APART || height < 4 * APART {
        return Vec::new();
    }
    let strength = strengths(smooth);
    let min = WEAKEST * strength.iter().copied().fold(0.0, f32::max);
    let mut peaks = Vec::new();
    for y in APART..height - APART {
        for x in APART..width - APART {
            let here = strength[y * width + x];
            if here > min && here > 0.0 && is_peak(&strength, width, [x, y]) {
                peaks.push((here, [x, y]));
            }
        }
    }
    peaks.sort_by(|a, b| b.0.total_cmp(&a.0));
    let looked_at = peaks.into_iter().take(LOOKED_AT);
    let middle = |[x, y]: [usize; 2]| Vector2::new(x as f64 + 0.5, y as f64 + 0.5);
    looked_at.filter_map(|(_, at)| crosswise(smooth, &middle(at))).take(KEPT).collect()
}

/// Returns minus the determinant of the second derivatives: positive at a saddle.
fn strengths(smooth: &Grey) -> Vec<f32> {
    let [width, height] = smooth.size_px();
    let mut strength = vec![0.0; width * height];
    for y in 1..height - 1 {
        let above = smooth.row(y - 1);
        let here = smooth.row(y);
        let below = smooth.row(y + 1);
        let out = &mut strength[y * width..][..width];
        for x in 1..width - 1 {
            let xx = here[x - 1] + here[x + 1] - 2.0 * here[x];
            let yy = above[x] + below[x] - 2.0 * here[x];
            let xy = 0.25 * (above[x - 1] + below[x + 1] - above[x + 1] - below[x - 1]);
            out[x] = xy * xy - xx * yy;
        }
    }
    strength
}

fn is_peak(strength: &[f32], width: usize, [x, y]: [usize; 2]) -> bool {
    let here = (strength[y * width + x], y * width + x);
    (y - APART..=y + APART).all(|v| {
        // Among equal peaks, the first in reading order counts.
        (x - APART..=x + APART).all(|u| {
            let at = v * width + u;
            strength[at] < here.0 || (strength[at] <= here.0 && at >= here.1)
        })
    })
}

/// Checks whether light and dark alternate four times around a point, with opposite quarters alike.
fn crosswise(smooth: &Grey, place_px: &Vector2<f64>) -> Option<Saddle> {
    let ring: [f64; RING] = std::array::from_fn(|k| {
        let (sin, cos) = (TAU * k as f64 / RING as f64).sin_cos();
        smooth.at(&(place_px + Vector2::new(cos, sin) * RADIUS_PX))
    });
    let (min, max) = ring.iter().fold((f64::INFINITY, 0.0), |(min, max), v| (v.min(min), v.max(max)));
    let contrast = max - min;
    let middle = 0.5 * (max + min);
    if contrast < CONTRAST {
        return None;
    }
    let is_light = ring.map(|value| value > middle);
    let turns: Vec<usize> = (0..RING).filter(|k| is_light[*k] != is_light[(k + 1) % RING]).collect();
    let quarter = |k: usize| (turns[(k + 1) % 4] + RING - turns[k]) % RING;
    let four = turns.len() == 4 && (0..4).all(|k| quarter(k) >= QUARTER);
    let half = RING / 2;
    let alike: f64 = (0..half).map(|k| (ring[k] - middle) * (ring[k + half] - middle)).sum();
    let whole: f64 = ring.iter().map(|value| (value - middle).powi(2)).sum();
    (four && alike > 0.2 * whole).then_some(Saddle { place_px: *place_px, contrast })
}
