//! Every nested least-squares solution from one triangular factor.

use super::factor::{ImpedanceFactor, MAX_COLUMNS, column_start};
use crate::signal::Lanes;

/// Number of rows of the inverse computed together: four independent chains of additions, so that the processor does
/// not wait for each result.
const BLOCK: usize = 4;
pub(super) const PRODUCTS: usize = MAX_COLUMNS * (MAX_COLUMNS + 1) / 2;

/// The solutions of `min |A_p M - b|` for every prefix `A_p` of the columns at once, one problem per lane.
///
/// With `R = [R_A z; 0 rho]` and `W = R_A^-1`, the solution with the first `p` columns is `W_p z_p` (leading blocks:
/// the inverse of a triangle's leading block is the leading block of its inverse). The products `W_ij z_j` therefore
/// contain all of them: prefix `p` is the sum of their first `p` columns. Its sum of squared residuals is
/// `sum_{j >= p} z_j^2 + rho^2`. A column without information (zero on the diagonal) gets the coefficient 0.
#[derive(Clone, Debug)]
pub struct ImpedanceSolution {
    columns: usize,
    /// `W`, row by row; zero below the diagonal.
    inverse: [[Lanes; MAX_COLUMNS]; MAX_COLUMNS],
    /// `W_ij z_j`, packed by columns.
    products: [Lanes; PRODUCTS],
    /// Sum of squared residuals with the first `p` columns, at index `p`.
    squares: [Lanes; MAX_COLUMNS + 1],
    /// `|R_p|_F |R_p^-1|_F` of the first `p` columns, at index `p`.
    condition: [Lanes; MAX_COLUMNS + 1],
}

impl ImpedanceSolution {
    /// Allocates the solutions of `columns <= 16` unknowns, all zero.
    pub fn new(columns: usize) -> Self {
        Self {
            columns: columns.min(MAX_COLUMNS),
            inverse: [[Lanes::ZERO; MAX_COLUMNS]; MAX_COLUMNS],
            products: [Lanes::ZERO; PRODUCTS],
            squares: [Lanes::ZERO; MAX_COLUMNS + 1],
            condition: [Lanes::ZERO; MAX_COLUMNS + 1],
        }
    }

    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Solves for every prefix of the factor's columns.
    pub fn solve(&mut self, factor: &ImpedanceFactor) {
        let n = self.columns.min(factor.columns());
        let mut norm = Lanes::ZERO;
        let mut inverse_norm = Lanes::ZERO;
        let right = factor.column(factor.columns());
        for j in 0..n {
            let r = factor.column(j);
            // A zero diagonal gives a zero coefficient: the column has no information.
            let diagonal = r[j].recip_or_zero();
            let start = column_start(j);
            // Column j of W is -W_jj * (W_0..j R_0..j,j); four rows at a time, zeros below the diagonal of W included.
            for first in (0..j).step_by(BLOCK) {
                let sums = row_products(&self.inverse, r, first, j);
                for (i, sum) in (first..j).zip(sums) {
                    self.inverse[i][j] = -(sum * diagonal);
                }
            }
            self.inverse[j][j] = diagonal;
            for (i, product) in self.products[start..=start + j].iter_mut().enumerate() {
                let w = self.inverse[i][j];
                // Products instead of coefficients: every prefix is then a partial sum.
                *product = w * right[j];
                // The Frobenius norms of all prefixes come for free from the running sums.
                norm += r[i] * r[i];
                inverse_norm += w * w;
            }
            self.condition[j + 1] = (norm * inverse_norm).sqrt();
        }
        let mut squares = right[n] * right[n];
        self.squares[n] = squares;
        // From the last column backwards: each prefix leaves the later entries as residual.
        for j in (0..n).rev() {
            squares += right[j] * right[j];
            self.squares[j] = squares;
        }
    }

    /// Returns the change of the coefficients `0..=j` when column `j` joins the columns before it.
    #[inline]
    pub(super) fn increment(&self, j: usize) -> &[Lanes] {
        &self.products[column_start(j)..=column_start(j) + j]
    }

    /// Returns all increments, packed by columns.
    #[inline]
    pub(super) fn increments(&self) -> &[Lanes; PRODUCTS] {
        &self.products
    }

    /// Returns the coefficients with the first `prefix` columns, zero beyond. Index 0 is the constant.
    pub fn coefficients(&self, prefix: usize) -> [Lanes; MAX_COLUMNS] {
        let mut sum = [Lanes::ZERO; MAX_COLUMNS];
        for j in 0..prefix.min(self.columns) {
            for (sum, part) in sum.iter_mut().zip(self.increment(j)) {
                *sum += *part;
            }
        }
        sum
    }

    /// Returns the sum of squared residuals (and of the ridge's penalty) with the first `prefix` columns (N²).
    pub fn residual_squares(&self, prefix: usize) -> Lanes {
        self.squares[prefix.min(self.columns)]
    }

    /// Returns the condition number (Frobenius norm: at most `prefix` times the spectral one) of the first `prefix`
    /// scaled columns.
    pub fn condition(&self, prefix: usize) -> Lanes {
        self.condition[prefix.min(self.columns)]
    }
}

/// Returns `sum_k W_ik r_k` over `first <= k < j` for the rows `first..first + BLOCK`.
#[inline]
fn row_products(w: &[[Lanes; MAX_COLUMNS]; MAX_COLUMNS], r: &[Lanes], first: usize, j: usize) -> [Lanes; BLOCK] {
    let mut sums = [Lanes::ZERO; BLOCK];
    let rows: [&[Lanes]; BLOCK] = std::array::from_fn(|i| &w[first + i][first..j]);
    for (k, r) in r[first..j].iter().enumerate() {
        for (sum, row) in sums.iter_mut().zip(rows) {
            *sum += row[k] * *r;
        }
    }
    sums
}

