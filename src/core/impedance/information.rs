//! Measures how much information about the impedance the motion in a window contains.

use super::{factor::ImpedanceFactor, messages::ImpedanceExcitation, settings::ImpedanceSettings};
use crate::signal::Lanes;

/// Returns the number of motion columns whose part orthogonal to the preceding columns exceeds the ridge (and
/// rounding), on the axis with the fewest.
pub(super) fn rank(factor: &ImpedanceFactor, ridge: f64, axes: usize) -> u8 {
    let mut ranks = [0_u8; 4];
    for j in 1..factor.columns() {
        let column = factor.column(j);
        let total = column.iter().fold(Lanes::ZERO, |sum, r| sum + *r * *r);
        for (lane, rank) in ranks.iter_mut().enumerate().take(axes) {
            let own = column[j][lane] * column[j][lane] - ridge;
            // 1e-24 is the square of 1e-12: a part this small is the rounding of the column itself.
            *rank += u8::from(own > ridge.max(1e-24 * total[lane]));
        }
    }
    ranks[..axes].iter().copied().min().unwrap_or(0)
}

/// Returns the standard deviations of x, v and a in the window, from the first columns of the factor without the
/// constant's row.
pub(super) fn excitation(factor: &ImpedanceFactor, ridge: f64, settings: &ImpedanceSettings) -> ImpedanceExcitation {
    let rows = factor.column(0)[0];
    let deviation = |j: usize, scale: f64| {
        let squares = factor.column(j)[1..].iter().fold(Lanes::ZERO, |sum, r| sum + *r * *r);
        // The ridge adds to every diagonal; without it a resting axis would show a variation.
        let variance = (squares - Lanes::splat(ridge)).map(|s| s.max(0.0));
        // The constant's diagonal is the square root of the number of rows.
        (variance.sqrt() * rows.recip_or_zero().map(f64::abs) * scale).vector()
    };
    ImpedanceExcitation {
        position_m: deviation(1, settings.scales.position_m),
        velocity_m_s: deviation(2, settings.scales.velocity_m_s),
        acceleration_m_s2: deviation(3, settings.scales.acceleration_m_s2),
    }
}
