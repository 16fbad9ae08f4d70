//! Normal equations with forgetting by the clock, and their nested solutions.

use super::{
    super::{
        factor::column_start,
        motion_clock::fraction,
        normal::{MAX, NormalFactor, accumulate},
    },
    form::{COLUMNS, FormRow},
};
use crate::signal::Lanes;

/// Memory of the columns' mean squares, which make the ridge independent of units (s by the clock): longer than the
/// memory of the fit, so that a pause in the motion does not change the ridge.
const SQUARES_S: f64 = 20.0;
/// Memory of the mean error that flattens the weight of small errors (s of the motion clock), and the fraction of it
/// that is added.
const ERROR_S: f64 = 0.5;
const FLATTEN: f64 = 0.5;

const ELEMENTS: usize = COLUMNS * (COLUMNS + 1) / 2;

/// Sums of products weighted for the least absolute error. The ridge is in proportion to each column's own mean square, which
/// bounds the scaled condition to about 1e5: safe in f64, and the same in every unit.
#[derive(Clone, Debug)]
pub(super) struct MatchedSums {
    columns: usize,
    rate_hz: f64,
    memory_s: f64,
    gram: [Lanes; ELEMENTS],
    right: FormRow,
    mean_squares: FormRow,
    mean_error_n: Lanes,
    seen: f64,
    factor: NormalFactor,
}

impl MatchedSums {
    pub(super) fn new(columns: usize, memory_s: f64, rate_hz: f64) -> Self {
        Self {
            columns,
            rate_hz,
            memory_s,
            gram: [Lanes::ZERO; ELEMENTS],
            right: [Lanes::ZERO; COLUMNS],
            mean_squares: [Lanes::ZERO; COLUMNS],
            mean_error_n: Lanes::ZERO,
            seen: 0.0,
            factor: NormalFactor::new(),
        }
    }

    /// Adds a force (N) with its columns. `error_n` is its residual with the newest full model, and `pace` the rate of
    /// the motion clock.
    pub(super) fn learn(&mut self, row: &FormRow, force_n: Lanes, error_n: Lanes, pace: f64) {
        self.seen += pace;
        let [of_squares, of_errors] =
            [SQUARES_S, ERROR_S].map(|memory_s| fraction(pace, self.seen, memory_s * self.rate_hz));
        for (square, q) in self.mean_squares.iter_mut().zip(row).take(self.columns) {
            *square = (*square + (*q * *q - *square) * of_squares).settled();
        }
        let size_n = error_n.map(f64::abs);
        self.mean_error_n = (self.mean_error_n + (size_n - self.mean_error_n) * of_errors).settled();
        let weight =
            // About 1 / error: least absolute error by reweighting. `FLATTEN` limits the weight of a sample that fits
            // exactly.
            size_n.zip(self.mean_error_n, |size, mean| if mean > 0.0 { pace / (size / mean + FLATTEN) } else { pace });
        let fade = libm::exp(-pace / (self.memory_s * self.rate_hz));
        let columns = self.columns;
        accumulate(&mut self.gram, &mut self.right[..columns], &row[..columns], force_n, weight, fade);
    }

    /// Factorises with a ridge (s of typical motion without force; the constant has none).
    pub(super) fn factorise(&mut self, ridge_s: f64) {
        let columns = self.columns;
        let mut ridge = self.mean_squares.map(|square| square * (ridge_s * self.rate_hz));
        // A ridge on the constant would pull the force itself towards zero.
        ridge[0] = Lanes::ZERO;
        let elements = column_start(columns);
        self.factor.renew(&mut self.gram[..elements], &mut self.right[..columns], &ridge);
    }

    /// Returns the parameters of the leading columns by the newest factorisation, zero beyond; `None` without
    /// samples, or if one is not finite.
    pub(super) fn parameters(&self, columns: usize) -> Option<FormRow> {
        // Zeros without samples would be rendered as no force.
        if self.seen <= 0.0 {
            return None;
        }
        let mut found = [Lanes::ZERO; COLUMNS];
        self.factor.solve(&mut found[..columns]);
        found.iter().all(|p| p.is_finite()).then_some(found)
    }

    pub(super) fn reset(&mut self) {
        *self = Self::new(self.columns, self.memory_s, self.rate_hz);
    }
}

const _: () = assert!(COLUMNS <= MAX);
