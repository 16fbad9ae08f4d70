//! Degrees of freedom of combinations of the fixed effects, after Satterthwaite.

use super::design::MixedDesign;
use super::likelihood::{LikelihoodPoint, LikelihoodProfile};
use crate::error::{AnalysisError, Result};
use nalgebra::{DMatrix, DVector};

/// Uncertainty of the fixed effects, and uncertainty of that estimate.
#[derive(Clone, Debug)]
pub(super) struct Precision {
    /// Covariance of the fixed effects.
    pub(super) covariance: DMatrix<f64>,
    residual_variance: f64,
    /// `(X' V^-1 X)^-1 X' V^-1 Z`, effects by participants; determines the effect of the ratio on the covariance.
    by_ratio: DMatrix<f64>,
    /// Variances and covariance of ratio and residual variance: ratio, both, variance.
    variances: [f64; 3],
}

impl Precision {
    pub(super) fn of(design: &MixedDesign, profile: &LikelihoodProfile, point: &LikelihoodPoint) -> Result<Self> {
        let lost = AnalysisError::NotEstimable { why: "the likelihood is too flat around its maximum" };
        let back = design.r.clone().try_inverse().ok_or(lost.clone())?;
        let residual_variance = profile.residual_variance(point);
        let covariance = &back * point.information.inverse() * back.transpose() * residual_variance;
        let by_ratio = &back * point.information.solve(&point.u);
        let [ratio, both, variance] = profile.curvature(point);
        let determinant = ratio * variance - both * both;
        let variances = if point.ratio > 0.0 {
            // Written so that NaN is refused too. The curvatures belong to minus twice the likelihood.
            if !(ratio > 0.0 && determinant > 0.0) {
                return Err(lost);
            }
            [2.0 * variance / determinant, -2.0 * both / determinant, 2.0 * ratio / determinant]
        } else {
            // At the boundary the ratio is treated as known, as in lmerTest, where its derivative with respect to the
            // parameter (its root) is zero.
            [0.0, 0.0, 2.0 / variance]
        };
        Ok(Self { covariance, residual_variance, by_ratio, variances })
    }

    /// Returns the variance of the combination of fixed effects with these weights.
    pub(super) fn variance(&self, weights: &DVector<f64>) -> f64 {
        weights.dot(&(&self.covariance * weights))
    }

    /// Returns the degrees of freedom of that combination: 2 variance^2 / (variance of the variance, from its
    /// gradient).
    pub(super) fn df(&self, weights: &DVector<f64>) -> f64 {
        let variance = self.variance(weights);
        let by_ratio = self.residual_variance * self.by_ratio.tr_mul(weights).norm_squared();
        let by_variance = variance / self.residual_variance;
        let [ratio, both, residual] = self.variances;
        let uncertainty =
            by_ratio * by_ratio * ratio + 2.0 * by_ratio * by_variance * both + by_variance * by_variance * residual;
        2.0 * variance * variance / uncertainty
    }
}
