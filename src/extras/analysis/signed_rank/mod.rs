//! Wilcoxon's signed-rank test: two conditions, with each participant under both.
//!
//! Always two-sided. The exact p-value comes from the permutation distribution: all 2^n assignments of signs to the
//! ranks, also with ties.

mod distribution;
mod location;

use crate::check;
use crate::distribution::normal_two_sided;
use crate::error::{AnalysisError, Result};
use crate::ranks::Ranks;
use serde::Serialize;

pub use location::{Location, location, paired_location};

/// By default the distribution is exact up to this many differences (as in `SciPy`'s `wilcoxon`).
pub const MAX_EXACT: usize = 50;

/// Treatment of differences that are zero.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub enum Zeros {
    /// Dropped before ranking (Wilcoxon, Individual comparisons by ranking methods, Biometrics Bulletin 1, 1945); the
    /// usual rule.
    #[default]
    Wilcoxon,
    /// Ranked, then dropped, so that many zeros weaken the others (Pratt, Remarks on zeros and ties, JASA 54, 1959).
    Pratt,
}

/// Method of computing a p-value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub enum Distribution {
    /// Exact up to [`MAX_EXACT`] values, by the normal distribution above.
    #[default]
    Automatic,
    /// Exact; more values than [`MAX_EXACT`] are refused.
    Exact,
    /// By the normal distribution, corrected for ties and for continuity.
    Normal,
}

impl Distribution {
    /// Returns whether `n` values are to be computed exactly.
    pub(crate) fn is_exact(self, what: &'static str, n: usize) -> Result<bool> {
        match self {
            Self::Automatic => Ok(n <= MAX_EXACT),
            Self::Normal => Ok(false),
            Self::Exact => check::not_too_many(what, n, MAX_EXACT).map(|()| true),
        }
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SignedRankOptions {
    pub zeros: Zeros,
    pub distribution: Distribution,
}

/// Result of the signed-rank test.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SignedRank {
    /// Number of differences that are not zero.
    pub n: usize,
    /// Number of differences that are zero.
    pub zeros: usize,
    /// Sum of the ranks of positive differences, R's V.
    pub w_plus: f64,
    /// Sum of the ranks of negative differences.
    pub w_minus: f64,
    /// Standardised statistic, corrected for ties and continuity (R's and `SciPy`'s), positive if the positive ranks
    /// outweigh.
    pub z: f64,
    /// Two-sided p-value.
    pub p: f64,
    /// Whether `p` is exact.
    pub exact: bool,
}

/// Tests `first - second`, pair by pair.
pub fn paired(first: &[f64], second: &[f64], options: &SignedRankOptions) -> Result<SignedRank> {
    of_differences(&check::differences(first, second)?, options)
}

/// Tests differences, at least one of which is not zero, against a distribution that is symmetric about zero.
///
/// The normal approximation is the one of Hollander & Wolfe (Nonparametric Statistical Methods, 1999, section 3.1); for
/// the kept ranks r, the sum has mean sum(r) / 2 and variance sum(r^2) / 4, which holds with ties and under either rule
/// for zeros.
pub fn of_differences(differences: &[f64], options: &SignedRankOptions) -> Result<SignedRank> {
    check::values("differences", differences, 1)?;
    let (ranks, positive) = signed_ranks(differences, options.zeros);
    if ranks.is_empty() {
        return Err(AnalysisError::NoVariation { what: "the two values of every participant" });
    }
    let exact = options.distribution.is_exact("differences for an exact test", ranks.len())?;
    let total: usize = ranks.iter().sum();
    let plus: usize = ranks.iter().zip(&positive).map(|(rank, positive)| if *positive { *rank } else { 0 }).sum();
    // Half of the doubled sum is the mean; the ranks are doubled, so all of these are halved.
    let above = (plus as f64 - total as f64 / 2.0) / 2.0;
    let sd = (ranks.iter().map(|rank| (*rank as f64).powi(2)).sum::<f64>() / 16.0).sqrt();
    let z = above.signum() * (above.abs() - 0.5).max(0.0) / sd;
    let p = if exact { distribution::two_sided(&ranks, plus.min(total - plus)) } else { normal_two_sided(z) };
    let w_plus = plus as f64 / 2.0;
    let w_minus = (total - plus) as f64 / 2.0;
    Ok(SignedRank { n: ranks.len(), zeros: differences.len() - ranks.len(), w_plus, w_minus, z, p, exact })
}

/// Returns twice the ranks of the nonzero differences, and which of these differences are positive.
pub(crate) fn signed_ranks(differences: &[f64], zeros: Zeros) -> (Vec<usize>, Vec<bool>) {
    let ranked = differences.iter().copied().filter(|difference| zeros == Zeros::Pratt || difference.abs() > 0.0);
    let ranked: Vec<f64> = ranked.collect();
    let ranks = Ranks::of(&ranked.iter().map(|difference| difference.abs()).collect::<Vec<_>>());
    let kept = ranks.doubled.into_iter().zip(ranked).filter(|(_, difference)| difference.abs() > 0.0);
    kept.map(|(rank, difference)| (rank, difference > 0.0)).unzip()
}
