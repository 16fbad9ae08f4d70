//! Descriptive statistics: location and spread of one sample.

use crate::check;
use crate::error::{AnalysisError, Result};
use serde::Serialize;

/// Location and spread of one sample, in the unit of the sample.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SampleSummary {
    pub n: usize,
    pub mean: f64,
    /// Standard deviation with n - 1; `None` for a single value.
    pub sd: Option<f64>,
    pub median: f64,
    /// First and third quartile ([`quantile`]).
    pub quartiles: [f64; 2],
    /// Minimum and maximum.
    pub extremes: [f64; 2],
}

impl SampleSummary {
    /// Summarises `sample`, at least one value.
    pub fn of(sample: &[f64]) -> Result<Self> {
        check::values("the sample", sample, 1)?;
        let sorted = sorted(sample);
        let at = |fraction| quantile_of_sorted(&sorted, fraction);
        Ok(Self {
            n: sample.len(),
            mean: raw_mean(sample),
            sd: (sample.len() > 1).then(|| raw_sd(sample)),
            median: at(0.5),
            quartiles: [at(0.25), at(0.75)],
            extremes: [at(0.0), at(1.0)],
        })
    }
}

/// Returns the mean of at least one value.
pub fn mean(sample: &[f64]) -> Result<f64> {
    check::values("the sample", sample, 1)?;
    Ok(raw_mean(sample))
}

/// Returns the standard deviation with n - 1 in the denominator, of at least two values.
pub fn sd(sample: &[f64]) -> Result<f64> {
    check::values("the sample", sample, 2)?;
    Ok(raw_sd(sample))
}

/// Returns the median of at least one value.
pub fn median(sample: &[f64]) -> Result<f64> {
    quantile(sample, 0.5)
}

/// Returns the quantile at `fraction` (0 to 1) of at least one value: type 7 of Hyndman & Fan (Sample quantiles in
/// statistical packages, The American Statistician 50, 1996), linear between the order statistics, the default of R's
/// `quantile` and `NumPy`.
pub fn quantile(sample: &[f64], fraction: f64) -> Result<f64> {
    check::values("the sample", sample, 1)?;
    if !(0.0..=1.0).contains(&fraction) {
        return Err(AnalysisError::OutOfRange {
            what: "the level of a quantile",
            range: "from 0 to 1",
            value: fraction,
        });
    }
    Ok(quantile_of_sorted(&sorted(sample), fraction))
}

pub(crate) fn sorted(sample: &[f64]) -> Vec<f64> {
    let mut sorted = sample.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    sorted
}

/// Returns the quantile of at least one finite value in ascending order.
pub(crate) fn quantile_of_sorted(sorted: &[f64], fraction: f64) -> f64 {
    let at = (sorted.len() - 1) as f64 * fraction;
    let below = at as usize;
    let above = (below + 1).min(sorted.len() - 1);
    sorted[below] + (at - below as f64) * (sorted[above] - sorted[below])
}

pub(crate) fn median_of_sorted(sorted: &[f64]) -> f64 {
    let half = sorted.len() / 2;
    if sorted.len() % 2 == 1 { sorted[half] } else { f64::midpoint(sorted[half - 1], sorted[half]) }
}

pub(crate) fn raw_mean(sample: &[f64]) -> f64 {
    let mean = sample.iter().sum::<f64>() / sample.len() as f64;
    // The second pass removes the rounding error of the sum.
    mean + sample.iter().map(|value| value - mean).sum::<f64>() / sample.len() as f64
}

/// Returns the standard deviation of at least two values, without checks.
pub(crate) fn raw_sd(sample: &[f64]) -> f64 {
    (squares(sample) / (sample.len() - 1) as f64).sqrt()
}

/// Returns the sum of the squared deviations from the mean.
pub(crate) fn squares(sample: &[f64]) -> f64 {
    let mean = raw_mean(sample);
    sample.iter().map(|value| (value - mean).powi(2)).sum()
}
