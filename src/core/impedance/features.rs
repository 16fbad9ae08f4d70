//! Motion features and their fixed physical scales.

use serde::{Deserialize, Serialize};

use super::MAX_DEGREE;
use crate::signal::{Lanes, Motion};

/// Number of motion columns of the highest degree: `3 N` = 15.
pub const MOTION_COLUMNS: usize = 3 * MAX_DEGREE;

/// `u, u', u'', u^2, u'^2, u''^2, ...`: 15 entries, ordered by degree, so that a lower degree is a prefix of a higher one.
pub type ImpedanceFeatures = [Lanes; MOTION_COLUMNS];

/// Typical magnitudes of motion and force; columns are divided by them before they are raised to a power.
///
/// They are fixed, not measured from the data: a row never changes once it is computed, and the result does not depend
/// on the unit of length as long as the scales are given in the same unit. The defaults are the laparoscopic workspace
/// (± 0.1 m about the trocar), a brisk instrument (0.2 m/s), the acceleration of a hand's tremor and quick stops (4
/// m/s², i.e. that speed reversed at 3 Hz), and the default force ceiling (4 N).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scales {
    pub position_m: f64,
    pub velocity_m_s: f64,
    /// Unit of acceleration in a row.
    pub acceleration_m_s2: f64,
    /// Unit of force (N): the limit for implausible forces is a multiple of it; it does not affect the fit.
    pub force_n: f64,
}

impl Default for Scales {
    fn default() -> Self {
        Self { position_m: 0.1, velocity_m_s: 0.2, acceleration_m_s2: 4.0, force_n: 4.0 }
    }
}

/// A scaled quantity below this is rounding noise; it is set to zero so that its powers never become subnormal (and
/// slow).
const FLUSH: f64 = 1e-20;

impl Scales {
    /// Returns the features of `motion` up to `degree`, each divided by its scale; columns beyond the degree are zero.
    #[inline]
    pub fn features(&self, motion: &Motion, degree: usize) -> ImpedanceFeatures {
        let scaled = Motion {
            x: motion.x * self.position_m.recip(),
            v: motion.v * self.velocity_m_s.recip(),
            // Multiplied by a reciprocal: one division per scale instead of one per axis.
            a: motion.a * self.acceleration_m_s2.recip(),
        };
        features(&scaled, degree)
    }
}

/// Returns the powers 1 to `degree` of a motion: `u, u', u'', u^2, u'^2, u''^2, ...`; columns beyond the degree are
/// zero.
#[inline]
pub(super) fn features(motion: &Motion, degree: usize) -> ImpedanceFeatures {
    let mut columns = [Lanes::ZERO; MOTION_COLUMNS];
    let base = [motion.x, motion.v, motion.a].map(|u| u.map(|u| if u.abs() < FLUSH { 0.0 } else { u }));
    let mut power = base;
    // The power of each triple is built from the one before: no call of `powi` in a tick.
    for triple in columns.chunks_exact_mut(3).take(degree) {
        triple.copy_from_slice(&power);
        for (power, base) in power.iter_mut().zip(base) {
            *power *= base;
        }
    }
    columns
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_are_ordered_by_degree() {
        let motion = Motion { x: Lanes::splat(2.0), v: Lanes::splat(3.0), a: Lanes::splat(-1.0) };
        let found = features(&motion, 3).map(|column| column[0]);
        assert_eq!(found[..9], [2.0, 3.0, -1.0, 4.0, 9.0, 1.0, 8.0, 27.0, -1.0]);
        assert_eq!(found[9..], [0.0; 6]);
    }

    #[test]
    fn scales_divide_before_the_power() {
        let scales = Scales::default();
        let motion = Motion { x: Lanes::splat(0.2), v: Lanes::splat(0.1), a: Lanes::splat(4.0) };
        let found = scales.features(&motion, 2).map(|column| column[1]);
        for (found, expected) in found.iter().zip([2.0, 0.5, 1.0, 4.0, 0.25, 1.0]) {
            assert!((found - expected).abs() < 1e-15, "{found} is not {expected}");
        }
    }
}
