//! Normal equations of all axes at once: sums of products with forgetting, their factor, and its nested solutions.
//!
//! Upper triangles are packed by columns. These loops take most of a tick, so they run in the widest vectors of the
//! computer.

#![expect(clippy::inline_always, reason = "they must be inlined into the function that is compiled for wider vectors")]

use super::factor::column_start;
use crate::signal::{Lanes, NOTHING, SimdLoop, SimdVector, widest};

/// The largest model (matched rendering), because all solvers share this fixed memory.
pub(super) const MAX: usize = 25;
/// A pivot below this fraction of its column's square is only rounding error, so the column is left out.
/// A few thousand roundings of f64, and far below the ridges, which bound the scaled condition to about 1e5.
const ROUNDING: f64 = 1e-12;
/// Columns that are factorised together, because their sums do not depend on each other.
const BLOCK: usize = 4;

/// `gram <- fade gram + weight row row^T`, `right <- fade right + weight row value`.
#[inline]
pub(super) fn accumulate(
    gram: &mut [Lanes],
    right: &mut [Lanes],
    row: &[Lanes],
    value: Lanes,
    weight: Lanes,
    fade: f64,
) {
    widest(Accumulate { gram, right, row, value, weight, fade: Lanes::splat(fade) });
}

struct Accumulate<'a> {
    gram: &'a mut [Lanes],
    right: &'a mut [Lanes],
    row: &'a [Lanes],
    value: Lanes,
    weight: Lanes,
    fade: Lanes,
}

impl SimdLoop for Accumulate<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: SimdVector>(self) {
        let fade = V::of(&self.fade);
        let weight = V::of(&self.weight);
        let value = V::of(&self.value);
        let mut rest = self.gram;
        for (j, right) in self.right.iter_mut().enumerate().take(self.row.len()) {
            let weighted = V::of(&self.row[j]).times(weight);
            *right = V::of(right).times(fade).plus(weighted.times(value)).lanes();
            let (column, later) = rest.split_at_mut(j + 1);
            for (sum, q) in column.iter_mut().zip(self.row) {
                *sum = V::of(sum).times(fade).plus(weighted.times(V::of(q))).lanes();
            }
            rest = later;
        }
    }
}

/// Returns `sum_j a_j b_j` over the shorter of the two.
#[inline]
pub(super) fn dot(a: &[Lanes], b: &[Lanes]) -> Lanes {
    widest(Dot { a, b })
}

struct Dot<'a> {
    a: &'a [Lanes],
    b: &'a [Lanes],
}

impl SimdLoop for Dot<'_> {
    type Output = Lanes;

    #[inline(always)]
    fn run<V: SimdVector>(self) -> Lanes {
        let none = V::of(&Lanes::ZERO);
        self.a.iter().zip(self.b).fold(none, |sum, (a, b)| sum.plus(V::of(a).times(V::of(b)))).lanes()
    }
}

/// Cholesky factor of sums with a ridge, and the transformed right-hand side.
#[derive(Clone, Debug)]
pub(super) struct NormalFactor {
    elements: [Lanes; MAX * (MAX + 1) / 2],
    inverse: [Lanes; MAX],
    right: [Lanes; MAX],
}

impl NormalFactor {
    pub(super) const fn new() -> Self {
        let none = [Lanes::ZERO; MAX];
        Self { elements: [Lanes::ZERO; MAX * (MAX + 1) / 2], inverse: none, right: none }
    }

    /// Factorises the sums of `right.len()` columns with `ridge` added to their diagonal. Sums that have decayed to
    /// almost zero are set to zero.
    pub(super) fn renew(&mut self, gram: &mut [Lanes], right: &mut [Lanes], ridge: &[Lanes]) {
        // Subnormal numbers would make every later product slow.
        gram.iter_mut().chain(&mut *right).for_each(|sum| *sum = sum.settled());
        widest(Renew { factor: self, gram, right, ridge });
    }

    /// Solves for the leading columns, as many as `found` has.
    #[inline]
    pub(super) fn solve(&self, found: &mut [Lanes]) {
        widest(Solve { factor: self, found });
    }
}

struct Renew<'a> {
    factor: &'a mut NormalFactor,
    gram: &'a [Lanes],
    right: &'a [Lanes],
    ridge: &'a [Lanes],
}

