//! Confidence intervals, including those from order statistics.

use crate::distribution::normal_quantile;
use serde::Serialize;

/// A confidence interval, in the unit of the estimate.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ConfidenceInterval {
    pub lower: f64,
    pub upper: f64,
    /// Confidence level, 0 to 1. For an exact interval, the attained level: the ranks of a small sample allow only some
    /// values, so it is close to the requested level, usually above it, and below it if even the widest interval of the
    /// sample has less.
    pub confidence: f64,
}

impl ConfidenceInterval {
    /// Returns whether it contains `value`.
    pub fn contains(&self, value: f64) -> bool {
        self.lower <= value && value <= self.upper
    }

    /// Returns the interval of `half_width` on both sides of `estimate`.
    pub(crate) fn around(estimate: f64, half_width: f64, confidence: f64) -> Self {
        Self { lower: estimate - half_width, upper: estimate + half_width, confidence }
    }
}

/// Returns the interval between the `k`-th smallest and the `k`-th largest of `sorted` (Walsh averages, or differences
/// between two groups), which inverts a rank test. `masses[s]` is the probability that the statistic of the test is
/// `s`, and `sorted.len() + 1 == masses.len()`.
///
/// `k` is the smallest value of the statistic that reaches half the allowed error, and at least 1, as in R's
/// `wilcox.test`. With ties the confidence is at least the reported one (Lehmann, Nonparametrics, 1975, sections 2.7
/// and 4.5).
pub(crate) fn exact(sorted: &[f64], masses: &[f64], confidence: f64) -> ConfidenceInterval {
    // Rounding in the sums must not push a tail that just reaches the limit beyond it.
    let missed = (1.0 - confidence) / 2.0 - 1e-14;
    let mut k = 0;
    let mut below = 0.0;
    for mass in masses {
        if k > 0 && below + mass >= missed {
            break;
        }
        below += mass;
        k += 1;
    }
    between(sorted, k, 1.0 - 2.0 * below)
}

/// Returns the same for large samples, with the statistic's mean and standard deviation (Hollander & Wolfe,
/// Nonparametric Statistical Methods, 1999, equations 3.41 and 4.37).
pub(crate) fn approximate(sorted: &[f64], mean: f64, sd: f64, confidence: f64) -> ConfidenceInterval {
    let k = mean - normal_quantile(f64::midpoint(1.0, confidence)) * sd;
    between(sorted, k.max(1.0) as usize, confidence)
}

fn between(sorted: &[f64], k: usize, confidence: f64) -> ConfidenceInterval {
    let k = k.clamp(1, sorted.len().div_ceil(2).max(1));
    ConfidenceInterval { lower: sorted[k - 1], upper: sorted[sorted.len() - k], confidence }
}
