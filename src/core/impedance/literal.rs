//! The paper's method to the letter: `M = F X^T (X X^T)^-1` per axis and degree, and the degree with the smallest error
//! in the window.

use super::{
    LiteralModel, MAX_DEGREE,
    factor::column_start,
    features::{MOTION_COLUMNS, Scales},
    gram::{GRAM_ROW, Gram},
    recipe::Recipe,
};
use crate::signal::{LANES, Lanes};

/// Solves the normal equations of every degree from one Cholesky factorisation of the largest Gram matrix.
///
/// Raw SI columns, no pivoting, no cut-off, and unless the [`Recipe`] says otherwise no constant and no ridge: where
/// the matrix is not positive definite in floating point, or a number is not finite, that axis and degree has *failed*:
/// the failure is counted, the coefficients are zero and the error is the whole force. No other remedy is applied.
#[derive(Clone, Debug)]
pub struct LiteralSolver {
    max_degree: usize,
    axes: usize,
    penalty: [f64; MOTION_COLUMNS],
    models: [LiteralModel; MAX_DEGREE],
    error_n: [f64; MAX_DEGREE],
    failures: u64,
}

impl LiteralSolver {
    /// Creates a solver for degrees `1..=max_degree` of the first `axes` lanes.
    pub fn new(max_degree: usize, axes: usize, recipe: &Recipe, scales: &Scales) -> Self {
        Self {
            max_degree,
            axes,
            penalty: recipe.penalty(scales),
            models: [LiteralModel::NONE; MAX_DEGREE],
            // Infinite, not zero: a degree that was never solved must not be the best one.
            error_n: [f64::INFINITY; MAX_DEGREE],
            failures: 0,
        }
    }

    /// Solves every degree on the sums of `rows` rows.
    pub fn solve(&mut self, gram: &Gram, rows: usize) {
        let n = gram.columns();
        let first = gram.constants();
        let (r, definite) = cholesky(gram, &self.ridge(first, rows));
        for degree in 1..=self.max_degree {
            let columns = first + 3 * degree;
            let mut m = back_substitute(&r, columns, n);
            let squares = residual_squares(gram, &m, columns);
            // This sum is not finite in any lane where a coefficient or the error is not finite.
            // Times zero: a finite number gives 0, NaN and infinity give NaN.
            let finite = m[..columns].iter().fold(squares, |sum, m| sum + *m * 0.0);
            let solved: [bool; LANES] =
                std::array::from_fn(|lane| lane < self.axes && definite[lane] >= columns && finite[lane].is_finite());
            let mut square_n2 = 0.0;
            for axis in 0..self.axes {
                // On a failed axis the model is zero, so its error is the force itself. The difference of large sums
                // may round below zero.
                square_n2 += if solved[axis] { squares[axis].max(0.0) } else { gram.column(n)[n][axis] };
            }
            let failed = solved[..self.axes].iter().filter(|solved| !**solved).count();
            if failed > 0 {
                self.failures += failed as u64;
                m = m.map(|m| Lanes(std::array::from_fn(|lane| if solved[lane] { m[lane] } else { 0.0 })));
            }
            let model = &mut self.models[degree - 1];
            // A model is reported as long as one axis has one.
            model.degree = if failed < self.axes { degree as u8 } else { 0 };
            model.constant_n = if first > 0 { m[0] } else { Lanes::ZERO };
            model.coefficients.copy_from_slice(&m[first..first + MOTION_COLUMNS]);
            // Per row and over all axes: the paper's 3-D reconstruction error.
            self.error_n[degree - 1] = (square_n2 / rows.max(1) as f64).sqrt();
        }
    }

    /// Returns the values to add to the pivots.
    fn ridge(&self, first: usize, rows: usize) -> [f64; GRAM_ROW] {
        let mut ridge = [0.0; GRAM_ROW];
        for (ridge, penalty) in ridge[first..].iter_mut().zip(self.penalty) {
            // The setting is per row, the sums are over all rows.
            *ridge = rows as f64 * penalty;
        }
        ridge
    }

    /// Returns the fit of `degree` (1-based): zero on a failed axis, no model if every axis failed.
    pub fn model(&self, degree: usize) -> &LiteralModel {
        degree.checked_sub(1).and_then(|index| self.models.get(index)).unwrap_or(&LiteralModel::NONE)
    }

    /// Returns the coefficients of `degree` (1-based), SI units, zero beyond `3 * degree` and on a failed axis.
    pub fn coefficients(&self, degree: usize) -> &[Lanes; MOTION_COLUMNS] {
        &self.models[degree.clamp(1, MAX_DEGREE) - 1].coefficients
    }

