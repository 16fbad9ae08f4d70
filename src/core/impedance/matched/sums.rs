//! Normal equations that fade by the clock, and their nested solutions.

use super::{
    super::{factor::column_start, pace::share},
    form::{COLUMNS, Row},
};
use crate::signal::{Lanes, NOTHING};

/// Memory of the columns' mean squares, by which the ridge is made free of units (s by the clock).
const SQUARES_S: f64 = 20.0;
/// Memory of the mean error that flattens the weight of small errors (s by the clock), and how much of it is added.
const ERROR_S: f64 = 0.5;
const FLATTEN: f64 = 0.5;
/// A pivot below this share of its column's square is rounding: that column is left out.
const ROUNDING: f64 = 1e-12;

const ELEMENTS: usize = COLUMNS * (COLUMNS + 1) / 2;

/// Sums of products weighted for the least absolute error. The ridge is in proportion to each column's own mean square, which
/// bounds the scaled condition to about 1e5: safe in f64, and the same in every unit.
#[derive(Clone, Debug)]
pub(super) struct Sums {
    columns: usize,
    rate_hz: f64,
    memory_s: f64,
    gram: [Lanes; ELEMENTS],
    right: Row,
    mean_squares: Row,
    mean_error_n: Lanes,
    seen: f64,
    factor: Factor,
}

#[derive(Clone, Debug)]
struct Factor {
    elements: [Lanes; ELEMENTS],
    inverse: Row,
    right: Row,
}

impl Sums {
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
            factor: Factor {
                elements: [Lanes::ZERO; ELEMENTS],
                inverse: [Lanes::ZERO; COLUMNS],
                right: [Lanes::ZERO; COLUMNS],
            },
        }
    }

    /// Takes in a force (N) with its columns; `error_n`: what the newest full model leaves of it; `pace`: of the clock.
    pub(super) fn learn(&mut self, row: &Row, force_n: Lanes, error_n: Lanes, pace: f64) {
        self.seen += pace;
        let [of_squares, of_errors] =
            [SQUARES_S, ERROR_S].map(|memory_s| share(pace, self.seen, memory_s * self.rate_hz));
        for (square, q) in self.mean_squares.iter_mut().zip(row).take(self.columns) {
            *square = (*square + (*q * *q - *square) * of_squares).settled();
        }
        let size_n = error_n.map(f64::abs);
        self.mean_error_n = (self.mean_error_n + (size_n - self.mean_error_n) * of_errors).settled();
        let weight =
            size_n.zip(self.mean_error_n, |size, mean| if mean > 0.0 { pace / (size / mean + FLATTEN) } else { pace });
        let fade = (-pace / (self.memory_s * self.rate_hz)).exp();
        for j in 0..self.columns {
            let weighted = row[j] * weight;
            self.right[j] = (self.right[j] * fade + weighted * force_n).settled();
            let start = column_start(j);
            for (sum, q) in self.gram[start..=start + j].iter_mut().zip(row) {
                *sum = *sum * fade + weighted * *q;
            }
        }
    }

    /// Factorises with a ridge (s of typical motion that say "no force"; the constant has none).
    pub(super) fn factorise(&mut self, ridge_s: f64) {
        let ridge = ridge_s * self.rate_hz;
        let Factor { elements, inverse, right } = &mut self.factor;
        for j in 0..self.columns {
            let start = column_start(j);
            let (done, rest) = elements.split_at_mut(start);
            let column = &mut rest[..=j];
            for (entry, sum) in column.iter_mut().zip(&mut self.gram[start..=start + j]) {
                *sum = sum.settled();
                *entry = *sum;
            }
            let own = if j > 0 { column[j] + self.mean_squares[j] * ridge } else { column[j] };
            let (mut square, mut z) = (Lanes::ZERO, self.right[j]);
            for k in 0..j {
                let above = &done[column_start(k)..column_start(k) + k];
                let known = above.iter().zip(&*column).fold(Lanes::ZERO, |sum, (a, b)| sum + *a * *b);
                let entry = (column[k] - known) * inverse[k];
                column[k] = entry;
                square += entry * entry;
                z -= entry * right[k];
            }
            inverse[j] = (own - square)
                .zip(own, |pivot, own| if pivot > NOTHING.max(ROUNDING * own) { 1.0 / pivot.sqrt() } else { 0.0 });
            right[j] = z * inverse[j];
        }
    }

    /// The parameters of the leading columns by the newest factorisation, zero beyond; `None` where one is not finite.
    pub(super) fn parameters(&self, columns: usize) -> Option<Row> {
        let Factor { elements, inverse, right } = &self.factor;
        let mut found = [Lanes::ZERO; COLUMNS];
        found[..columns].copy_from_slice(&right[..columns]);
        for j in (0..columns).rev() {
            let value = found[j] * inverse[j];
            found[j] = value;
            let start = column_start(j);
            for (rest, entry) in found.iter_mut().zip(&elements[start..start + j]) {
                *rest -= value * *entry;
            }
        }
        found.iter().all(|p| p.is_finite()).then_some(found)
    }

    pub(super) fn reset(&mut self) {
        *self = Self::new(self.columns, self.memory_s, self.rate_hz);
    }
}
