//! Recursive regression of the change of force over the delay, with forgetting, for several ridges at once.

use super::{
    normal::{NormalFactor, accumulate, dot},
    regressors::{LINEAR_REGRESSORS, REGRESSORS, Regressors, at},
};
use crate::signal::{Lanes, settled};

/// Memory of the regression (s), and its value for sessions with an earlier journal. Half or twice any memory changes the
/// mean error on recordings by less than 2 %, and a shorter one forgets another tissue sooner. Longer than the longest
/// delay (1 s), so that it contains changes over it.
const MEMORY_S: f64 = 1.5;
const EARLIER_S: f64 = 3.0;
/// After another tissue, the mean error falls as the fit learns the new one. Below the recent peak divided by this, older
/// samples lose weight in proportion to the error: otherwise the large forces of a stiff tissue outweigh the small ones of
/// a soft tissue for the length of the memory.
const SETTLED: f64 = 1.3;
/// Ridges, in seconds of typical motion without a change of force. Each of the three lowers the mean error on recordings.
const RIDGES_S: [f64; RIDGES] = [0.0003, 0.01, 0.3];
/// Memory of the regressors' mean squares, which make the ridges independent of units (s): longer than the memory of
/// the fit, so that a pause in the motion does not change the ridges.
const ENERGY_S: f64 = 20.0;
/// Memory of the mean error that flattens the weight of small errors (s), and the fraction of it that is added.
const ERROR_S: f64 = 0.5;
const FLATTEN: f64 = 0.5;

pub(super) const RIDGES: usize = 3;
/// Models of each ridge: the linear and the full one, and their leading regressors.
pub(super) const NESTED: usize = 2;
pub(super) const LENGTHS: [usize; NESTED] = [LINEAR_REGRESSORS, REGRESSORS];
const ELEMENTS: usize = REGRESSORS * (REGRESSORS + 1) / 2;

/// Parameters of the models of one ridge, one lane per axis.
pub(super) type Solutions = [Regressors; NESTED];

/// Returns `sum_j parameters_j regressors_j` of one solution (N).
#[inline]
pub(super) fn predict(parameters: &Regressors, regressors: &Regressors, length: usize) -> Lanes {
    dot(&parameters[..length], regressors)
}

/// Mean error in motion (N), and its recent peak, at most `SETTLED` times the mean.
#[derive(Clone, Copy, Debug, Default)]
struct SettlingError {
    mean_n: f64,
    peak_n: f64,
}

impl SettlingError {
    /// Adds an error; returns the factor by which the peak fell.
    fn step(&mut self, error_n: f64, fraction: f64) -> f64 {
        self.mean_n = settled(self.mean_n + (error_n - self.mean_n) * fraction);
        let before_n = self.peak_n;
        self.peak_n = before_n.min(SETTLED * self.mean_n).max(self.mean_n);
        if self.peak_n < before_n { self.peak_n / before_n } else { 1.0 }
    }
}

/// Exponentially forgotten sums of products, weighted for the least absolute error; solved by Cholesky with a ridge in
/// proportion to each regressor's own mean square, which bounds the scaled condition to about 1e5, so that normal
/// equations are safe in f64. The result is the same in every unit of length and force.
#[derive(Clone, Debug)]
pub(super) struct ImpedanceRegression {
    rate_hz: f64,
    forget: f64,
    gram: [Lanes; ELEMENTS],
    right: Regressors,
    mean_squares: Regressors,
    mean_error_n: f64,
    /// `None` in the replay of an earlier journal.
    settling: Option<SettlingError>,
    learnt: f64,
    factor: NormalFactor,
}

impl ImpedanceRegression {
    pub(super) fn new(rate_hz: f64, earlier_forces: bool) -> Self {
        let memory_s = if earlier_forces { EARLIER_S } else { MEMORY_S };
        Self {
            rate_hz,
            forget: libm::exp(-1.0 / (memory_s * rate_hz)),
            gram: [Lanes::ZERO; ELEMENTS],
            right: [Lanes::ZERO; REGRESSORS],
            mean_squares: [Lanes::ZERO; REGRESSORS],
            mean_error_n: 0.0,
            settling: (!earlier_forces).then(SettlingError::default),
            learnt: 0.0,
            factor: NormalFactor::new(),
        }
    }

    /// Returns the running mean squares of the regressors.
    pub(super) fn mean_squares(&self) -> &Regressors {
        &self.mean_squares
    }

    /// Adds one change of force (N) with its regressors; `newest`: parameters of the full model, whose error determines
    /// the weight.
    pub(super) fn learn(&mut self, q: &Regressors, change_n: Lanes, newest: &Regressors) {
        self.learnt += 1.0;
        let fraction = 1.0 / self.learnt.min(ENERGY_S * self.rate_hz);
        for (square, q) in self.mean_squares.iter_mut().zip(q) {
            *square = (*square + (*q * *q - *square) * fraction).settled();
        }
        // With the newest parameters: a sample that they explain badly is an impact or a new tissue.
        let error_n = (change_n - predict(newest, q, REGRESSORS)).norm();
        let fraction = 1.0 / self.learnt.min(ERROR_S * self.rate_hz);
        self.mean_error_n = settled(self.mean_error_n + (error_n - self.mean_error_n) * fraction);
        // About 1 / error, which approximates the least absolute error (see `matched/sums.rs`).
        let weight = if self.mean_error_n > 0.0 { 1.0 / (error_n / self.mean_error_n + FLATTEN) } else { 1.0 };
        // By motion, so that the small errors of a standstill do not count.
        let moved = q[at::MOTION].zip(self.mean_squares[at::MOTION], |q, square| {
            if square > 0.0 { (q.abs() / square.sqrt()).min(1.0) } else { 0.0 }
        });
        let pace = moved.0.into_iter().fold(0.0, f64::max);
        let fade = self.forget * self.settling.as_mut().map_or(1.0, |settling| settling.step(error_n, pace * fraction));
        accumulate(&mut self.gram, &mut self.right, q, change_n, Lanes::splat(weight), fade);
    }

    /// Solves for ridge `r`: the linear model and the full one.
    pub(super) fn solve(&mut self, r: usize) -> Solutions {
        // In proportion to the column's mean square, so the ridge is the same in every unit.
        let ridge = self.mean_squares.map(|square| square * (RIDGES_S[r] * self.rate_hz));
        self.factor.renew(&mut self.gram, &mut self.right, &ridge);
        let mut found = [[Lanes::ZERO; REGRESSORS]; NESTED];
        for (found, length) in found.iter_mut().zip(LENGTHS) {
            self.factor.solve(&mut found[..length]);
        }
        found
    }

    pub(super) fn reset(&mut self) {
        *self = Self::new(self.rate_hz, self.settling.is_none());
    }
}
