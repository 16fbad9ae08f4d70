//! The ratio of the participants' variance to the residual variance that maximises the likelihood.

use super::MixedCriterion;
use super::design::MixedDesign;
use super::likelihood::{LikelihoodPoint, LikelihoodProfile};
use crate::error::{AnalysisError, Result};

/// Returns the correlations within a participant for the first scan of the likelihood: evenly spaced, then ever closer
/// to 1.
fn correlations() -> impl Iterator<Item = f64> {
    (0..50).map(|step| f64::from(step) / 50.0).chain((2..=9).map(|digits| 1.0 - 0.1_f64.powi(digits)))
}

/// Finds the zero of the slope, which is sharper than the flat top of the likelihood.
pub(super) fn ratio(design: &MixedDesign, criterion: MixedCriterion) -> Result<f64> {
    let profile = LikelihoodProfile::of(design, criterion);
    let points: Vec<LikelihoodPoint> =
        correlations().filter_map(|fraction| profile.at(fraction / (1.0 - fraction))).collect();
    let deviances: Vec<f64> = points.iter().map(|point| profile.deviance(point)).collect();
    let best = (0..points.len()).min_by(|&a, &b| deviances[a].total_cmp(&deviances[b])).ok_or(FLAT)?;
    if best + 1 == points.len() {
        return Err(AnalysisError::NotEstimable {
            why: "the trials of each participant differ only by the fixed effects",
        });
    }
    if best == 0 && profile.slope(&points[0]) >= 0.0 {
        return Ok(0.0);
    }
    let low = points[best.saturating_sub(1)].ratio;
    let high = points[best + 1].ratio;
    zero(low, high, |ratio| profile.at(ratio).map(|point| profile.slope(&point)))
}

const FLAT: AnalysisError = AnalysisError::NotEstimable { why: "no maximum of the likelihood was found" };

/// Finds the zero by halving; the slope is negative below the ratio and positive above.
fn zero(mut low: f64, mut high: f64, slope: impl Fn(f64) -> Option<f64>) -> Result<f64> {
    if slope(low).ok_or(FLAT)? > 0.0 || slope(high).ok_or(FLAT)? < 0.0 {
        return Err(FLAT);
    }
    for _ in 0..200 {
        let middle = f64::midpoint(low, high);
        if middle <= low || middle >= high {
            break;
        }
        if slope(middle).ok_or(FLAT)? < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    Ok(high)
}
