//! Occlusion of a drawn force by the instrument.

use nalgebra::Vector3;

/// Half the width of an instrument's shaft, m: most shafts have 5 mm.
const SHAFT_M: f64 = 0.0025;
/// A point is hidden only if it is farther from the lens than the shaft's middle line; factor on the distance from the lens.
const BEHIND: f64 = 0.999;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct InstrumentShaft {
    pub(super) tip_m: Vector3<f64>,
    pub(super) trocar_m: Vector3<f64>,
}

impl InstrumentShaft {
    /// Returns whether it is between the lens and a point.
    pub(super) fn hides(&self, lens_m: &Vector3<f64>, point_m: &Vector3<f64>) -> bool {
        let [sight, shaft] = [point_m - lens_m, self.trocar_m - self.tip_m];
        let between = self.tip_m - lens_m;
        let a = sight.norm_squared();
        let b = sight.dot(&shaft);
        let c = shaft.norm_squared();
        let d = sight.dot(&between);
        let e = shaft.dot(&between);
        let min = a * c - b * b;
        if !(a > 0.0 && c > 0.0 && min > 1e-12 * a * c) {
            return false;
        }
        // Nearest point on the shaft's axis, clamped to the ends of the shaft; then the nearest point on the line of
        // sight to it.
        let along = ((b * d - a * e) / min).clamp(0.0, 1.0);
        let seen = (self.tip_m + shaft * along - lens_m).dot(&sight) / a;
        if !(0.0..BEHIND).contains(&seen) {
            return false;
        }
        (lens_m + sight * seen - self.tip_m - shaft * along).norm() < SHAFT_M
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Straight up from the tip, with the lens to the side.
    fn shaft() -> InstrumentShaft {
        InstrumentShaft { tip_m: Vector3::zeros(), trocar_m: Vector3::new(0.0, 0.0, 0.2) }
    }

    fn hides(x: f64, y: f64, z: f64) -> bool {
        shaft().hides(&Vector3::new(0.0, -0.1, 0.02), &Vector3::new(x, y, z))
    }

    #[test]
    fn what_is_behind_the_shaft_is_hidden_and_nothing_else() {
        assert!(hides(0.0, 0.02, 0.02) && hides(0.0, 0.005, 0.05) && hides(0.002, 0.01, 0.03));
        assert!(!hides(0.01, 0.02, 0.02), "beside it");
        assert!(!hides(0.0, -0.02, 0.02), "before it");
        assert!(!hides(0.0, 0.02, -0.02), "below its tip");
        assert!(!hides(0.0, 0.0, 0.0), "at its tip");
        let far = InstrumentShaft { trocar_m: Vector3::zeros(), ..shaft() };
        assert!(!far.hides(&Vector3::new(0.0, -0.1, 0.02), &Vector3::new(0.0, 0.02, 0.02)), "no length");
    }
}
