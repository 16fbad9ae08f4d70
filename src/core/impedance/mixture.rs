//! Weights of the experts: a softmin of their errors at the true prediction horizon.

use crate::signal::Lanes;

/// Memory of the errors (s). Chosen as in `anchored.rs`.
const MEMORY_S: f64 = 1.0;
/// Amount of evidence needed for full trust (s).
/// Design choice: shorter ramps act on a few samples, longer ones leave more of a new delay uncorrected.
const RAMP_S: f64 = 0.1;
/// Errors below this count as equal (N), because the weights would otherwise divide one rounding error by another.
const EQUAL_N: f64 = 1e-12;

/// Weights, per axis, of `EXPERTS` predicted changes of force: the eighth power of the ratio of the smallest running
/// error to that of each expert. No change of force (plain reflection) is evaluated with them; its weight is the
/// difference between one and their sum.
#[derive(Clone, Debug)]
pub(super) struct Mixture<const EXPERTS: usize> {
    rate_hz: f64,
    judged: f64,
    errors_n: [Lanes; EXPERTS],
    held_n: Lanes,
    weights: [Lanes; EXPERTS],
}

impl<const EXPERTS: usize> Mixture<EXPERTS> {
    pub(super) fn new(rate_hz: f64) -> Self {
        let none = [Lanes::ZERO; EXPERTS];
        Self { rate_hz, judged: 0.0, errors_n: none, held_n: Lanes::ZERO, weights: none }
    }

    pub(super) const fn weights(&self) -> &[Lanes; EXPERTS] {
        &self.weights
    }

    /// Evaluates the experts' predictions of one delay ago (N) by the actual change of force. The error of reflection
    /// counts `caution` times.
    pub(super) fn judge(&mut self, said: &[Lanes; EXPERTS], change: Lanes, caution: f64) {
        self.judged += 1.0;
        let fraction = 1.0 / self.judged.min(MEMORY_S * self.rate_hz);
        let follow = |mean_n: Lanes, error_n: Lanes| (mean_n + (error_n.map(f64::abs) - mean_n) * fraction).settled();
        self.held_n = follow(self.held_n, change);
        let held_n = self.held_n * caution;
        let mut min_n = held_n;
        for (error_n, said) in self.errors_n.iter_mut().zip(said) {
            *error_n = follow(*error_n, change - *said);
            min_n = min_n.zip(*error_n, f64::min);
        }
        let equal_n = Lanes::splat(EQUAL_N);
        let odds = |error_n: Lanes| eighth_power((min_n + equal_n) / (error_n + equal_n));
        self.weights = self.errors_n.map(odds);
        let sum = self.weights.iter().fold(odds(held_n), |sum, weight| sum + *weight);
        let trust = (self.judged / (RAMP_S * self.rate_hz)).min(1.0);
        // If the force has not changed, no expert was wrong and there is nothing to learn.
        let known = self.held_n.map(|held_n| if held_n > EQUAL_N { trust } else { 0.0 });
        let scale = sum.recip_or_zero() * known;
        self.weights.iter_mut().for_each(|weight| *weight *= scale);
    }

    pub(super) fn reset(&mut self) {
        *self = Self::new(self.rate_hz);
    }
}

/// Returns the eighth power, which the softmin uses.
pub(super) fn eighth_power(value: Lanes) -> Lanes {
    let square = value * value;
    let fourth = square * square;
    fourth * fourth
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judged(said: [f64; 2], change: f64, caution: f64) -> [f64; 2] {
        let mut mixture = Mixture::<2>::new(1000.0);
        for _ in 0..500 {
            mixture.judge(&said.map(Lanes::splat), Lanes::splat(change), caution);
        }
        mixture.weights().map(|weight| weight[0])
    }

    #[test]
    fn the_expert_that_errs_least_has_nearly_all_of_the_weight() {
        let [good, bad] = judged([0.9, 0.4], 1.0, 1.0);
        assert!(good > 0.999 && bad < 1e-3 && good + bad <= 1.0, "{good} {bad}");
    }

    #[test]
    fn where_no_expert_is_better_than_reflection_nothing_is_added() {
        let [one, other] = judged([3.0, -0.8], 1.0, 1.0);
        assert!(one + other < 0.02, "{one} {other}");
        assert!(
            judged([0.0, 0.0], 0.0, 1.0).iter().all(|weight| *weight <= 0.0),
            "no expert erred, and nothing is known"
        );
    }

    #[test]
    fn caution_asks_for_more_than_a_little_less_error() {
        let [sure, _] = judged([0.5, 0.0], 1.0, 1.0);
        let [cautious, _] = judged([0.5, 0.0], 1.0, 0.2);
        assert!(sure > 0.99 && cautious < 0.01, "{sure} {cautious}");
    }
}
