//! The rotation between two sets of vectors: Wahba's problem, solved robustly.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

use super::PushPair;

/// One push: the same force in `c` (from the wrist sensor and the chain) and in `s2`.
#[derive(Clone, Copy, Debug)]
pub(super) struct PushRow {
    /// Force of the wrist sensor, N (`c`).
    pub(super) c_n: Vector3<f64>,
    /// Force of the sensor under the tissue, N (`s2`).
    pub(super) s2_n: Vector3<f64>,
    /// Used for residuals in the wrist sensor's axes.
    pub(super) s1_from_c: UnitQuaternion<f64>,
}

impl PushRow {
    pub(super) fn of(pair: &PushPair, flip_s2: bool) -> Self {
        let sign = if flip_s2 { -1.0 } else { 1.0 };
        Self { c_n: pair.s1_from_c.inverse() * pair.f1_n, s2_n: pair.f2_n * sign, s1_from_c: pair.s1_from_c }
    }

    /// Returns the residual of this rotation, N (`c`).
    pub(super) fn residual_n(&self, c_from_s2: &Rotation3<f64>) -> Vector3<f64> {
        c_from_s2 * self.s2_n - self.c_n
    }

    /// Returns the residual in the wrist sensor's axes, N (`s1`).
    pub(super) fn residual_in_s1_n(&self, c_from_s2: &Rotation3<f64>) -> Vector3<f64> {
        self.s1_from_c * self.residual_n(c_from_s2)
    }
}

/// Returns the least-squares proper rotation: `U diag(1, 1, det U det V) V^T` of `sum c s2^T` (Markley, J. Astronaut.
/// Sci. 1988). The noise in N is equal for all forces, so a stronger push has more weight, as it should.
pub(super) fn wahba<'a>(rows: impl IntoIterator<Item = &'a PushRow>) -> Rotation3<f64> {
    let moment = rows.into_iter().fold(Matrix3::zeros(), |sum, row| sum + row.c_n * row.s2_n.transpose());
    let decomposed = moment.svd(true, true);
    // Not reached for finite sums; the identity fails every check that follows.
    let (Some(u), Some(v_t)) = (decomposed.u, decomposed.v_t) else { return Rotation3::identity() };
    let sign = (u.determinant() * v_t.determinant()).signum();
    Rotation3::from_matrix_unchecked(u * Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, sign)) * v_t)
}

/// Result of the robust estimation; the rotation is the result of [`wahba`] on the agreeing rows.
#[derive(Clone, Debug)]
pub(super) struct Consensus {
    pub(super) inlier: Vec<bool>,
    /// Median length of the residuals of all rows, N.
    pub(super) median_n: f64,
}

/// Number of random hypotheses: if a third are outliers, the probability that every hypothesis contains one is 1e-77.
const DRAWS: usize = 300;
/// Up to this number of rows all pairs are tried instead.
const EXHAUSTIVE: usize = 24;
/// Maximum number of rows by which a hypothesis is evaluated; more would only take time.
const JUDGES: usize = 400;
/// Median length of a 3-D normal vector with a standard deviation of 1 per axis: the root of the median 2.366 of
/// chi-squared with three degrees of freedom, so that the median error gives the standard deviation.
const MEDIAN_OF_LENGTH: f64 = 1.538;
/// A residual beyond this many standard deviations is an outlier; one in 900 good residuals is lost.
const CUT: f64 = 4.0;
/// Lower limit of the standard deviation, N: smaller differences of readings do not matter.
const FINEST_N: f64 = 0.01;
/// Two pushes closer to one line than this (sine of the angle) do not define a rotation: 14 degrees, because the
/// rotation about their common line would be determined by noise.
const MIN_SINE: f64 = 0.25;

/// Finds the rows that agree with the rotation of smallest median residual among hypotheses from two pushes each, and
/// refines them iteratively.
pub(super) fn consensus(rows: &[PushRow]) -> Consensus {
    let mut lengths = Vec::with_capacity(rows.len());
    // The hypotheses only start the refinement, so a coarse one is enough.
    let mut c_from_s2 = first_guess(rows, &mut lengths);
    let mut inlier = Vec::new();
    let mut median_n = 0.0;
    // The set of agreeing rows usually repeats after two or three rounds; the limit is for two sets that alternate.
    for _ in 0..10 {
        median_n = median_residual_n(rows, 1, &c_from_s2, &mut lengths);
        let cut_n = CUT * (median_n / MEDIAN_OF_LENGTH).max(FINEST_N);
        let agrees: Vec<bool> = rows.iter().map(|row| row.residual_n(&c_from_s2).norm() <= cut_n).collect();
        if agrees == inlier {
            break;
        }
        inlier = agrees;
        c_from_s2 = wahba(rows.iter().zip(&inlier).filter_map(|(row, &agrees)| agrees.then_some(row)));
    }
    Consensus { inlier, median_n }
}

fn first_guess(rows: &[PushRow], lengths: &mut Vec<f64>) -> Rotation3<f64> {
    let stride = rows.len().div_ceil(JUDGES).max(1);
    // The fit of all rows is a hypothesis too: it wins if nothing is wrong.
    let mut best = (f64::INFINITY, wahba(rows));
    let mut judge = |i: usize, j: usize| {
        let a = &rows[i];
        let b = &rows[j];
        if a.s2_n.cross(&b.s2_n).norm() < MIN_SINE * a.s2_n.norm() * b.s2_n.norm() {
            return;
        }
        let guess = wahba([a, b]);
        let median_n = median_residual_n(rows, stride, &guess, lengths);
        if median_n < best.0 {
            best = (median_n, guess);
        }
    };
    if rows.len() <= EXHAUSTIVE {
        (0..rows.len()).for_each(|i| (0..i).for_each(|j| judge(i, j)));
    } else {
        // A fixed seed: the same pushes always give the same result.
        let mut rng = fastrand::Rng::with_seed(1);
        (0..DRAWS).for_each(|_| judge(rng.usize(..rows.len()), rng.usize(..rows.len())));
    }
    best.1
}

fn median_residual_n(rows: &[PushRow], stride: usize, c_from_s2: &Rotation3<f64>, lengths: &mut Vec<f64>) -> f64 {
    lengths.clear();
    lengths.extend(rows.iter().step_by(stride).map(|row| row.residual_n(c_from_s2).norm()));
    if lengths.is_empty() {
        return 0.0;
    }
    let middle = lengths.len() / 2;
    *lengths.select_nth_unstable_by(middle, f64::total_cmp).1
}
