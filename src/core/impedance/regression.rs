//! Recursive regression of the change of force over the delay, with forgetting, several ridges at once.

use super::{
    factor::column_start,
    regressors::{LINEAR_REGRESSORS, REGRESSORS, Regressors},
};
use crate::signal::{Lanes, NOTHING, settled};

/// Memory of the regression (s).
const MEMORY_S: f64 = 3.0;
/// Ridges, in seconds of typical motion that say "no change".
const RIDGES_S: [f64; RIDGES] = [0.0003, 0.01, 0.3];
/// Memory of the regressors' mean squares, by which the ridges are made free of units (s).
const ENERGY_S: f64 = 20.0;
/// Memory of the mean error that flattens the weight of small errors (s), and how much of it is added.
const ERROR_S: f64 = 0.5;
const FLATTEN: f64 = 0.5;

pub(super) const RIDGES: usize = 3;
/// Solutions: for each ridge the linear and the full model.
pub(super) const SOLUTIONS: usize = 2 * RIDGES;
const ELEMENTS: usize = REGRESSORS * (REGRESSORS + 1) / 2;

/// Parameters of every solution, one lane per axis; solution `2 r` is the linear model with ridge `r`, `2 r + 1` the full one.
pub(super) type Parameters = [Regressors; SOLUTIONS];

/// Regressors in use by a solution.
pub(super) const fn length(solution: usize) -> usize {
    if solution.is_multiple_of(2) { LINEAR_REGRESSORS } else { REGRESSORS }
}

/// `sum_j parameters_j regressors_j` of one solution (N).
#[inline]
pub(super) fn predict(parameters: &Regressors, regressors: &Regressors, length: usize) -> Lanes {
    parameters.iter().zip(regressors).take(length).fold(Lanes::ZERO, |sum, (p, q)| sum + *p * *q)
}

/// Exponentially forgotten sums of products, weighted for the least absolute error; solved by Cholesky with a ridge in
/// proportion to each regressor's own mean square, which bounds the scaled condition to about 1e5, so that normal equations
/// are safe in f64. The same in every unit of length and force.
#[derive(Clone, Debug)]
pub(super) struct Regression {
    rate_hz: f64,
    forget: f64,
    gram: [Lanes; ELEMENTS],
    right: Regressors,
    mean_squares: Regressors,
    mean_error_n: f64,
    learnt: f64,
}

impl Regression {
    pub(super) fn new(rate_hz: f64) -> Self {
        Self {
            rate_hz,
            forget: (-1.0 / (MEMORY_S * rate_hz)).exp(),
            gram: [Lanes::ZERO; ELEMENTS],
            right: [Lanes::ZERO; REGRESSORS],
            mean_squares: [Lanes::ZERO; REGRESSORS],
            mean_error_n: 0.0,
            learnt: 0.0,
        }
    }

    /// Running mean squares of the regressors.
    pub(super) fn mean_squares(&self) -> &Regressors {
        &self.mean_squares
    }

    /// Takes in one change of force (N) with its regressors; `newest` are the newest parameters, whose error weighs it.
    pub(super) fn learn(&mut self, q: &Regressors, change_n: Lanes, newest: &Parameters) {
        self.learnt += 1.0;
        let share = 1.0 / self.learnt.min(ENERGY_S * self.rate_hz);
        for (square, q) in self.mean_squares.iter_mut().zip(q) {
            *square = (*square + (*q * *q - *square) * share).settled();
        }
        let error_n = (change_n - predict(&newest[1], q, REGRESSORS)).norm();
        let share = 1.0 / self.learnt.min(ERROR_S * self.rate_hz);
        self.mean_error_n = settled(self.mean_error_n + (error_n - self.mean_error_n) * share);
        let weight = if self.mean_error_n > 0.0 { 1.0 / (error_n / self.mean_error_n + FLATTEN) } else { 1.0 };
        for j in 0..REGRESSORS {
            let weighted = q[j] * weight;
            self.right[j] = (self.right[j] * self.forget + weighted * change_n).settled();
            let start = column_start(j);
            for (sum, q) in self.gram[start..=start + j].iter_mut().zip(q) {
                *sum = *sum * self.forget + weighted * *q;
            }
        }
    }

    /// Solves for ridge `r`: the linear model and the full one.
    pub(super) fn solve(&mut self, r: usize, parameters: &mut Parameters) {
        let ridge = RIDGES_S[r] * self.rate_hz;
        let mut factor = [Lanes::ZERO; ELEMENTS];
        let mut inverse = [Lanes::ZERO; REGRESSORS];
        let mut z = [Lanes::ZERO; REGRESSORS];
        for j in 0..REGRESSORS {
            let start = column_start(j);
            let (done, rest) = factor.split_at_mut(start);
            let column = &mut rest[..=j];
            for (entry, sum) in column.iter_mut().zip(&mut self.gram[start..=start + j]) {
                *sum = sum.settled();
                *entry = *sum;
            }
            let mut square = Lanes::ZERO;
            let mut right = self.right[j];
            for k in 0..j {
                let known = dot(&done[column_start(k)..column_start(k) + k], &column[..k]);
                let entry = (column[k] - known) * inverse[k];
                column[k] = entry;
                square += entry * entry;
                right -= entry * z[k];
            }
            let pivot = column[j] + self.mean_squares[j] * ridge - square;
            inverse[j] = pivot.map(|pivot| if pivot > NOTHING { 1.0 / pivot.sqrt() } else { 0.0 });
            z[j] = right * inverse[j];
        }
        for solution in [2 * r, 2 * r + 1] {
            let mut rest = z;
            let found = &mut parameters[solution];
            for j in (0..length(solution)).rev() {
                let value = rest[j] * inverse[j];
                found[j] = value;
                let start = column_start(j);
                for (rest, entry) in rest.iter_mut().zip(&factor[start..start + j]) {
                    *rest -= value * *entry;
                }
            }
        }
    }

    pub(super) fn reset(&mut self) {
        *self = Self::new(self.rate_hz);
    }
}

#[inline]
fn dot(a: &[Lanes], b: &[Lanes]) -> Lanes {
    a.iter().zip(b).fold(Lanes::ZERO, |sum, (a, b)| sum + *a * *b)
}
