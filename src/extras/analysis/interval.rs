//! Intervals of confidence, and those that are made of order statistics.

use crate::distribution::normal_quantile;
use serde::Serialize;

/// An interval of confidence, in the unit of what it is about.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Interval {
    /// Its lower end.
    pub lower: f64,
    /// Its upper end.
    pub upper: f64,
    /// The confidence that it has, as a share. Of an exact interval it is what was attained: the ranks of a small sample allow some values only,
    /// so it is near what was asked for, mostly above, and below where even the widest interval of the sample has less.
    pub confidence: f64,
}

impl Interval {
    /// Whether `value` is in it.
    pub fn contains(&self, value: f64) -> bool {
        self.lower <= value && value <= self.upper
    }

    /// `estimate` and `half_width` on both sides.
    pub(crate) fn around(estimate: f64, half_width: f64, confidence: f64) -> Self {
        Self { lower: estimate - half_width, upper: estimate + half_width, confidence }
    }
}

/// The interval between the `k`-th smallest and the `k`-th largest of `sorted` (Walsh averages, or differences between two groups), which
/// inverts a rank test. `masses[s]` is the probability that the statistic of the test is `s`, and `sorted.len() + 1 == masses.len()`.
///
/// `k` is the least value of the statistic that reaches half of what may be missed, and 1 at least, as in R's `wilcox.test`. With ties the
/// confidence is at least what is told (Lehmann, Nonparametrics, 1975, sections 2.7 and 4.5).
pub(crate) fn exact(sorted: &[f64], masses: &[f64], confidence: f64) -> Interval {
    // Rounding in the sums must not push a tail that is just reached above the limit.
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

/// The same for large samples, with the statistic's mean and standard deviation (Hollander & Wolfe, Nonparametric Statistical Methods, 1999,
/// equations 3.41 and 4.37).
pub(crate) fn approximate(sorted: &[f64], mean: f64, sd: f64, confidence: f64) -> Interval {
    let k = mean - normal_quantile(f64::midpoint(1.0, confidence)) * sd;
    between(sorted, k.max(1.0) as usize, confidence)
}

fn between(sorted: &[f64], k: usize, confidence: f64) -> Interval {
    let k = k.clamp(1, sorted.len().div_ceil(2).max(1));
    Interval { lower: sorted[k - 1], upper: sorted[sorted.len() - k], confidence }
}
