//! Detects samples for which a network is unreliable, by their distance from the training data.
//!
//! Three scores are computed, each 1 at its limit, and the largest one counts: the distance to the nearest cluster
//! centre of the training data in whitened features; the distance of each feature outside its range; and the
//! disagreement of the ensemble. The limits of distance and range are calibrated by cross-validation (each fold in
//! turn), so that at most about [`FALSE_ALARMS`] of the unseen samples within the range of the others are flagged. A
//! value that is not finite has an infinite score.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// Fraction of the samples of unseen trajectories that a limit may flag: fewer would let the limit depend on a few
/// samples, more would render the fallback too often. Design choice.
pub const FALSE_ALARMS: f64 = 0.01;
/// Margin beyond the calibrated limits if the folds are parts of one session, because another session covers a wider
/// range: in simulation, the 99th percentile of three unseen sessions was 2 to 14 % beyond the limits.
const ROOM: f32 = 1.15;
/// Their distances are computed in every tick, so their number is limited by the time of a tick.
const CENTRES: usize = 96;
// Lloyd's algorithm has practically settled after a few rounds; each reads all rows.
const ROUNDS: usize = 8;
/// Minimum variance in the whitening, as a fraction of the feature's variance: below it the direction is only noise.
const FLOOR: f64 = 0.02;
/// Maximum number of rows used for the statistics; larger data sets are thinned evenly.
/// The upper 1 % of them are still 200 samples.
const ROWS: usize = 20_000;

/// Cluster centres, whitening, ranges and limits, for normalised features; only the first `width` features are used.
#[derive(Clone, Debug, PartialEq)]
pub struct Doubt {
    /// Number of features used: the measured ones, without their products.
    pub width: usize,
    /// Whitening matrix, `width x width`, row by row: whitened = matrix times features.
    pub whitening: Vec<f32>,
    /// Whitened centres, `width` numbers each.
    pub centres: Vec<f32>,
    pub range: Vec<[f32; 2]>,
    /// Limit of the distance to the nearest centre.
    pub distance_limit: f32,
    /// Limit of the distance from the middle of the range, in halves of the range; at least 1.
    pub range_limit: f32,
    /// Limit of the ensemble's disagreement, in standard deviations of an output.
    pub spread_limit: f32,
}

impl Doubt {
    /// Fits on all rows of `x` (normalised, `stride` numbers a row), with limits calibrated over the folds, which are
    /// pairs of rows to fit on and rows to evaluate (possibly whole sessions). `spreads` are the ensemble's
    /// disagreements on rows that one member was not trained on.
    pub fn fit(
        x: &[f32],
        stride: usize,
        width: usize,
        folds: &[(Vec<usize>, Vec<usize>)],
        spreads: Vec<f32>,
        whole_sessions: bool,
        seed: u64,
    ) -> Self {
        // Whole sessions already contain the difference between sessions.
        let room = if whole_sessions { 1.0 } else { ROOM };
        let rows: Vec<usize> = (0..x.len() / stride).collect();
        let mut doubt = Self::geometry(x, stride, width, &rows, seed);
        let mut distances = Vec::new();
        let mut reaches = Vec::new();
        let mut scratch = vec![0.0; width];
        for (fit, judge) in folds {
            let mut fold_distances = Vec::new();
            let mut fold_reaches = Vec::new();
            let fold = Self::geometry(x, stride, width, fit, seed);
            // Divided among the folds, so that the total time does not depend on their number.
            for &row in &thinned(judge, ROWS / folds.len().max(1)) {
                let features = &x[row * stride..row * stride + width];
                fold_distances.push(fold.distance(features, &mut scratch));
                fold_reaches.push(fold.reach(features));
            }
            distances.push(quantile(fold_distances));
            reaches.push(quantile(fold_reaches));
        }
        // The limits are divisors, so they must not be zero.
        doubt.distance_limit = room * median(distances).max(1e-3);
        doubt.range_limit = room * median(reaches).max(1.0);
        doubt.spread_limit = room * quantile(spreads).max(1e-6);
        doubt
    }

    fn geometry(x: &[f32], stride: usize, width: usize, rows: &[usize], seed: u64) -> Self {
        let rows = thinned(rows, ROWS);
        let features = |row: usize| &x[row * stride..row * stride + width];
        let whitening = whitening(width, rows.iter().map(|row| features(*row)));
        let mut range = vec![[f32::INFINITY, f32::NEG_INFINITY]; width];
        let mut white = Vec::with_capacity(rows.len() * width);
        for &row in &rows {
            for (range, value) in range.iter_mut().zip(features(row)) {
                *range = [range[0].min(*value), range[1].max(*value)];
            }
            let start = white.len();
            white.resize(start + width, 0.0);
            whiten(&whitening, features(row), &mut white[start..]);
        }
        let centres = centres(&white, width, seed);
        Self { width, whitening, centres, range, distance_limit: 1.0, range_limit: 1.0, spread_limit: 1.0 }
    }

    /// Returns the score of the distance and range of a row of normalised features. `scratch` must have length `width`.
    /// Allocates nothing.
    pub fn outside(&self, features: &[f32], scratch: &mut [f32]) -> f32 {
        let distance = self.distance(features, scratch) / self.distance_limit;
        let score = distance.max(self.reach(features) / self.range_limit);
        // Tested apart from the score: a maximum ignores NaN.
        let finite = features[..self.width].iter().all(|x| x.is_finite());
        if finite && score.is_finite() { score } else { f32::INFINITY }
    }

