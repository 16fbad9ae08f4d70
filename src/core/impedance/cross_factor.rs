//! The triangular factor with cross-talk: every axis' force from the motion of all axes.

use super::{AXES, MAX_DEGREE, features::MOTION_COLUMNS, window::Summary};
use crate::signal::{LANES, Lanes};

/// A constant and the motion columns of all axes.
const COLUMNS: usize = 1 + AXES * MOTION_COLUMNS;
/// Groups of four columns; then the forces of all axes as one group.
const GROUPS: usize = COLUMNS.div_ceil(LANES);
const FORCES: usize = GROUPS;
/// Groups reflected side by side in a merge.
const SIDE: usize = 3;

/// Place of row `k`'s first group, that of its diagonal entry.
const fn row_start(k: usize) -> usize {
    // Rows 4 g .. 4 g + 3 hold the groups g ..= FORCES.
    let (group, rest) = (k / LANES, k % LANES);
    LANES * (group * (FORCES + 1) - group * group.saturating_sub(1) / 2) + rest * (FORCES + 1 - group)
}

const ELEMENTS: usize = row_start(COLUMNS);

/// `R` of `[A F] = Q R` for rows of a constant, the features of all axes (`1 + 3 c + axis` for motion column `c`) and the
/// forces of all axes; packed by rows in groups of four columns. The same mathematics as [`Factor`](super::Factor), once
/// instead of once per axis.
#[derive(Clone, Debug)]
pub(super) struct CrossFactor {
    columns: usize,
    elements: [Lanes; ELEMENTS],
}

/// One row: twelve groups of columns, then the forces.
pub(super) type CrossRow = [Lanes; FORCES + 1];

/// `M` of one degree: for every motion column and axis of motion, the force on every axis (N per scaled feature).
pub(super) type CrossModel = [[Lanes; AXES]; MOTION_COLUMNS];

/// A row of the features and forces of all axes.
pub(super) fn cross_row(features: &[Lanes; MOTION_COLUMNS], force_n: Lanes) -> CrossRow {
    let mut row = CrossFactor::BLANK_ROW;
    row[0][0] = 1.0;
    for (column, feature) in features.iter().enumerate() {
        for axis in 0..AXES {
            let at = 1 + AXES * column + axis;
            row[at / LANES][at % LANES] = feature[axis];
        }
    }
    row[FORCES] = force_n;
    row
}

impl CrossFactor {
    /// The factor of no rows for degrees up to `max_degree`, with `weight |M|^2` added to the sum of squares.
    pub(super) fn new(max_degree: usize, weight: f64) -> Self {
        let columns = 1 + 3 * AXES * max_degree.min(MAX_DEGREE);
        let mut factor = Self { columns, elements: [Lanes::ZERO; ELEMENTS] };
        for k in 1..columns {
            factor.elements[row_start(k)][k % LANES] = weight.sqrt();
        }
        factor
    }

    #[inline]
    fn entry(&self, k: usize, j: usize) -> f64 {
        self.elements[row_start(k) + j / LANES - k / LANES][j % LANES]
    }

    /// The least-squares solution of `degree`.
    pub(super) fn solve(&self, degree: usize) -> CrossModel {
        let columns = (1 + 3 * AXES * degree).min(self.columns);
        let mut m = [Lanes::ZERO; COLUMNS];
        for (k, m) in m.iter_mut().enumerate().take(columns) {
            *m = self.elements[row_start(k) + FORCES - k / LANES];
        }
        for j in (0..columns).rev() {
            let value = m[j] * Lanes::splat(self.entry(j, j)).recip_or_zero();
            m[j] = value;
            for (k, m) in m.iter_mut().enumerate().take(j) {
                *m -= value * self.entry(k, j);
            }
        }
        std::array::from_fn(|column| std::array::from_fn(|axis| m[1 + AXES * column + axis]))
    }
}

impl Summary for CrossFactor {
    type Row = CrossRow;

    const BLANK_ROW: Self::Row = [Lanes::ZERO; FORCES + 1];

    fn add(&mut self, row: &Self::Row) {
        let mut row = *row;
        for k in 0..self.columns {
            let group = k / LANES;
            let entry = row[group][k % LANES];
            if entry == 0.0 {
                continue;
            }
            let own = &mut self.elements[row_start(k)..row_start(k + 1)];
            let diagonal = own[0][k % LANES];
            let norm = (diagonal * diagonal + entry * entry).sqrt();
            if norm < f64::MIN_POSITIVE {
                continue;
            }
            let (cosine, sine) = (diagonal / norm, entry / norm);
            for (own, row) in own.iter_mut().zip(&mut row[group..]) {
                let above = *own;
                *own = above * cosine + *row * sine;
                *row = *row * cosine - above * sine;
            }
            row[group][k % LANES] = 0.0;
        }
    }

