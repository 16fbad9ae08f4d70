//! The test of Mann, Whitney and Wilcoxon: two groups of different participants.
//!
//! Always two-sided. The exact p-value comes from the permutation distribution, also with ties.

mod distribution;

use crate::check;
use crate::distribution::normal_two_sided;
use crate::error::{AnalysisError, Result};
use crate::interval;
use crate::ranks::Ranks;
use crate::signed_rank::{Distribution, Location, MAX_EXACT};
use crate::summary;
use serde::Serialize;

/// More differences between the groups than this are rejected, because they would fill the memory.
const MAX_DIFFERENCES: usize = 4_000_000;

/// Result of the Mann-Whitney test.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MannWhitney {
    /// Number of pairs, with one value from each group, in which the value of the first group is greater; a tie counts
    /// half. R's W.
    pub u: f64,
    /// Number of pairs in which the second value is greater.
    pub other_u: f64,
    /// Standardised statistic, corrected for ties and continuity, positive if the first group has the greater values.
    pub z: f64,
    /// Two-sided p-value.
    pub p: f64,
    /// Whether `p` is exact.
    pub exact: bool,
}

/// Tests two groups with at least one value each, not all of which are equal (Mann & Whitney, On a test of whether one
/// of two random variables is stochastically larger than the other, Annals of Mathematical Statistics 18, 1947).
///
/// By default exact if both groups have at most [`MAX_EXACT`] values. With ties the distribution is not symmetric, and
/// the p-value counts everything at least as far from the mean, on either side (like R's `coin` and `SciPy`'s
/// permutation for a centred statistic).
pub fn test(first: &[f64], second: &[f64], distribution: Distribution) -> Result<MannWhitney> {
    check::values("values of the first group", first, 1)?;
    check::values("values of the second group", second, 1)?;
    let exact = distribution.is_exact("values of a group for an exact test", first.len().max(second.len()))?;
    let ranks = Ranks::of(&[first, second].concat());
    let m = first.len() as f64;
    let n = second.len() as f64;
    let all = (first.len() + second.len()) as f64;
    let variance = m * n / 12.0 * (all + 1.0 - ranks.ties / (all * (all - 1.0)));
    if ranks.doubled.iter().all(|rank| *rank == ranks.doubled[0]) {
        return Err(AnalysisError::NoVariation { what: "the values of both groups" });
    }
    let sum = ranks.doubled[..first.len()].iter().sum::<usize>();
    let u = sum as f64 / 2.0 - m * (m + 1.0) / 2.0;
    let above = u - m * n / 2.0;
    let z = above.signum() * (above.abs() - 0.5).max(0.0) / variance.sqrt();
    let p = if exact { distribution::two_sided(&ranks, first.len()) } else { normal_two_sided(z) };
    Ok(MannWhitney { u, other_u: m * n - u, z, p, exact })
}

/// Estimates by how much the first group is greater: the median of all differences between its values and the second
/// group's (Hodges & Lehmann, 1963).
///
/// The interval inverts the test (Moses; Hollander & Wolfe, section 4.3): exact if both groups have at most
/// [`MAX_EXACT`] values. With ties its confidence is at least the reported one, whereas R's `wilcox.test` switches to
/// the normal approximation.
pub fn shift(first: &[f64], second: &[f64], confidence: f64) -> Result<Location> {
    check::values("values of the first group", first, 1)?;
    check::values("values of the second group", second, 1)?;
    check::fraction("the confidence", confidence)?;
    check::not_too_many("differences between the groups", first.len().saturating_mul(second.len()), MAX_DIFFERENCES)?;
    let differences = first.iter().flat_map(|a| second.iter().map(move |b| a - b));
    let differences = summary::sorted(&differences.collect::<Vec<_>>());
    let m = first.len();
    let n = second.len();
    let interval = if m.max(n) <= MAX_EXACT {
        interval::exact(&differences, &distribution::masses(m, n), confidence)
    } else {
        let m = m as f64;
        let n = n as f64;
        interval::approximate(&differences, m * n / 2.0, (m * n * (m + n + 1.0) / 12.0).sqrt(), confidence)
    };
    Ok(Location { estimate: summary::median_of_sorted(&differences), interval })
}