    /// Returns the score of the ensemble's spread, per output in standard deviations of that output.
    pub fn disagreement(&self, spread: &[f32]) -> f32 {
        let score = spread.iter().copied().fold(0.0, f32::max) / self.spread_limit;
        if score.is_finite() { score } else { f32::INFINITY }
    }

    fn distance(&self, features: &[f32], scratch: &mut [f32]) -> f32 {
        whiten(&self.whitening, features, scratch);
        let square = |centre: &[f32]| centre.iter().zip(&*scratch).map(|(c, x)| (c - x) * (c - x)).sum::<f32>();
        let nearest = self.centres.chunks_exact(self.width).map(square).fold(f32::INFINITY, f32::min);
        // The root once, after the minimum: the order of squares is the same.
        nearest.sqrt()
    }

    /// Returns the largest distance from the middle of a feature's range, in halves of the range.
    fn reach(&self, features: &[f32]) -> f32 {
        let one = |([low, high], value): (&[f32; 2], &f32)| {
            // A feature that was constant has no range; rounding must not make it infinitely far.
            let half = (0.5 * (high - low)).max(1e-4);
            (value - f32::midpoint(*low, *high)).abs() / half
        };
        self.range.iter().zip(features).map(one).fold(0.0, f32::max)
    }
}

/// Returns at most `max` of the rows, thinned evenly.
fn thinned(rows: &[usize], max: usize) -> Vec<usize> {
    rows.iter().copied().step_by(rows.len().div_ceil(max.max(1)).max(1)).collect()
}

/// Returns the median over the folds: a fold that leaves out an end of the range is rightly flagged and should not set
/// the limit.
fn median(mut values: Vec<f32>) -> f32 {
    values.sort_by(f32::total_cmp);
    values.get(values.len().saturating_sub(1) / 2).copied().unwrap_or(0.0)
}

/// Returns the limit that the fraction [`FALSE_ALARMS`] of these values exceeds.
fn quantile(mut values: Vec<f32>) -> f32 {
    if values.is_empty() {
        return 0.0;
    }
    let place = (((values.len() - 1) as f64) * (1.0 - FALSE_ALARMS)).round() as usize;
    *values.select_nth_unstable_by(place, f32::total_cmp).1
}

fn whiten(whitening: &[f32], features: &[f32], to: &mut [f32]) {
    let width = to.len();
    for (to, row) in to.iter_mut().zip(whitening.chunks_exact(width)) {
        *to = row.iter().zip(features).map(|(w, x)| w * x).sum();
    }
}

/// Returns the matrix that rotates to the principal axes and divides by their standard deviations, which are limited
/// from below.
fn whitening<'a>(width: usize, rows: impl Iterator<Item = &'a [f32]>) -> Vec<f32> {
    let mut covariance = DMatrix::<f64>::zeros(width, width);
    let mut mean = DVector::<f64>::zeros(width);
    let mut count = 0.0;
    for row in rows {
        let x = DVector::from_iterator(width, row.iter().map(|x| f64::from(*x)));
        // One pass: sums of products now, the mean subtracted at the end.
        covariance.ger(1.0, &x, &x, 1.0);
        mean += x;
        count += 1.0;
    }
    if count > 0.0 {
        mean /= count;
        covariance /= count;
        covariance.ger(-1.0, &mean, &mean, 1.0);
    }
    let SymmetricEigen { eigenvectors, eigenvalues } = covariance.symmetric_eigen();
    // Divided by the standard deviation along each axis: distances then count in usual deviations.
    let entry = |k: usize, i: usize| (eigenvectors[(i, k)] / eigenvalues[k].max(FLOOR).sqrt()) as f32;
    (0..width).flat_map(|k| (0..width).map(move |i| (k, i))).map(|(k, i)| entry(k, i)).collect()
}

/// Finds centres of whitened rows by Lloyd's algorithm, starting from randomly chosen rows.
fn centres(white: &[f32], width: usize, seed: u64) -> Vec<f32> {
    // At most 4000 rows: the centres only have to cover the data.
    let rows: Vec<&[f32]> = white.chunks_exact(width).step_by((white.len() / width).div_ceil(4000).max(1)).collect();
    // Mixed with a constant, so that the choice differs from other uses of the same seed.
    let mut generator = fastrand::Rng::with_seed(seed ^ 0xce27);
    let mut centres: Vec<f32> =
        generator.choose_multiple(rows.iter(), CENTRES).into_iter().flat_map(|row| row.iter().copied()).collect();
    for _ in 0..ROUNDS {
        let mut sums = vec![0.0_f32; centres.len()];
        let mut counts = vec![0.0_f32; centres.len() / width];
        for row in &rows {
            let square = |c: &[f32]| c.iter().zip(*row).map(|(c, x)| (c - x) * (c - x)).sum::<f32>();
            let nearest = centres.chunks_exact(width).map(square).enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
            let Some((k, _)) = nearest else { continue };
            counts[k] += 1.0;
            sums[k * width..(k + 1) * width].iter_mut().zip(*row).for_each(|(sum, x)| *sum += x);
        }
        // A centre that attracted no row stays in place.
        for (k, count) in counts.iter().enumerate().filter(|(_, count)| **count > 0.0) {
            for i in k * width..(k + 1) * width {
                centres[i] = sums[i] / count;
            }
        }
    }
    centres
}
