//! How far each expert is to be trusted: stacking by the error at the true horizon, and a guard.

use super::messages::clip;
use crate::signal::{Lanes, NOTHING, settled};

/// Memory of the stacking (s), and the ridge of its weights.
const STACK_S: f64 = 1.0;
const STACK_RIDGE: f64 = 0.01;
/// Memory of the mean change of force that flattens the weight of small errors (s), and how much of it is added.
const CHANGE_S: f64 = 2.0;
const FLATTEN: f64 = 0.3;
/// Memory of the guard (s); while less was seen, a third of what was seen.
const GUARD_S: f64 = 5.0;
const GUARD_SHARE: f64 = 3.0;
/// The correction fades out while its error grows from 95 % to 100 % of plain reflection's.
const GUARD_WIDTH: f64 = 0.05;
/// Full trust needs that much evidence (s).
const RAMP_S: f64 = 0.1;
/// Expert predictions are bounded by this many of the largest recent change.
const EXPERT_BOUND: f64 = 2.0;

/// Non-negative weights, with sum at most one, of `EXPERTS` predicted changes of force; what is missing to one is plain
/// reflection. Weighted least squares of the true change on the predictions made one delay ago, by coordinate descent.
///
/// The guard compares the error of what was rendered with that of plain reflection over the last 5 s and fades everything
/// out where that is not less.
#[derive(Clone, Debug)]
pub(super) struct Stack<const EXPERTS: usize> {
    rate_hz: f64,
    forget: f64,
    forget_guard: f64,
    products: [[f64; EXPERTS]; EXPERTS],
    right: [f64; EXPERTS],
    squares_n2: f64,
    weights: [f64; EXPERTS],
    mean_change_n: f64,
    changes: f64,
    error_n: f64,
    reflection_n: f64,
    evidence: f64,
}

impl<const EXPERTS: usize> Stack<EXPERTS> {
    pub(super) fn new(rate_hz: f64) -> Self {
        Self {
            rate_hz,
            forget: (-1.0 / (STACK_S * rate_hz)).exp(),
            forget_guard: (-1.0 / (GUARD_S * rate_hz)).exp(),
            products: [[0.0; EXPERTS]; EXPERTS],
            right: [0.0; EXPERTS],
            squares_n2: 0.0,
            weights: [0.0; EXPERTS],
            mean_change_n: 0.0,
            changes: 0.0,
            error_n: 0.0,
            reflection_n: 0.0,
            evidence: 0.0,
        }
    }

    /// The weights in force.
    pub(super) fn weights(&self) -> &[f64; EXPERTS] {
        &self.weights
    }

    /// Takes note of a change of force over the delay.
    pub(super) fn see_change(&mut self, change_n: f64) {
        self.changes += 1.0;
        let share = 1.0 / self.changes.min(CHANGE_S * self.rate_hz);
        self.mean_change_n = settled(self.mean_change_n + (change_n - self.mean_change_n) * share);
    }

    /// Judges what the experts said one delay ago (N), and what was rendered with the weights of that time (`mixed`), by the
    /// change of force that came.
    pub(super) fn judge(&mut self, mut said: [Lanes; EXPERTS], mixed: Lanes, change: Lanes, largest_change_n: f64) {
        let error_n = (change - mixed).norm();
        let change_n = change.norm();
        let forget = self.forget_guard.min(1.0 - 1.0 / (self.evidence / GUARD_SHARE + 2.0));
        self.error_n = settled(forget * self.error_n + error_n);
        self.reflection_n = settled(forget * self.reflection_n + change_n);
        self.evidence += 1.0;
        for said in &mut said {
            *said = clip(*said, EXPERT_BOUND * largest_change_n);
        }
        let size_n = error_n + FLATTEN * self.mean_change_n;
        let weight = if size_n > NOTHING { 1.0 / size_n } else { 0.0 };
        for (i, a) in said.iter().enumerate() {
            self.right[i] = settled(self.forget * self.right[i] + weight * dot(*a, change));
            for (j, b) in said.iter().enumerate() {
                self.products[i][j] = settled(self.forget * self.products[i][j] + weight * dot(*a, *b));
            }
        }
        self.squares_n2 = settled(self.forget * self.squares_n2 + weight * change_n * change_n);
        self.descend();
    }

    /// Two sweeps of coordinate descent from the weights so far.
    fn descend(&mut self) {
        for _ in 0..2 {
            for i in 0..EXPERTS {
                let others: f64 = (0..EXPERTS).filter(|&j| j != i).map(|j| self.products[i][j] * self.weights[j]).sum();
                let own = self.products[i][i] + STACK_RIDGE * self.squares_n2;
                self.weights[i] = if own > NOTHING { ((self.right[i] - others) / own).max(0.0) } else { 0.0 };
            }
            let sum: f64 = self.weights.iter().sum();
            if sum > 1.0 {
                self.weights.iter_mut().for_each(|weight| *weight /= sum);
            }
        }
    }

    /// How much of the stacked correction is rendered, 0 to 1. `penalty` is added to the ratio of errors.
    pub(super) fn gate(&self, penalty: f64) -> f64 {
        if self.reflection_n <= 0.0 {
            return 0.0;
        }
        let ratio = self.error_n / self.reflection_n + penalty;
        ((1.0 - ratio) / GUARD_WIDTH).clamp(0.0, 1.0) * (self.evidence / (RAMP_S * self.rate_hz)).min(1.0)
    }

    pub(super) fn reset(&mut self) {
        *self = Self::new(self.rate_hz);
    }
}

#[inline]
fn dot(a: Lanes, b: Lanes) -> f64 {
    let [x, y, z, _] = (a * b).0;
    x + y + z
}
