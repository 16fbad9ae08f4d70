//! The judge: how much of each variant is rendered, and whether anything is.

use super::{keep, regressors::VARIANTS};
use crate::signal::Lanes;

/// What is mixed: the variants of the regression axis by axis, and the one with cross-talk (silent where it is not asked for).
pub(super) const EXPERTS: usize = VARIANTS + 1;
/// Memory of the weights' fit, s.
const STACK_MEMORY_S: f64 = 1.0;
/// Ridge of the weights' fit, as a share of the energy to be explained.
const STACK_RIDGE: f64 = 0.01;
/// Memory of the guard, s, at most a third of the evidence so far.
const GUARD_MEMORY_S: f64 = 5.0;
const GUARD_GROWTH: f64 = 3.0;
/// The guard closes when the running error reaches that of delayed reflection, and is fully open this much below.
const GUARD_WIDTH: f64 = 0.05;
/// Evidence before full trust, s.
const TRUST_AFTER_S: f64 = 0.1;
/// Added to the ratio while variants are judged with newer parameters than they will be used with.
const EARLY_BIAS: f64 = 0.4;

/// Weights of the variants by non-negative least squares on their own past predictions; the guard over the mixture.
#[derive(Clone, Debug)]
pub(super) struct Mixture {
    rate_hz: f64,
    products: [[f64; EXPERTS]; EXPERTS],
    with_truth: [f64; EXPERTS],
    truth: f64,
    weights: [f64; EXPERTS],
    own_error: f64,
    reflected_error: f64,
    evidence: f64,
}

impl Mixture {
    pub(super) fn new(rate_hz: f64) -> Self {
        Self {
            rate_hz,
            products: [[0.0; EXPERTS]; EXPERTS],
            with_truth: [0.0; EXPERTS],
            truth: 0.0,
            weights: [0.0; EXPERTS],
            own_error: 0.0,
            reflected_error: 0.0,
            evidence: 0.0,
        }
    }

    /// Weights in force.
    pub(super) const fn weights(&self) -> &[f64; EXPERTS] {
        &self.weights
    }

    /// Judges what the variants expected against the change that came (N); `error_n` is what the mixture in force missed,
    /// `typical_n` the mean change over the horizon.
    pub(super) fn judge(&mut self, expected: &[Lanes; EXPERTS], change: Lanes, error_n: f64, typical_n: f64) {
        let reflected_n = change.norm();
        let guard = keep(GUARD_MEMORY_S, self.rate_hz).min(1.0 - 1.0 / (self.evidence / GUARD_GROWTH + 2.0));
        self.own_error = guard * self.own_error + error_n;
        self.reflected_error = guard * self.reflected_error + reflected_n;
        self.evidence += 1.0;
        let old = keep(STACK_MEMORY_S, self.rate_hz);
        let scale = error_n + 0.3 * typical_n;
        let weight = if scale > 0.0 { 1.0 / scale } else { 0.0 };
        for i in 0..EXPERTS {
            let weighted = expected[i] * weight;
            self.with_truth[i] = old * self.with_truth[i] + dot(weighted, change);
            for (product, other) in self.products[i].iter_mut().zip(expected) {
                *product = old * *product + dot(weighted, *other);
            }
        }
        self.truth = old * self.truth + weight * reflected_n * reflected_n;
        self.fit();
    }

    /// Two sweeps of coordinate descent from the last weights: close enough every tick, bounded work.
    fn fit(&mut self) {
        if self.truth <= 0.0 {
            return;
        }
        for _ in 0..2 {
            for i in 0..EXPERTS {
                let explained: f64 =
                    (0..EXPERTS).filter(|&j| j != i).map(|j| self.products[i][j] * self.weights[j]).sum();
                let own = self.products[i][i] + STACK_RIDGE * self.truth;
                self.weights[i] = ((self.with_truth[i] - explained) / own).max(0.0);
            }
        }
        let sum: f64 = self.weights.iter().sum();
        if sum > 1.0 {
            self.weights = self.weights.map(|weight| weight / sum);
        }
    }

    /// Share of the mixture that is rendered, 0 to 1; `early` while the judgement is optimistic.
    pub(super) fn gate(&self, early: bool) -> f64 {
        if self.reflected_error <= 0.0 {
            return 0.0;
        }
        let ratio = self.own_error / self.reflected_error + if early { EARLY_BIAS } else { 0.0 };
        let trust = (self.evidence / self.rate_hz / TRUST_AFTER_S).min(1.0);
        ((1.0 - ratio) / GUARD_WIDTH).clamp(0.0, 1.0) * trust
    }

    pub(super) fn reset(&mut self) {
        *self = Self::new(self.rate_hz);
    }
}

fn dot(a: Lanes, b: Lanes) -> f64 {
    let Lanes([x, y, z, _]) = a * b;
    x + y + z
}

#[cfg(test)]
mod tests {
    use super::*;

    fn force(i: usize) -> Lanes {
        Lanes([(i as f64 * 0.01).sin(), (i as f64 * 0.017).cos(), 0.3, 0.0])
    }

    #[test]
    fn the_right_variant_gets_the_weight_and_the_guard_opens() {
        let mut mixture = Mixture::new(1000.0);
        for i in 0..3000 {
            let mut expected = [Lanes::ZERO; EXPERTS];
            expected[2] = force(i);
            expected[4] = force(i + 200);
            let mix = expected[2] * mixture.weights()[2] + expected[4] * mixture.weights()[4];
            mixture.judge(&expected, force(i), (force(i) - mix).norm(), 1.0);
        }
        assert!(mixture.weights()[2] > 0.95, "{:?}", mixture.weights());
        assert!(mixture.gate(false) > 0.99);
    }

    #[test]
    fn useless_variants_get_nothing_and_a_worse_mixture_is_shut() {
        let mut mixture = Mixture::new(1000.0);
        for i in 0..3000 {
            let expected = [force(i) * -1.0; EXPERTS];
            mixture.judge(&expected, force(i), 1.5 * force(i).norm(), 1.0);
        }
        assert!(mixture.weights().iter().all(|&weight| weight == 0.0));
        assert!(mixture.gate(false) == 0.0);
    }
}
