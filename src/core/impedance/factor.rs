//! The triangular factor of a least-squares problem, built by orthogonal operations only.

use super::{features::MOTION_COLUMNS, window::WindowSummary};
use crate::signal::Lanes;

/// Maximum number of unknowns: a constant and the motion columns.
pub(super) const MAX_COLUMNS: usize = 1 + MOTION_COLUMNS;
/// Entries of a row: the columns, then the right-hand side.
pub(super) const MAX_ROW: usize = MAX_COLUMNS + 1;
/// Number of columns reflected together in a merge: four chains of additions in flight (2: 10 % slower; 6: registers
/// spill, twice as slow).
const WIDTH: usize = 4;
const MAX_ELEMENTS: usize = MAX_ROW * (MAX_ROW + 1) / 2;

/// Returns the start of column `j` in a packed upper triangle (column `j` holds rows `0..=j`).
pub(super) const fn column_start(j: usize) -> usize {
    j * (j + 1) / 2
}

/// `R` of `[A b] = Q R` for the rows of `A` and right-hand side `b` added so far, one problem per lane.
///
/// Upper triangle packed by columns; the right-hand side is the last column, and its diagonal entry is the norm of the
/// residual. A row is added by plane rotations; two factors are merged by Householder reflections of one stacked on the
/// other. Both are backward stable and nothing is ever subtracted, so errors do not accumulate beyond the error of one
/// solve. Diagonal entries may have either sign. Squares of entries must neither overflow nor all underflow: entries
/// between 1e-150 and 1e150 (the identifier ensures this).
#[derive(Clone, Debug)]
pub struct ImpedanceFactor {
    columns: usize,
    elements: [Lanes; MAX_ELEMENTS],
}

impl ImpedanceFactor {
    /// Creates the factor of no rows, for `columns <= 16` unknowns.
    pub fn new(columns: usize) -> Self {
        Self { columns: columns.min(MAX_COLUMNS), elements: [Lanes::ZERO; MAX_ELEMENTS] }
    }

    /// Creates a factor that pulls every unknown but the first (the constant) towards zero: `sqrt(weight)` on the
    /// diagonal, i.e. `weight * |M|^2` is added to the sum of squares.
    pub fn with_ridge(columns: usize, weight: f64) -> Self {
        let mut factor = Self::new(columns);
        // The constant stays free: pulling it towards zero would bias the force itself.
        for j in 1..factor.columns {
            factor.elements[column_start(j) + j] = Lanes::splat(weight.sqrt());
        }
        factor
    }

    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Returns column `j` (rows `0..=j`); `j == columns()` is the right-hand side.
    #[inline]
    pub fn column(&self, j: usize) -> &[Lanes] {
        &self.elements[column_start(j)..=column_start(j) + j]
    }
}

impl WindowSummary for ImpedanceFactor {
    /// `columns` entries, then the right-hand side at index `columns`; further entries are ignored. A row of zeros
    /// changes nothing.
    type Row = [Lanes; MAX_ROW];

    const BLANK_ROW: Self::Row = [Lanes::ZERO; MAX_ROW];

    fn add(&mut self, row: &Self::Row) {
        add_rows([self], [row]);
    }

    // Three at a time, because a sliding window adds each row to three summaries.
    fn add_three(targets: [&mut Self; 3], rows: [&Self::Row; 3]) {
        add_rows(targets, rows);
    }

    fn merge(&mut self, other: &mut Self) {
        let n = self.columns;
        let below = &mut other.elements;
        for k in 0..=n {
            let start = column_start(k);
            let (v, mut rest) = below[start..].split_at_mut(k + 1);
            let squares = v.iter().fold(Lanes::ZERO, |sum, v| sum + *v * *v);
            let a = self.elements[start + k];
            let norm = norm_of(a * a + squares);
            // u = (a + sign(a) norm, v); the reflection I - tau u u' maps (a, v) to (-sign(a) norm, 0). With the sign
            // of `a` the sum below cannot cancel, so the reflection stays orthogonal.
            let signed_norm = norm.zip(a, f64::copysign);
            let head = a + signed_norm;
            let tau = (signed_norm * head).recip_or_zero();
            self.elements[start + k] = -signed_norm;
            let mut j = k + 1;
            while j + WIDTH <= n + 1 {
                rest = reflect_columns::<WIDTH>(&mut self.elements, rest, v, (j, k), head, tau);
                j += WIDTH;
            }
            while j <= n {
                rest = reflect_columns::<1>(&mut self.elements, rest, v, (j, k), head, tau);
                j += 1;
            }
        }
    }
}

