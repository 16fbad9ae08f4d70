//! Determines whether the directions of the pushes define a rotation.

use nalgebra::{Matrix3, Vector3};
use serde::Serialize;

use super::solver::PushRow;

/// Distribution of the pushes over directions. Ratios are root mean squares along the principal axes of the push
/// directions (unit vectors, so that strength does not matter); each is the smallest over both sensors and over all
/// subsets without one fold of the pushes, so that no direction depends on a single push.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct CorrespondenceExcitation {
    /// Second axis relative to the first: near zero if all pushes are along one line.
    pub second: f64,
    /// Third axis relative to the first: near zero if all pushes are in one plane.
    pub third: f64,
    /// Root mean square force along the weakest axis of the forces, N.
    pub weakest_n: f64,
    /// Number of axes with a spread of at least the limit: 1 a line, 2 a plane, 3 good.
    pub rank: usize,
}

impl CorrespondenceExcitation {
    /// Computes the excitation of these rows; `folds` are the ranges of rows to leave out in turn.
    pub(super) fn of(rows: &[PushRow], folds: &[std::ops::Range<usize>], min_spread: f64) -> Self {
        if rows.is_empty() {
            return Self::default();
        }
        let mut found = Self { second: 1.0, third: 1.0, weakest_n: f64::INFINITY, rank: 0 };
        // Both sensors: a chain that turns the pushes differently would be seen in one of them only.
        for force in [|row: &PushRow| row.c_n, |row: &PushRow| row.s2_n] {
            let directions = Scatter::of(rows, |row| force(row).try_normalize(1e-9).unwrap_or_default());
            let forces = Scatter::of(rows, force);
            found.note(&directions.without(&[]));
            found.weakest_n = found.weakest_n.min(forces.without(&[])[2]);
            // A fold with all rows would leave nothing to measure.
            for fold in folds.iter().filter(|fold| fold.len() < rows.len()) {
                found.note(&directions.without(&directions.vectors[fold.clone()]));
            }
        }
        found.rank = 1 + usize::from(found.second >= min_spread) + usize::from(found.third >= min_spread);
        found
    }

    fn note(&mut self, axes: &[f64; 3]) {
        // Without any length all ratios are unknown: the safe value is zero.
        if axes[0] > 0.0 {
            self.second = self.second.min(axes[1] / axes[0]);
            self.third = self.third.min(axes[2] / axes[0]);
        } else {
            self.second = 0.0;
            self.third = 0.0;
        }
    }
}

/// Vectors and the sum of their outer products.
struct Scatter {
    vectors: Vec<Vector3<f64>>,
    sum: Matrix3<f64>,
}

impl Scatter {
    fn of(rows: &[PushRow], vector: impl Fn(&PushRow) -> Vector3<f64>) -> Self {
        let vectors: Vec<_> = rows.iter().map(vector).collect();
        let sum = vectors.iter().map(|v| v * v.transpose()).sum();
        Self { vectors, sum }
    }

    /// Returns the root mean squares along the principal axes, largest first, with these vectors left out.
    fn without(&self, left_out: &[Vector3<f64>]) -> [f64; 3] {
        let sum = self.sum - left_out.iter().map(|v| v * v.transpose()).sum::<Matrix3<f64>>();
        let count = (self.vectors.len() - left_out.len()).max(1) as f64;
        // Rounding can make an eigenvalue of a plane slightly negative.
        let mut axes: [f64; 3] = sum.symmetric_eigenvalues().map(|square| (square.max(0.0) / count).sqrt()).into();
        axes.sort_by(|a, b| b.total_cmp(a));
        axes
    }
}