    /// Returns the root mean square 3-D error (N) inside the window with `degree`.
    pub fn window_error_n(&self, degree: usize) -> f64 {
        self.error_n[degree.clamp(1, MAX_DEGREE) - 1]
    }

    /// Returns whether at least one axis was solved with `degree`.
    pub fn is_solved(&self, degree: usize) -> bool {
        self.model(degree).degree > 0
    }

    /// Returns the paper's choice: the degree with the smallest 3-D error inside the window; 0 if none could be solved.
    pub fn choice(&self) -> usize {
        // Only solved degrees compete: a failed one has the error of no model, which a bad fit may exceed.
        (1..=self.max_degree)
            .filter(|&degree| self.is_solved(degree))
            .min_by(|&a, &b| self.window_error_n(a).total_cmp(&self.window_error_n(b)))
            .unwrap_or(0)
    }

    /// Returns the number of failed solves (one per tick, axis and degree) since construction or reset.
    pub fn failures(&self) -> u64 {
        self.failures
    }

    pub fn reset(&mut self) {
        self.models = [LiteralModel::NONE; MAX_DEGREE];
        self.error_n = [f64::INFINITY; MAX_DEGREE];
        self.failures = 0;
    }
}

type Triangle = [Lanes; GRAM_ROW * (GRAM_ROW + 1) / 2];

/// Returns `R` with `R^T R = [X; f] [X; f]^T` (the force column too), and for each lane how many leading pivots were
/// positive. `ridge` is added to the diagonal of `X X^T`.
fn cholesky(gram: &Gram, ridge: &[f64; GRAM_ROW]) -> (Triangle, [usize; LANES]) {
    let n = gram.columns();
    let mut r = [Lanes::ZERO; GRAM_ROW * (GRAM_ROW + 1) / 2];
    let mut definite = [n; LANES];
    for j in 0..=n {
        let start = column_start(j);
        let (done, rest) = r.split_at_mut(start);
        let column = &mut rest[..=j];
        for k in 0..=j {
            let above = if k < j { &done[column_start(k)..=column_start(k) + k] } else { &[] };
            let known = if k < j {
                above.iter().zip(&*column).take(k).fold(Lanes::ZERO, |sum, (a, b)| sum + *a * *b)
            } else {
                column[..j].iter().fold(Lanes::ZERO, |sum, b| sum + *b * *b)
            };
            let rest = gram.column(j)[k] - known;
            // The reciprocal of a zero pivot is zero, so a column without information gets no coefficient.
            column[k] = if k < j { rest * above[k].recip_or_zero() } else { rest };
        }
        if j < n {
            column[j] += Lanes::splat(ridge[j]);
            for (lane, definite) in definite.iter_mut().enumerate() {
                // A NaN pivot is not positive either.
                let positive = column[j][lane] > 0.0;
                *definite = if positive { *definite } else { (*definite).min(j) };
            }
            // A negative pivot has been counted above; its root would turn all later columns into NaN.
            column[j] = column[j].map(|pivot| pivot.max(0.0).sqrt());
        }
    }
    (r, definite)
}

/// Solves `R_p M = z_p` for the leading `columns` columns; column `n` is the right-hand side.
fn back_substitute(r: &Triangle, columns: usize, n: usize) -> [Lanes; GRAM_ROW] {
    let mut m = [Lanes::ZERO; GRAM_ROW];
    let z = column_start(n);
    m[..columns].copy_from_slice(&r[z..z + columns]);
    for j in (0..columns).rev() {
        let column = &r[column_start(j)..=column_start(j) + j];
        let value = m[j] * column[j].recip_or_zero();
        m[j] = value;
        for (m, r) in m.iter_mut().zip(column).take(j) {
            *m -= value * *r;
        }
    }
    m
}

/// Returns `|f - M X|^2` over the window from the sums: `f f^T - 2 M X f^T + M X X^T M^T`.
fn residual_squares(gram: &Gram, m: &[Lanes; GRAM_ROW], columns: usize) -> Lanes {
    let n = gram.columns();
    let force = gram.column(n);
    let mut sum = force[n];
    for j in 0..columns {
        let column = gram.column(j);
        let off_diagonal = column.iter().zip(m).take(j).fold(Lanes::ZERO, |sum, (g, m)| sum + *g * *m);
        sum += m[j] * (m[j] * column[j] + (off_diagonal - force[j]) * 2.0);
    }
    sum
}
