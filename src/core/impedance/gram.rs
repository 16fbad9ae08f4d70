//! Sums of products of a window's rows: the paper's `X X^T` and `F X^T`.

use super::{
    factor::column_start,
    features::{ImpedanceFeatures, MOTION_COLUMNS},
    window::WindowSummary,
};
use crate::signal::Lanes;

/// Maximum number of entries of a row: a constant, the motion columns, the force.
pub(super) const GRAM_ROW: usize = MOTION_COLUMNS + 2;
const ELEMENTS: usize = GRAM_ROW * (GRAM_ROW + 1) / 2;

/// `[X; f] [X; f]^T`, one per lane: the upper triangle packed by columns, the force in the last one.
///
/// The window updates it in blocks of sums without subtraction, so it does not drift.
#[derive(Clone, Debug)]
pub struct Gram {
    columns: usize,
    /// 1 in the lanes in use if the first column is a constant.
    constant: Option<Lanes>,
    elements: [Lanes; ELEMENTS],
}

impl Gram {
    /// Creates the sums of no rows, for `columns <= 15` motion columns.
    pub fn new(columns: usize) -> Self {
        Self { columns: columns.min(MOTION_COLUMNS), constant: None, elements: [Lanes::ZERO; ELEMENTS] }
    }

    /// Creates the sums with a constant before the motion columns, `one` in the lanes in use.
    pub fn with_constant(columns: usize, one: Lanes) -> Self {
        Self { columns: columns.min(MOTION_COLUMNS) + 1, constant: Some(one), ..Self::new(0) }
    }

    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Returns the number of columns before the motion columns: 1 with a constant, 0 without.
    pub fn constants(&self) -> usize {
        usize::from(self.constant.is_some())
    }

    /// Returns column `j` (rows `0..=j`); `j == columns()` is the force.
    #[inline]
    pub fn column(&self, j: usize) -> &[Lanes] {
        &self.elements[column_start(j)..=column_start(j) + j]
    }

    /// Returns a row for [`WindowSummary::add`].
    #[inline]
    pub(super) fn row(&self, features: &ImpedanceFeatures, force_n: Lanes) -> [Lanes; GRAM_ROW] {
        let mut row = [Lanes::ZERO; GRAM_ROW];
        let first = self.constants();
        row[0] = self.constant.unwrap_or(Lanes::ZERO);
        row[first..self.columns].copy_from_slice(&features[..self.columns - first]);
        row[self.columns] = force_n;
        row
    }
}

impl WindowSummary for Gram {
    /// `columns` columns, then the force at index `columns`; further entries are ignored.
    type Row = [Lanes; GRAM_ROW];

    const BLANK_ROW: Self::Row = [Lanes::ZERO; GRAM_ROW];

    fn add(&mut self, row: &Self::Row) {
        for j in 0..=self.columns {
            let start = column_start(j);
            // Only the upper triangle: the sums are symmetric.
            for (element, entry) in self.elements[start..=start + j].iter_mut().zip(row) {
                *element += *entry * row[j];
            }
        }
    }

    fn merge(&mut self, other: &mut Self) {
        // The unused end of the array stays zero, so it is not added.
        let used = column_start(self.columns + 1);
        for (element, other) in self.elements[..used].iter_mut().zip(&other.elements) {
            *element += *other;
        }
    }
}