    fn merge(&mut self, other: &mut Self) {
        for k in 0..self.columns {
            let (group, lane) = (k / LANES, k % LANES);
            let mut v = [0.0; COLUMNS];
            for (i, v) in v.iter_mut().enumerate().take(k + 1) {
                let at = row_start(i) + group - i / LANES;
                *v = std::mem::take(&mut other.elements[at][lane]);
            }
            let v = &v[..=k];
            let squares: f64 = v.iter().map(|v| v * v).sum();
            let own = &mut self.elements[row_start(k)..row_start(k + 1)];
            let a = std::mem::take(&mut own[0][lane]);
            let norm = (a * a + squares).sqrt().copysign(a);
            if squares < f64::MIN_POSITIVE {
                own[0][lane] = a;
                continue;
            }
            let head = a + norm;
            let tau = 1.0 / (norm * head);
            let mut done = 0;
            while done + SIDE <= own.len() {
                reflect::<SIDE>(&mut own[done..], &mut other.elements, group + done, v, head, tau);
                done += SIDE;
            }
            while done < own.len() {
                reflect::<1>(&mut own[done..], &mut other.elements, group + done, v, head, tau);
                done += 1;
            }
            own[0][lane] = -norm;
        }
    }
}

/// Reflects `COUNT` groups, from group `first` on, of one row above and of the rows `0..v.len()` below.
#[inline]
fn reflect<const COUNT: usize>(
    above: &mut [Lanes],
    below: &mut [Lanes; ELEMENTS],
    first: usize,
    v: &[f64],
    head: f64,
    tau: f64,
) {
    let mut weight: [Lanes; COUNT] = std::array::from_fn(|i| above[i] * head);
    for (row, v) in v.iter().enumerate() {
        let at = row_start(row) + first - row / LANES;
        for (weight, below) in weight.iter_mut().zip(&below[at..at + COUNT]) {
            *weight += *below * *v;
        }
    }
    for (weight, above) in weight.iter_mut().zip(above) {
        *weight = *weight * tau;
        *above -= *weight * head;
    }
    for (row, v) in v.iter().enumerate() {
        let at = row_start(row) + first - row / LANES;
        for (weight, below) in weight.iter().zip(&mut below[at..at + COUNT]) {
            *below -= *weight * *v;
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;

    #[test]
    fn every_degree_is_a_least_squares_solution_with_ridge() {
        let mut state = 7_u64;
        let mut random = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64 * 2.0 - 1.0
        };
        for max_degree in [1, 3, 5] {
            let count = 120;
            let rows: Vec<CrossRow> = (0..count)
                .map(|_| {
                    let features = std::array::from_fn(|column| {
                        if column < 3 * max_degree { Lanes([random(), random(), random(), 0.0]) } else { Lanes::ZERO }
                    });
                    cross_row(&features, Lanes([random(), random(), random(), 0.0]))
                })
                .collect();
            let (mut first, mut second) = (CrossFactor::new(max_degree, 0.3), CrossFactor::new(max_degree, 0.0));
            for (i, row) in rows.iter().enumerate() {
                if i % 3 == 0 { first.add(row) } else { second.add(row) }
            }
            first.merge(&mut second);
            for degree in 1..=max_degree {
                let columns = 1 + 9 * degree;
                let mut a = DMatrix::zeros(count + columns, columns);
                let mut f = DMatrix::zeros(count + columns, 3);
                for (i, row) in rows.iter().enumerate() {
                    (0..columns).for_each(|j| a[(i, j)] = row[j / 4][j % 4]);
                    (0..3).for_each(|axis| f[(i, axis)] = row[FORCES][axis]);
                }
                (1..columns).for_each(|j| a[(count + j, j)] = 0.3_f64.sqrt());
                let expected = a.svd(true, true).solve(&f, 0.0).unwrap();
                let found = first.solve(degree);
                for j in 0..columns - 1 {
                    for axis in 0..3 {
                        let (found, expected) = (found[j / 3][j % 3][axis], expected[(j + 1, axis)]);
                        assert!((found - expected).abs() < 1e-11, "degree {degree}: {found} is not {expected}");
                    }
                }
            }
        }
    }
}
