//! The triangular factor of a least-squares problem, built by orthogonal operations only.

use super::{features::MOTION_COLUMNS, window::Summary};
use crate::signal::Lanes;

/// Unknowns of the largest problem: a constant and the motion columns.
pub(super) const MAX_COLUMNS: usize = 1 + MOTION_COLUMNS;
/// Entries of a row: the columns, then the right-hand side.
pub(super) const MAX_ROW: usize = MAX_COLUMNS + 1;
const MAX_ELEMENTS: usize = MAX_ROW * (MAX_ROW + 1) / 2;

/// Start of column `j` in a packed upper triangle (column `j` holds rows `0..=j`).
pub(super) const fn column_start(j: usize) -> usize {
    j * (j + 1) / 2
}

/// `R` of `[A b] = Q R` for the rows of `A` and right-hand side `b` taken in so far, one problem per lane.
///
/// Upper triangle packed by columns; the right-hand side is the last column, and its diagonal entry is the norm of the
/// residual. A row is taken in by plane rotations; two factors are merged by Householder reflections of one stacked on the
/// other. Both are backward stable and nothing is ever subtracted, so no error accumulates beyond that of one solve.
/// Diagonal entries may have either sign. Squares of entries must neither overflow nor all underflow: entries between
/// 1e-150 and 1e150 (the identifier sees to it).
#[derive(Clone, Debug)]
pub struct Factor {
    columns: usize,
    elements: [Lanes; MAX_ELEMENTS],
}

impl Factor {
    /// The factor of no rows, for `columns <= 16` unknowns.
    pub fn new(columns: usize) -> Self {
        Self { columns: columns.min(MAX_COLUMNS), elements: [Lanes::ZERO; MAX_ELEMENTS] }
    }

    /// The factor that pulls every unknown but the first (the constant) towards zero: `sqrt(weight)` on the diagonal, i.e.
    /// `weight * |M|^2` is added to the sum of squares.
    pub fn with_ridge(columns: usize, weight: f64) -> Self {
        let mut factor = Self::new(columns);
        for j in 1..factor.columns {
            factor.elements[column_start(j) + j] = Lanes::splat(weight.sqrt());
        }
        factor
    }

    /// Number of unknowns.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Column `j` (rows `0..=j`); `j == columns()` is the right-hand side.
    #[inline]
    pub fn column(&self, j: usize) -> &[Lanes] {
        &self.elements[column_start(j)..=column_start(j) + j]
    }
}

impl Summary for Factor {
    /// `columns` entries, then the right-hand side at index `columns`; the rest is ignored. A row of zeros changes nothing.
    type Row = [Lanes; MAX_ROW];

    const BLANK_ROW: Self::Row = [Lanes::ZERO; MAX_ROW];

    fn add(&mut self, row: &Self::Row) {
        let n = self.columns;
        let mut cosine = [Lanes::ZERO; MAX_ROW];
        let mut sine = [Lanes::ZERO; MAX_ROW];
        for j in 0..=n {
            let start = column_start(j);
            let column = &mut self.elements[start..=start + j];
            let mut entry = row[j];
            for ((element, c), s) in column.iter_mut().zip(&cosine).zip(&sine).take(j) {
                let above = *element;
                *element = *c * above + *s * entry;
                entry = *c * entry - *s * above;
            }
            let diagonal = column[j];
            let norm = (diagonal * diagonal + entry * entry).sqrt();
            let inverse = norm.recip_or_zero();
            cosine[j] = diagonal * inverse;
            sine[j] = entry * inverse;
            column[j] = norm;
        }
    }

    fn merge(&mut self, other: &Self) {
        let n = self.columns;
        let mut below = other.elements;
        for k in 0..=n {
            let start = column_start(k);
            let mut v = [Lanes::ZERO; MAX_ROW];
            v[..=k].copy_from_slice(&below[start..=start + k]);
            let v = &v[..=k];
            let squares = v.iter().fold(Lanes::ZERO, |sum, v| sum + *v * *v);
            let a = self.elements[start + k];
            let norm = (a * a + squares).sqrt();
            // u = (a + sign(a) norm, v); the reflection I - tau u u' takes (a, v) to (-sign(a) norm, 0).
            let signed_norm = norm.zip(a, f64::copysign);
            let head = a + signed_norm;
            let tau = (signed_norm * head).recip_or_zero();
            self.elements[start + k] = -signed_norm;
            for j in k + 1..=n {
                let start = column_start(j);
                let column = &mut below[start..=start + k];
                let top = &mut self.elements[start + k];
                let dot = column.iter().zip(v).fold(head * *top, |sum, (b, v)| sum + *b * *v);
                let weight = dot * tau;
                *top -= weight * head;
                for (b, v) in column.iter_mut().zip(v) {
                    *b -= weight * *v;
                }
            }
        }
    }
}
