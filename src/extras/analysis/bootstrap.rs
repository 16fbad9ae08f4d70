//! Bootstrap confidence intervals (Efron & Tibshirani, An Introduction to the Bootstrap, 1993).

use crate::distribution::{normal_below, normal_quantile};
use crate::error::{AnalysisError, Result};
use crate::interval::ConfidenceInterval;
use crate::{check, summary};

/// Method of computing the interval from the bootstrap distribution.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BootstrapMethod {
    /// Quantiles of the distribution (Efron & Tibshirani, section 13.3). The interval is too short for few values.
    Percentile,
    /// `BCa`: corrected for bias and acceleration (Efron, Better bootstrap confidence intervals, JASA 82, 1987; Efron &
    /// Tibshirani, section 14.3). If resamples equal the estimate exactly, as medians often do, half of them count as
    /// below it.
    #[default]
    BiasCorrected,
}

/// A bootstrap with its seed: the same settings and data give the same interval.
///
/// ```
/// use nima_analysis::{AnalysisError, Bootstrap};
///
/// let seconds = [31.0, 28.5, 44.2, 36.1, 29.9, 52.3, 33.3, 30.8];
/// let interval = Bootstrap::default().median(&seconds)?;
/// assert!(interval.contains(32.05) && interval == Bootstrap::default().median(&seconds)?);
/// # Ok::<(), AnalysisError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bootstrap {
    /// Number of resamples, 100 to a million.
    pub resamples: usize,
    pub seed: u64,
    /// Confidence level of the interval, between 0 and 1.
    pub confidence: f64,
    pub method: BootstrapMethod,
}

impl Default for Bootstrap {
    fn default() -> Self {
        Self { resamples: 9999, seed: 1, confidence: 0.95, method: BootstrapMethod::default() }
    }
}

impl Bootstrap {
    /// Returns the interval of the mean of at least two values.
    pub fn mean(&self, sample: &[f64]) -> Result<ConfidenceInterval> {
        self.interval(sample, summary::raw_mean)
    }

    /// Returns the interval of the median of at least two values.
    pub fn median(&self, sample: &[f64]) -> Result<ConfidenceInterval> {
        self.interval(sample, median)
    }

    /// Returns the interval of any statistic of at least two values. The statistic must be finite for every possible
    /// resample, including one value repeated n times.
    pub fn interval(&self, sample: &[f64], statistic: impl Fn(&[f64]) -> f64) -> Result<ConfidenceInterval> {
        check::values("the sample", sample, 2)?;
        check::fraction("the confidence", self.confidence)?;
        check::enough("samples to draw", self.resamples, 100)?;
        check::not_too_many("samples to draw", self.resamples, 1_000_000)?;
        let drawn = self.draw(sample, &statistic)?;
        let tail = (1.0 - self.confidence) / 2.0;
        let [lower, upper] = match self.method {
            BootstrapMethod::Percentile => [tail, 1.0 - tail],
            BootstrapMethod::BiasCorrected => corrected(tail, &drawn, sample, &statistic)?,
        };
        let at = |fraction| summary::quantile_of_sorted(&drawn, fraction);
        Ok(ConfidenceInterval { lower: at(lower), upper: at(upper), confidence: self.confidence })
    }

    /// Returns the statistic of each resample, ascending.
    fn draw(&self, sample: &[f64], statistic: impl Fn(&[f64]) -> f64) -> Result<Vec<f64>> {
        let mut rng = fastrand::Rng::with_seed(self.seed);
        let mut resample = vec![0.0; sample.len()];
        let mut drawn = Vec::with_capacity(self.resamples);
        for _ in 0..self.resamples {
            resample.fill_with(|| sample[rng.usize(..sample.len())]);
            drawn.push(statistic(&resample));
        }
        check::finite("the statistic of the drawn samples", &drawn)?;
        drawn.sort_unstable_by(f64::total_cmp);
        Ok(drawn)
    }
}

/// Returns the quantiles of the bootstrap distribution that `BCa` uses instead of `tail` and `1 - tail`.
fn corrected(tail: f64, drawn: &[f64], sample: &[f64], statistic: impl Fn(&[f64]) -> f64) -> Result<[f64; 2]> {
    let estimate = statistic(sample);
    // The same values in another order may give a differently rounded mean, which must still count as equal to the
    // estimate.
    let rounding = 1e-12 * (drawn[drawn.len() - 1] - drawn[0]);
    let below = drawn.partition_point(|value| *value < estimate - rounding);
    let not_above = drawn.partition_point(|value| *value <= estimate + rounding);
    if not_above == 0 || below == drawn.len() {
        return Err(AnalysisError::NotEstimable { why: "all resampled values are on one side of the estimate" });
    }
    let bias = normal_quantile((below + not_above) as f64 / (2 * drawn.len()) as f64);
    let acceleration = acceleration(sample, statistic)?;
    let fraction = |z: f64| normal_below(bias + (bias + z) / (1.0 - acceleration * (bias + z)));
    let z = normal_quantile(tail);
    Ok([fraction(z), fraction(-z)])
}

/// Returns the acceleration from the jackknife: skewness of the statistic with one value left out; zero if the
/// statistic does not depend on the omitted value.
fn acceleration(sample: &[f64], statistic: impl Fn(&[f64]) -> f64) -> Result<f64> {
    let mut rest = sample[1..].to_vec();
    let mut without = Vec::with_capacity(sample.len());
    for left_out in 0..sample.len() {
        without.push(statistic(&rest));
        if left_out < rest.len() {
            rest[left_out] = sample[left_out];
        }
    }
    check::finite("the statistic with one value left out", &without)?;
    let mean = summary::raw_mean(&without);
    let power_sum = |power| without.iter().map(|value| (mean - value).powi(power)).sum::<f64>();
    let spread = power_sum(2).powf(1.5);
    Ok(if spread > 0.0 { power_sum(3) / (6.0 * spread) } else { 0.0 })
}

fn median(sample: &[f64]) -> f64 {
    summary::median_of_sorted(&summary::sorted(sample))
}
