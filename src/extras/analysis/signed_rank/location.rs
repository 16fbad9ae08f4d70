//! The size of the difference: the estimate that belongs to the signed-rank test.

use super::{MAX_EXACT, distribution};
use crate::error::Result;
use crate::interval::{self, ConfidenceInterval};
use crate::{check, summary};
use serde::Serialize;

/// More differences are refused: their averages would fill the memory.
const MAX: usize = 2000;

/// A Hodges-Lehmann estimate with its interval, in the unit of the values.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Location {
    pub estimate: f64,
    /// Confidence interval of the estimate.
    pub interval: ConfidenceInterval,
}

/// Estimates `first - second`, pair by pair.
pub fn paired_location(first: &[f64], second: &[f64], confidence: f64) -> Result<Location> {
    location(&check::differences(first, second)?, confidence)
}

/// Returns the median of the averages of all pairs of differences, each also with itself (Hodges & Lehmann, Estimates
/// of location based on rank tests, Annals of Mathematical Statistics 34, 1963), of 1 to 2000 differences.
///
/// The interval inverts the signed-rank test (Tukey; Hollander & Wolfe, section 3.3): exact up to [`MAX_EXACT`]
/// differences, like R's `wilcox.test` without ties and zeros. With ties or zeros R switches to the normal
/// approximation, while this one stays exact: its confidence is then at least the reported one. Zeros count like all
/// other differences.
pub fn location(differences: &[f64], confidence: f64) -> Result<Location> {
    check::values("differences", differences, 1)?;
    check::not_too_many("differences", differences.len(), MAX)?;
    check::fraction("the confidence", confidence)?;
    let averages = walsh_averages(differences);
    let n = differences.len();
    let interval = if n <= MAX_EXACT {
        interval::exact(&averages, &distribution::masses(1..=n), confidence)
    } else {
        let n = n as f64;
        let sd = (n * (n + 1.0) * (2.0 * n + 1.0) / 24.0).sqrt();
        interval::approximate(&averages, n * (n + 1.0) / 4.0, sd, confidence)
    };
    Ok(Location { estimate: summary::median_of_sorted(&averages), interval })
}

/// Returns the averages of all pairs, ascending.
fn walsh_averages(differences: &[f64]) -> Vec<f64> {
    let with_the_rest = |at: usize| differences[at..].iter().map(move |other| f64::midpoint(differences[at], *other));
    let mut averages: Vec<f64> = (0..differences.len()).flat_map(with_the_rest).collect();
    averages.sort_unstable_by(f64::total_cmp);
    averages
}
