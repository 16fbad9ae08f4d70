//! Locates corners to a fraction of a pixel, and measures the sharpness of the edges between them.

use nalgebra::{Matrix2, Vector2};

use crate::Grey;

/// Half the side length of the window around a corner, relative to the distance to the next corner, and its limits, px.
/// Less than half, so that the window does not reach the next corner.
const WINDOW: f64 = 0.35;
const WINDOW_PX: std::ops::RangeInclusive<f64> = 3.0..=11.0;
const STEPS: usize = 30;
/// The iteration ends at a smaller step, px. Far below the noise of a corner (some hundredths of a pixel).
const STILL_PX: f64 = 1e-3;
/// Positions along an edge over which its profile is averaged, in lengths.
const ALONG: [f64; 5] = [0.3, 0.4, 0.5, 0.6, 0.7];
/// Extent of a profile, in lengths of the edge; its step, px.
const REACH: f64 = 0.3;
const STEP_PX: f64 = 0.5;

/// Returns the point where all edges of a corner meet: each gradient around it is perpendicular to the direction to
/// that point (Foerstner 1987). `spacing_px` is the distance to the next corner. `None` if there is none near
/// `start_px`.
pub(crate) fn corner(smooth: &Grey, start_px: Vector2<f64>, spacing_px: f64) -> Option<Vector2<f64>> {
    let reach_px = (WINDOW * spacing_px).clamp(*WINDOW_PX.start(), *WINDOW_PX.end());
    let mut place_px = start_px;
    for _ in 0..STEPS {
        let next_px = towards(smooth, &place_px, reach_px)?;
        let moved_px = (next_px - place_px).norm();
        place_px = next_px;
        let is_near = (place_px - start_px).norm() < reach_px;
        if !is_near {
            return None;
        }
        if moved_px < STILL_PX {
            break;
        }
    }
    Some(place_px)
}

fn towards(smooth: &Grey, place_px: &Vector2<f64>, reach_px: f64) -> Option<Vector2<f64>> {
    let [width, height] = smooth.size_px().map(|side| side as f64);
    let inside = |at: f64, side: f64| at - reach_px >= 1.5 && at + reach_px <= side - 1.5;
    if !(inside(place_px.x, width) && inside(place_px.y, height)) {
        return None;
    }
    let mut matrix = Matrix2::zeros();
    let mut vector = Vector2::zeros();
    let range = |at: f64| (at - 0.5 - reach_px).ceil() as usize..=(at - 0.5 + reach_px).floor() as usize;
    for y in range(place_px.y) {
        let above = smooth.row(y - 1);
        let here = smooth.row(y);
        let below = smooth.row(y + 1);
        for x in range(place_px.x) {
            let at_px = Vector2::new(x as f64 + 0.5, y as f64 + 0.5) - place_px;
            let gradient = Vector2::new(f64::from(here[x + 1] - here[x - 1]), f64::from(below[x] - above[x]));
            // The weight falls to an eighth at the window's edge.
            let weight = (-2.0 * at_px.norm_squared() / (reach_px * reach_px)).exp();
            let part = gradient * gradient.transpose() * weight;
            matrix += part;
            vector += part * at_px;
        }
    }
    let step = matrix.try_inverse()? * vector;
    step.iter().all(|part| part.is_finite()).then(|| place_px + step)
}

/// Returns the standard deviation of the blur across the edge between two corners, px: difference of light and dark
/// over the steepest slope.
pub(crate) fn blur_px(image: &Grey, [from, to]: [&Vector2<f64>; 2]) -> Option<f64> {
    let way = to - from;
    let length = way.norm();
    let across = Vector2::new(-way.y, way.x) / length;
    let steps = (REACH * length / STEP_PX) as i32;
    let value = |step: i32| {
        let beside = across * (f64::from(step) * STEP_PX);
        ALONG.iter().map(|along| image.at(&(from + way * *along + beside))).sum::<f64>() / ALONG.len() as f64
    };
    let profile: Vec<f64> = (-steps..=steps).map(value).collect();
    let [first, last] = [*profile.first()?, *profile.last()?];
    let slopes = profile.windows(3).map(|three| (three[2] - three[0]).abs() / (2.0 * STEP_PX));
    let steepest = slopes.fold(0.0, f64::max);
    (steepest > 0.0).then(|| (last - first).abs() / (steepest * std::f64::consts::TAU.sqrt()))
}
