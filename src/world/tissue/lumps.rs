//! Stiff lumps in soft tissue.

use nalgebra::Vector3;

use crate::scene::{Lump, Lumps};

/// How many times stiffer the tissue is under a tip at this place than without lumps.
///
/// The tissue is an elastic foundation (Johnson, Contact Mechanics, 1985, section 4.3): independent columns of height `h`, whose stiffness is
/// `E / h`. A lump of `r` times their modulus fills the chord `t` of its sphere above the place; the column is then as one of the
/// height `h - t (1 - 1/r)`.
pub(super) fn factor(lumps: &Lumps, tip_m: &Vector3<f64>) -> f64 {
    let filled_m: f64 = lumps.list.iter().map(|lump| lump.times_softer(tip_m)).sum();
    // Lumps on top of each other leave a column of a twentieth.
    lumps.thickness_m / (lumps.thickness_m - filled_m).max(0.05 * lumps.thickness_m)
}

impl Lump {
    /// Height that the lump takes from the column at this place, m.
    fn times_softer(&self, tip_m: &Vector3<f64>) -> f64 {
        let [x_m, y_m] = self.at_m;
        let aside = (tip_m.x - x_m).hypot(tip_m.y - y_m);
        let chord_m = 2.0 * (self.radius_m * self.radius_m - aside * aside).max(0.0).sqrt();
        chord_m * (1.0 - 1.0 / self.times_stiffer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lumps() -> Lumps {
        let lump = Lump { at_m: [0.01, -0.02], radius_m: 0.006, times_stiffer: 10.0 };
        Lumps { thickness_m: 0.03, list: vec![lump] }
    }

    #[test]
    fn over_the_middle_the_column_is_shorter_by_the_lump() {
        let factor = factor(&lumps(), &Vector3::new(0.01, -0.02, 0.0));
        // 30 mm of which 12 mm are ten times as stiff.
        assert!((factor - 30.0 / (18.0 + 1.2)).abs() < 1e-12, "{factor}");
    }

    #[test]
    fn beside_it_there_is_nothing_and_in_between_it_rises_without_a_step() {
        let at = |x_m: f64| factor(&lumps(), &Vector3::new(0.01 + x_m, -0.02, 0.0));
        assert_eq!((at(0.006), at(-0.02)), (1.0, 1.0));
        let mut before = at(0.0);
        for i in 1..=600 {
            let here = at(f64::from(i) * 1e-5);
            assert!(here <= before && before - here < 0.05, "{i}");
            before = here;
        }
    }
}