impl SimdLoop for Renew<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: SimdVector>(self) {
        let none = V::of(&Lanes::ZERO);
        let columns = self.right.len();
        let mut first = 0;
        while first < columns {
            // Blocks of columns: the earlier rows are read once for four columns.
            let width = BLOCK.min(columns - first);
            // The entries of these columns, row by row, and the sums of products of every two of them.
            let mut rows = [[none; BLOCK]; MAX];
            let mut products = [[none; BLOCK]; BLOCK];
            let mut z = [none; BLOCK];
            for c in 0..width {
                let j = first + c;
                z[c] = V::of(&self.right[j]);
                for (row, sum) in rows.iter_mut().zip(&self.gram[column_start(j)..=column_start(j) + j]) {
                    row[c] = V::of(sum);
                }
            }
            for k in 0..first {
                let above = &self.factor.elements[column_start(k)..column_start(k) + k];
                let mut known = [none; BLOCK];
                for (a, row) in above.iter().zip(&rows) {
                    let a = V::of(a);
                    for c in 0..BLOCK {
                        known[c] = known[c].plus(a.times(row[c]));
                    }
                }
                // Inverses are stored, because a multiplication is cheaper than a division in every later row.
                let inverse = V::of(&self.factor.inverse[k]);
                let right = V::of(&self.factor.right[k]);
                let row = &mut rows[k];
                for c in 0..BLOCK {
                    row[c] = row[c].minus(known[c]).times(inverse);
                    z[c] = z[c].minus(row[c].times(right));
                }
                add_products(&mut products, row, 0);
            }
            for p in 0..width {
                let j = first + p;
                // The ridge enters at the pivot only, so the stored sums stay free of it.
                let own = rows[j][p].plus(V::of(&self.ridge[j]));
                let inverse = inverse_root(own.minus(products[p][p]).lanes(), own.lanes());
                let scale = V::of(&inverse);
                let right = z[p].times(scale);
                // The remaining columns of this block are finished here, because they depend on this pivot.
                for c in p + 1..BLOCK {
                    rows[j][c] = rows[j][c].minus(products[p][c]).times(scale);
                    z[c] = z[c].minus(rows[j][c].times(right));
                }
                let row = rows[j];
                add_products(&mut products, &row, p + 1);
                self.factor.inverse[j] = inverse;
                self.factor.right[j] = right.lanes();
                let column = &mut self.factor.elements[column_start(j)..column_start(j) + j];
                column.iter_mut().zip(&rows).for_each(|(element, row)| *element = row[p].lanes());
            }
            first += width;
        }
    }
}

/// Adds the products of each two of a row's columns, from `from` on.
#[inline(always)]
fn add_products<V: SimdVector>(products: &mut [[V; BLOCK]; BLOCK], row: &[V; BLOCK], from: usize) {
    for p in from..BLOCK {
        for c in p..BLOCK {
            products[p][c] = products[p][c].plus(row[p].times(row[c]));
        }
    }
}

/// Returns `1 / sqrt(pivot)`; 0 if the pivot is rounding.
#[inline(always)]
fn inverse_root(pivot: Lanes, own: Lanes) -> Lanes {
    // A zero leaves the column out: its coefficient becomes zero instead of a quotient of roundings.
    pivot.zip(own, |pivot, own| if pivot > NOTHING.max(ROUNDING * own) { 1.0 / pivot.sqrt() } else { 0.0 })
}

struct Solve<'a> {
    factor: &'a NormalFactor,
    found: &'a mut [Lanes],
}

