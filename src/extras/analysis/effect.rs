//! Effect sizes: the size of a difference, without a unit. For an interval pass one of them to
//! [`crate::Bootstrap::interval`].

use crate::error::{AnalysisError, Result};
use crate::signed_rank::{Zeros, signed_ranks};
use crate::{check, summary};
use serde::Serialize;
use statrs::function::gamma::ln_gamma;

/// A difference of means in standard deviations.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct StandardisedEffect {
    /// Cohen's d (Statistical Power Analysis, 1988).
    pub d: f64,
    /// The same without the bias of small samples: d times the exact factor of Hedges (Distribution theory for Glass's
    /// estimator of effect size, Journal of Educational Statistics 6, 1981).
    pub g: f64,
}

/// Returns the matched-pairs rank-biserial correlation, -1 (all differences negative) to 1: the positive fraction of
/// the rank sum minus the negative fraction (Kerby, The simple difference formula, Comprehensive Psychology 3, 2014).
/// Zeros are dropped; at least one difference must not be zero.
pub fn rank_biserial(differences: &[f64]) -> Result<f64> {
    check::values("differences", differences, 1)?;
    let (ranks, positive) = signed_ranks(differences, Zeros::Wilcoxon);
    if ranks.is_empty() {
        return Err(AnalysisError::NoVariation { what: "the two values of every participant" });
    }
    let signed =
        ranks.iter().zip(positive).map(|(rank, positive)| if positive { *rank as f64 } else { -(*rank as f64) });
    Ok(signed.sum::<f64>() / ranks.iter().sum::<usize>() as f64)
}

/// Returns Cohen's d of paired values, `dz`: mean of the differences over their standard deviation; of at least three
/// differences that are not all equal. `g` has n - 1 degrees of freedom.
pub fn cohens_dz(differences: &[f64]) -> Result<StandardisedEffect> {
    check::values("differences", differences, 3)?;
    let sd = if check::varies(differences) { summary::raw_sd(differences) } else { 0.0 };
    standardised(summary::raw_mean(differences), sd, differences.len() - 1, "the differences")
}

/// Returns Cohen's d of two groups, at least two values each: difference of the means, first minus second, over the
/// pooled standard deviation. `g` has m + n - 2 degrees of freedom.
pub fn cohens_d(first: &[f64], second: &[f64]) -> Result<StandardisedEffect> {
    check::values("values of the first group", first, 2)?;
    check::values("values of the second group", second, 2)?;
    let df = first.len() + second.len() - 2;
    let spread = |group: &[f64]| if check::varies(group) { summary::squares(group) } else { 0.0 };
    let pooled = ((spread(first) + spread(second)) / df as f64).sqrt();
    standardised(summary::raw_mean(first) - summary::raw_mean(second), pooled, df, "the values of each group")
}

/// Vargha & Delaney's A (A critique and improvement of the CL common language effect size statistics, Journal of
/// Educational and Behavioral Statistics 25, 2000): probability that a value of the first group is greater than a value
/// of the second, ties counting half; 0 to 1, 0.5 means no effect.
pub fn vargha_delaney(first: &[f64], second: &[f64]) -> Result<f64> {
    Ok(f64::midpoint(cliffs_delta(first, second)?, 1.0))
}

/// Cliff's delta (Dominance statistics, Psychological Bulletin 114, 1993): fraction of pairs in which the first is
/// greater minus fraction in which the second is; -1 to 1.
pub fn cliffs_delta(first: &[f64], second: &[f64]) -> Result<f64> {
    check::values("values of the first group", first, 1)?;
    check::values("values of the second group", second, 1)?;
    let second = summary::sorted(second);
    let dominance = |value: &f64| {
        let below = second.partition_point(|other| other < value);
        let not_above = second.partition_point(|other| other <= value);
        below as f64 - (second.len() - not_above) as f64
    };
    Ok(first.iter().map(dominance).sum::<f64>() / (first.len() as f64 * second.len() as f64))
}

fn standardised(mean: f64, sd: f64, df: usize, what: &'static str) -> Result<StandardisedEffect> {
    let d = mean / sd;
    if d.is_finite() {
        Ok(StandardisedEffect { d, g: d * hedges_factor(df as f64) })
    } else {
        Err(AnalysisError::NoVariation { what })
    }
}

/// Returns Gamma(df / 2) / (sqrt(df / 2) Gamma((df - 1) / 2)), for at least two degrees of freedom.
fn hedges_factor(df: f64) -> f64 {
    (ln_gamma(df / 2.0) - ln_gamma((df - 1.0) / 2.0) - (df / 2.0).ln() / 2.0).exp()
}