/// Returns the root of a sum of squares; zero below 1e-280, where squares lose digits, reflections would no longer be
/// orthogonal and the reciprocal of a square overflows.
/// The square of 1e-140 N is far below any sensor's noise, so nothing measurable is lost.
#[inline]
fn norm_of(squares: Lanes) -> Lanes {
    squares.map(|squares| if squares < 1e-280 { 0.0 } else { squares }).sqrt()
}

/// Adds one row to each of several factors of the same size, column by column: while the square root and the division
/// of one rotation are pending, the others proceed.
#[inline]
fn add_rows<const COUNT: usize>(mut targets: [&mut ImpedanceFactor; COUNT], rows: [&[Lanes; MAX_ROW]; COUNT]) {
    let n = targets.iter().map(|target| target.columns).min().unwrap_or(0);
    let mut rotations = [[(Lanes::ZERO, Lanes::ZERO); MAX_ROW]; COUNT];
    for j in 0..=n {
        let start = column_start(j);
        for ((target, row), rotations) in targets.iter_mut().zip(rows).zip(&mut rotations) {
            let column = &mut target.elements[start..=start + j];
            let mut entry = row[j];
            for (element, (cosine, sine)) in column.iter_mut().zip(&*rotations).take(j) {
                let above = *element;
                *element = *cosine * above + *sine * entry;
                entry = *cosine * entry - *sine * above;
            }
            let diagonal = column[j];
            let norm = norm_of(diagonal * diagonal + entry * entry);
            let inverse = norm.recip_or_zero();
            // Nothing to rotate: pass the row to the next column unchanged.
            // Without a cosine of 1 the row would vanish instead of passing on.
            let cosine = (diagonal * inverse).zip(norm, |cosine, norm| if norm == 0.0 { 1.0 } else { cosine });
            rotations[j] = (cosine, entry * inverse);
            // The diagonal is now positive, whatever its sign was before.
            column[j] = norm;
        }
    }
}

/// Applies a reflection to row `k` of the columns `j..j + COUNT` of `above` and to those of `below` (the rest of its
/// packed columns, from column `j` on); returns the remainder of `below`.
#[inline]
fn reflect_columns<'a, const COUNT: usize>(
    above: &mut [Lanes; MAX_ELEMENTS],
    mut below: &'a mut [Lanes],
    v: &[Lanes],
    (j, k): (usize, usize),
    head: Lanes,
    tau: Lanes,
) -> &'a mut [Lanes] {
    let columns: [&mut [Lanes]; COUNT] = std::array::from_fn(|i| {
        let (column, rest) = std::mem::take(&mut below).split_at_mut(j + i + 1);
        below = rest;
        column
    });
    let at: [usize; COUNT] = std::array::from_fn(|i| column_start(j + i) + k);
    let mut top = at.map(|at| above[at]);
    reflect(&mut top, columns, v, head, tau);
    for (at, top) in at.into_iter().zip(top) {
        above[at] = top;
    }
    below
}

/// Reflects `COUNT` columns `(top, column[..v.len()])` by `I - tau (head, v) (head, v)'`.
#[inline]
fn reflect<const COUNT: usize>(
    top: &mut [Lanes; COUNT],
    columns: [&mut [Lanes]; COUNT],
    v: &[Lanes],
    head: Lanes,
    tau: Lanes,
) {
    let mut columns = columns.map(|column| &mut column[..v.len()]);
    let mut weight = top.map(|top| head * top);
    for (i, v) in v.iter().enumerate() {
        for (weight, column) in weight.iter_mut().zip(&columns) {
            *weight += column[i] * *v;
        }
    }
    for (weight, top) in weight.iter_mut().zip(top) {
        *weight *= tau;
        *top -= *weight * head;
    }
    for (i, v) in v.iter().enumerate() {
        for (weight, column) in weight.iter().zip(columns.each_mut()) {
            column[i] -= *weight * *v;
        }
    }
}
