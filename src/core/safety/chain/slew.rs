//! Fifth gate: limits the rate of change of the force, so that no step kicks the hand.

use nalgebra::SVector;

use super::Reason;

/// The slew limit and the last force that left the chain.
///
/// ```
/// use nalgebra::Vector3;
/// use nima_core::safety::{Reason, Slew};
///
/// let slew = Slew::new(500.0, 1e-3);
/// let (force_n, reason) = slew.limited(Vector3::new(3.0, 0.0, 0.0), 1e-3);
/// assert!((force_n.x - 0.5).abs() < 1e-12, "500 N/s are 0.5 N per millisecond");
/// assert_eq!(reason, Reason::ChangeTooFast);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Slew<const D: usize> {
    n_per_s: f64,
    period_s: f64,
    last_n: SVector<f64, D>,
}

impl<const D: usize> Slew<D> {
    /// Limits the change to `n_per_s` (N/s) in a loop with this nominal period (s), starting without force.
    pub fn new(n_per_s: f64, period_s: f64) -> Self {
        Self { n_per_s, period_s, last_n: SVector::zeros() }
    }

    /// Returns the force nearest to `force_n` (N) that the limit allows `dt_s` (s) after the last one, and whether it
    /// differs.
    ///
    /// A late tick allows no more than a punctual one, because the hand feels the whole change at once.
    pub fn limited(&self, force_n: SVector<f64, D>, dt_s: f64) -> (SVector<f64, D>, Reason) {
        // `dt_s` below the period (two ticks close together) allows less, so the rate holds over any two ticks.
        let step = force_n - self.last_n;
        let norm = step.norm();
        let max_n = self.n_per_s * dt_s.min(self.period_s);
        if norm <= max_n {
            return (force_n, Reason::Open);
        }
        (self.last_n + step * (max_n / norm), Reason::ChangeTooFast)
    }

    /// Returns the last force (N) that left the chain.
    pub const fn last_n(&self) -> SVector<f64, D> {
        self.last_n
    }

    /// Stores the force (N) that left the chain.
    pub const fn left(&mut self, force_n: SVector<f64, D>) {
        self.last_n = force_n;
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn no_two_forces_in_a_row_differ_by_more_than_a_step(
            asked in prop::collection::vec((prop::array::uniform3(-1e3..1e3f64), 0.0..0.1f64), 1..100),
        ) {
            let mut slew = Slew::new(500.0, 1e-3);
            for (asked, dt_s) in asked {
                let asked = Vector3::from(asked);
                let (now, reason) = slew.limited(asked, dt_s);
                prop_assert!((now - slew.last_n()).norm() <= 500.0 * dt_s.min(1e-3) * (1.0 + 1e-12));
                prop_assert_eq!(reason == Reason::Open, now == asked);
                prop_assert!((asked - now).norm() <= (asked - slew.last_n()).norm(), "never away from the requested force");
                slew.left(now);
            }
        }
    }
}