impl SimdLoop for Solve<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: SimdVector>(self) {
        let Self { factor, found } = self;
        let columns = found.len();
        found.copy_from_slice(&factor.right[..columns]);
        for j in (0..columns).rev() {
            let value = V::of(&found[j]).times(V::of(&factor.inverse[j]));
            found[j] = value.lanes();
            let start = column_start(j);
            for (rest, element) in found.iter_mut().zip(&factor.elements[start..start + j]) {
                *rest = V::of(rest).minus(value.times(V::of(element))).lanes();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};
    use wide::f64x4;

    use super::*;

    /// Rows, forces and weights without a pattern, different in each lane.
    fn number(k: usize) -> Lanes {
        Lanes(std::array::from_fn(|lane| ((k * 37 + lane * 11 + 5) as f64 * 0.618_034).fract() * 2.0 - 1.0))
    }

    fn sums(columns: usize) -> (Vec<Lanes>, Vec<Lanes>) {
        let mut gram = vec![Lanes::ZERO; column_start(columns)];
        let mut right = vec![Lanes::ZERO; columns];
        for k in 0..60 {
            let row: Vec<Lanes> = (0..columns).map(|j| number(k * 31 + j)).collect();
            accumulate(&mut gram, &mut right, &row, number(k + 7), number(k + 3).map(|w| w.abs() + 0.1), 0.97);
        }
        (gram, right)
    }

    #[test]
    fn every_nested_solution_is_that_of_a_general_solver() {
        for columns in [1, 2, 3, 4, 5, 8, 11, 13, 16, 22, MAX] {
            let (mut gram, mut right) = sums(columns);
            let ridge: Vec<Lanes> = (0..columns).map(|j| number(j).map(|r| 0.01 * r.abs())).collect();
            let mut factor = NormalFactor::new();
            factor.renew(&mut gram, &mut right, &ridge);
            for nested in 1..=columns {
                let mut found = vec![Lanes::ZERO; nested];
                factor.solve(&mut found);
                for lane in 0..3 {
                    let entry = |i: usize, j: usize| {
                        gram[column_start(i.max(j)) + i.min(j)][lane] + if i == j { ridge[j][lane] } else { 0.0 }
                    };
                    let a = DMatrix::from_fn(nested, nested, entry);
                    let expected = a.lu().solve(&DVector::from_fn(nested, |j, _| right[j][lane])).unwrap();
                    for (found, expected) in found.iter().zip(&expected) {
                        let error = (found[lane] - expected).abs();
                        assert!(error < 1e-9 * expected.abs().max(1.0), "{columns} columns, {nested} of them: {error}");
                    }
                }
            }
        }
    }

    #[test]
    fn wider_vectors_give_the_same_bits() {
        for columns in [3, 13, 22, MAX] {
            let (gram, mut right) = sums(columns);
            let mut narrow_gram = vec![Lanes::ZERO; gram.len()];
            let mut narrow_right = vec![Lanes::ZERO; columns];
            for k in 0..60 {
                let row: Vec<Lanes> = (0..columns).map(|j| number(k * 31 + j)).collect();
                let weight = number(k + 3).map(|w| w.abs() + 0.1);
                let gram = &mut narrow_gram[..];
                let right = &mut narrow_right[..];
                let fade = Lanes::splat(0.97);
                Accumulate { gram, right, row: &row, value: number(k + 7), weight, fade }.run::<f64x4>();
            }
            assert_eq!((&gram, &right), (&narrow_gram, &narrow_right));

            let ridge = vec![Lanes::splat(0.01); columns];
            let mut wide = NormalFactor::new();
            let mut narrow = NormalFactor::new();
            wide.renew(&mut gram.clone(), &mut right, &ridge);
            Renew { factor: &mut narrow, gram: &gram, right: &right, ridge: &ridge }.run::<f64x4>();
            let [mut by_wide, mut by_narrow] = [vec![Lanes::ZERO; columns], vec![Lanes::ZERO; columns]];
            wide.solve(&mut by_wide);
            Solve { factor: &narrow, found: &mut by_narrow }.run::<f64x4>();
            assert_eq!(by_wide, by_narrow);
        }
    }

    #[test]
    fn a_column_that_others_tell_already_is_left_out() {
        let mut gram = vec![Lanes::ZERO; column_start(3)];
        let mut right = vec![Lanes::ZERO; 3];
        for k in 0..20 {
            let a = number(k);
            let b = number(k + 50);
            let row = [a, b, a + b * 2.0];
            accumulate(&mut gram, &mut right, &row, a * 3.0 - b, Lanes::splat(1.0), 1.0);
        }
        let mut factor = NormalFactor::new();
        factor.renew(&mut gram, &mut right, &[Lanes::ZERO; 3]);
        let mut found = [Lanes::ZERO; 3];
        factor.solve(&mut found);
        for (found, expected) in found.iter().zip([3.0, -1.0, 0.0]) {
            assert!(found.0.iter().all(|found| (found - expected).abs() < 1e-9), "{found:?} is not {expected}");
        }
    }
}