pub(super) type Increments = [Lanes; PRODUCTS];

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};
    use proptest::prelude::*;

    use super::*;
    use crate::impedance::{factor::MAX_ROW, window::WindowSummary as _};

    fn rows(n: usize, columns: usize, seed: u64) -> Vec<[f64; MAX_ROW]> {
        let mut state = seed.wrapping_mul(2).wrapping_add(1);
        let mut random = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64 * 2.0 - 1.0
        };
        (0..n)
            .map(|_| {
                std::array::from_fn(|j| {
                    if j == 0 {
                        1.0
                    } else if j <= columns {
                        random()
                    } else {
                        0.0
                    }
                })
            })
            .collect()
    }

    fn by_svd(rows: &[[f64; MAX_ROW]], prefix: usize, right: usize) -> (DVector<f64>, f64) {
        let a = DMatrix::from_fn(rows.len(), prefix, |i, j| rows[i][j]);
        let b = DVector::from_fn(rows.len(), |i, _| rows[i][right]);
        let m = a.clone().svd(true, true).solve(&b, 0.0).unwrap();
        let residual = (a * &m - b).norm_squared();
        (m, residual)
    }

    proptest! {
        #[test]
        fn every_prefix_is_a_least_squares_solution(
            columns in 1_usize..=16, count in 20_usize..60, seed in any::<u64>(), split in 0.0..1.0_f64,
        ) {
            let rows = rows(count, columns, seed);
            let mut first = ImpedanceFactor::new(columns);
            let mut second = ImpedanceFactor::new(columns);
            for (i, row) in rows.iter().enumerate() {
                let lanes = row.map(|entry| Lanes([entry, 2.0 * entry, 0.0, 0.0]));
                if (i as f64) < split * count as f64 { first.add(&lanes) } else { second.add(&lanes) }
            }
            first.merge(&mut second);
            let mut solution = ImpedanceSolution::new(columns);
            solution.solve(&first);
            for prefix in 1..=columns {
                let (expected, residual) = by_svd(&rows, prefix, columns);
                let found = solution.coefficients(prefix);
                for j in 0..prefix {
                    prop_assert!((found[j][0] - expected[j]).abs() < 1e-9, "{} {}", found[j][0], expected[j]);
                    prop_assert!((found[j][1] - expected[j]).abs() < 1e-9);
                    prop_assert!(found[j][2].abs() < f64::MIN_POSITIVE);
                }
                prop_assert!((solution.residual_squares(prefix)[0] - residual).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn a_column_without_information_gets_zero() {
        let mut factor = ImpedanceFactor::new(4);
        for i in 0..20 {
            let x = f64::from(i);
            let mut row = [Lanes::ZERO; MAX_ROW];
            row[..5].copy_from_slice(&[1.0, x, 0.0, x * x, 3.0 + 2.0 * x].map(Lanes::splat));
            factor.add(&row);
        }
        let mut solution = ImpedanceSolution::new(4);
        solution.solve(&factor);
        let found = solution.coefficients(4).map(|lanes| lanes[0]);
        for (found, expected) in found.iter().zip([3.0, 2.0, 0.0, 0.0]) {
            assert!((found - expected).abs() < 1e-12, "{found} is not {expected}");
        }
    }

    #[test]
    fn a_row_without_a_column_still_counts_in_the_others() {
        // The second column is zero in the first rows, which arrive by a merge as in the sliding window.
        let mut early = ImpedanceFactor::new(3);
        let mut late = ImpedanceFactor::new(3);
        for (i, factor) in [0, 1, 2, 3].into_iter().zip([true, true, false, false]) {
            let t = f64::from(i);
            let mut row = [Lanes::ZERO; MAX_ROW];
            row[..4].copy_from_slice(&[1.0, (t - 1.0).max(0.0), t * t, (2.0 * t).cos()].map(Lanes::splat));
            if factor { early.add(&row) } else { late.add(&row) }
        }
        late.merge(&mut early);
        let mut solution = ImpedanceSolution::new(3);
        solution.solve(&late);
        let rows: Vec<[f64; MAX_ROW]> = (0..4)
            .map(|i| {
                let t = f64::from(i);
                let entries = [1.0, (t - 1.0).max(0.0), t * t, (2.0 * t).cos()];
                std::array::from_fn(|j| entries.get(j).copied().unwrap_or(0.0))
            })
            .collect();
        let (expected, residual) = by_svd(&rows, 3, 3);
        for (found, expected) in solution.coefficients(3).iter().zip(&expected) {
            assert!((found[0] - expected).abs() < 1e-12, "{} is not {expected}", found[0]);
        }
        assert!((solution.residual_squares(3)[0] - residual).abs() < 1e-12);
    }

    #[test]
    fn vanishing_entries_neither_overflow_nor_spoil_the_others() {
        for tiny in [1e-130, 1e-145, 1e-155, 1e-165, 1e-300] {
            let mut early = ImpedanceFactor::new(3);
            let mut late = ImpedanceFactor::new(3);
            for i in 0..8 {
                let t = f64::from(i);
                let mut row = [Lanes::ZERO; MAX_ROW];
                row[..4].copy_from_slice(&[1.0, tiny * (3.0 * t).sin(), t, 3.0 + 2.0 * t].map(Lanes::splat));
                if i < 4 { early.add(&row) } else { late.add(&row) }
            }
            late.merge(&mut early);
            let mut solution = ImpedanceSolution::new(3);
            solution.solve(&late);
            let found = solution.coefficients(3).map(|lanes| lanes[0]);
            assert!((found[0] - 3.0).abs() < 1e-12 && (found[2] - 2.0).abs() < 1e-12, "{tiny:e}: {found:?}");
        }
    }
}
