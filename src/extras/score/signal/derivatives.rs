//! Derivatives of a segment of a track.

use nalgebra::Vector3;

use super::STEP_S;

#[derive(Clone, Copy, Debug)]
pub(crate) enum DerivativeOrder {
    First,
    Second,
    Third,
}

/// Returns the magnitude of the derivative at each point. Central differences over five points (errors of the fourth
/// order in the step; the third derivative: second order). Beyond the ends the segment is continued by point
/// reflection, as in the filter.
pub(crate) fn magnitudes(points: &[Vector3<f64>], order: DerivativeOrder) -> Vec<f64> {
    let (weights, per_step): ([f64; 5], f64) = match order {
        DerivativeOrder::First => ([1.0, -8.0, 0.0, 8.0, -1.0], 12.0 * STEP_S),
        DerivativeOrder::Second => ([-1.0, 16.0, -30.0, 16.0, -1.0], 12.0 * STEP_S * STEP_S),
        DerivativeOrder::Third => ([-1.0, 2.0, 0.0, -2.0, 1.0], 2.0 * STEP_S * STEP_S * STEP_S),
    };
    let at = |place: isize| continued(points, place).unwrap_or_default();
    let one = |middle: usize| {
        let around = |(k, weight): (usize, &f64)| at((middle + k).cast_signed() - 2) * *weight;
        weights.iter().enumerate().map(around).sum::<Vector3<f64>>().norm() / per_step
    };
    (0..points.len()).map(one).collect()
}

fn continued(points: &[Vector3<f64>], place: isize) -> Option<Vector3<f64>> {
    let end = points.len().cast_signed() - 1;
    let at = |place: isize| points.get(place.clamp(0, end.max(0)) as usize).copied();
    Some(match place {
        _ if place < 0 => at(0)? * 2.0 - at(-place)?,
        _ if place > end => at(end)? * 2.0 - at(2 * end - place)?,
        _ => at(place)?,
    })
}

/// Returns the mean over time (trapezoid) of evenly spaced segments; `None` if they have no duration.
pub(crate) fn mean<'a>(stretches: impl Iterator<Item = &'a [f64]>) -> Option<f64> {
    let mut sum = 0.0;
    let mut steps = 0.0;
    for values in stretches.filter(|values| values.len() > 1) {
        sum += values.windows(2).map(|two| f64::midpoint(two[0], two[1])).sum::<f64>();
        steps += (values.len() - 1) as f64;
    }
    (steps > 0.0).then(|| sum / steps)
}

/// Returns the maximum; `None` without a value.
pub(crate) fn peak<'a>(stretches: impl Iterator<Item = &'a [f64]>) -> Option<f64> {
    stretches.flatten().copied().reduce(f64::max)
}
