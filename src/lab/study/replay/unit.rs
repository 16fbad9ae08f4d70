//! Unit and origin of a recording's positions.

use nalgebra::Vector3;

use super::ReplayMotion;

/// Plausible extent of a motion (m). Outside of it, the positions are in another unit than metres or radians.
const EXTENT_M: [f64; 2] = [1e-5, 10.0];
/// Positions beyond this (m) are counted from the first one, because the digits of the motion would be lost in their squares.
const FAR_M: f64 = 10.0;

/// Brings positions into the range that the identification accepts. The rendered force does not depend on unit and
/// origin.
#[derive(Clone, Copy, Debug)]
pub(super) struct PositionUnit {
    pub(super) scale: f64,
    origin: Vector3<f64>,
}

impl PositionUnit {
    pub(super) fn of(motion: &ReplayMotion<'_>) -> Self {
        let position = |i: usize| (motion.sample)(i).position_m;
        let mut low = Vector3::repeat(f64::INFINITY);
        let mut high = -low;
        for i in 0..motion.samples {
            low = low.inf(&position(i));
            high = high.sup(&position(i));
        }
        let extent = (high - low).amax();
        let mut scale = 1.0;
        let [min_m, max_m] = EXTENT_M;
        if extent > 0.0 && extent.is_finite() {
            while extent * scale > max_m {
                scale *= 1e-3;
            }
            while extent * scale < min_m {
                scale *= 1e3;
            }
        }
        let far = low.amax().max(high.amax()) * scale > FAR_M;
        Self { scale, origin: if far { position(0) } else { Vector3::zeros() } }
    }

    pub(super) fn metres(&self, position: &Vector3<f64>) -> Vector3<f64> {
        (position - self.origin) * self.scale
    }
}
