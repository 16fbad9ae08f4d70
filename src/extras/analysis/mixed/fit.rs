//! The results of a fitted model.

use super::MixedCriterion;
use super::design::MixedDesign;
use super::likelihood::LikelihoodProfile;
use super::satterthwaite::Precision;
use crate::distribution::{f_above, t_critical, t_two_sided};
use crate::error::{AnalysisError, Result};
use crate::interval::ConfidenceInterval;
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use serde::Serialize;

/// A fitted mixed model.
#[derive(Clone, Debug, Serialize)]
pub struct MixedFit {
    /// The maximised criterion.
    pub criterion: MixedCriterion,
    /// Intercept (the reference, where covariates are zero), conditions in alphabetical order, covariates.
    pub effects: Vec<FixedEffect>,
    /// Test of whether the conditions differ at all; `None` if there is only one.
    pub conditions: Option<JointTest>,
    /// Variance of the participants' intercepts, unit of the response squared. Zero is the boundary: then the trials of
    /// one participant are no more alike than those of different ones, and the model equals one without participants.
    pub participant_variance: f64,
    /// Variance within participants, unit of the response squared.
    pub residual_variance: f64,
    /// Intraclass correlation: the fraction of the total variance that is due to the participants.
    pub icc: f64,
    /// Logarithm of the (restricted) likelihood. With REML it only compares models with the same fixed effects.
    pub log_likelihood: f64,
    /// Best linear unbiased prediction of each participant's intercept, by name in alphabetical order.
    pub intercepts: Vec<(String, f64)>,
    /// Residual of each response, in the order of the trials: without fixed effects and the participant's intercept.
    pub residuals: Vec<f64>,
    #[serde(skip)]
    solution: FitSolution,
}

/// One fixed effect, or a combination of some.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FixedEffect {
    /// The condition, the covariate, or `(intercept)`.
    pub name: String,
    /// Estimate in the unit of the response; for a covariate, per unit of it.
    pub estimate: f64,
    pub standard_error: f64,
    /// Estimate over standard error.
    pub t: f64,
    /// Satterthwaite's degrees of freedom.
    pub df: f64,
    pub p: f64,
    /// Confidence interval of the estimate.
    pub interval: ConfidenceInterval,
}

/// F test of several effects at once (Fai & Cornelius, Approximate F-tests, Journal of Statistical Computation and Simulation 54, 1996, as in lmerTest).
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct JointTest {
    pub f: f64,
    /// Degrees of freedom of the numerator: number of effects.
    pub df: f64,
    /// Degrees of freedom of the denominator, after Satterthwaite.
    pub denominator_df: f64,
    /// p-value of `f`.
    pub p: f64,
}

#[derive(Clone, Debug)]
struct FitSolution {
    beta: DVector<f64>,
    precision: Precision,
    confidence: f64,
    reference: String,
    condition_names: Vec<String>,
}

impl MixedFit {
    pub(super) fn at(design: &MixedDesign, ratio: f64, criterion: MixedCriterion, confidence: f64) -> Result<Self> {
        let flat = AnalysisError::NotEstimable { why: "the effects cannot be separated at the best-fitting variances" };
        let profile = LikelihoodProfile::of(design, criterion);
        let point = profile.at(ratio).ok_or(flat.clone())?;
        let precision = Precision::of(design, &profile, &point)?;
        let beta = design.r.solve_upper_triangular(&(&design.projected + &point.gamma)).ok_or(flat)?;
        let condition_names = design.names[design.conditions.clone()].to_vec();
        let solution =
            FitSolution { beta, precision, confidence, reference: design.reference.clone(), condition_names };
        let effects =
            (0..design.names.len()).map(|at| solution.effect(design.names[at].clone(), &solution.unit(at))).collect();
        let intercepts = &point.z * ratio;
        let fixed = &design.y - &design.q * &point.gamma;
        let residuals = (0..design.rows()).map(|row| fixed[row] - intercepts[design.of_row[row]]).collect();
        let residual_variance = profile.residual_variance(&point);
        Ok(Self {
            criterion,
            effects,
            conditions: solution.joint(design.conditions.clone())?,
            participant_variance: ratio * residual_variance,
            residual_variance,
            icc: ratio / (1.0 + ratio),
            log_likelihood: -profile.deviance(&point) / 2.0,
            intercepts: design.participants.iter().cloned().zip(intercepts.iter().copied()).collect(),
            residuals,
            solution,
        })
    }

    /// Returns the fixed effect of that name.
    pub fn effect(&self, name: &str) -> Option<&FixedEffect> {
        self.effects.iter().find(|effect| effect.name == name)
    }

    /// Returns the difference between two conditions, `first` minus `second`; the reference may be one of them. Correct
    /// several p-values with [`crate::correction::holm`].
    pub fn between(&self, first: &str, second: &str) -> Result<FixedEffect> {
        let weights = self.solution.of_condition(first)? - self.solution.of_condition(second)?;
        if first == second {
            return Err(AnalysisError::NoVariation { what: "two names of conditions" });
        }
        Ok(self.solution.effect(format!("{first} - {second}"), &weights))
    }
}

impl FitSolution {
    fn unit(&self, at: usize) -> DVector<f64> {
        DVector::from_fn(self.beta.len(), |row, _| f64::from(u8::from(row == at)))
    }

    /// Returns the weights of the fixed effects for the condition's difference from the reference.
    fn of_condition(&self, name: &str) -> Result<DVector<f64>> {
        if name == self.reference {
            return Ok(DVector::zeros(self.beta.len()));
        }
        let at = self.condition_names.iter().position(|condition| condition == name);
        at.map(|at| self.unit(at + 1)).ok_or_else(|| AnalysisError::UnknownCondition { name: name.to_owned() })
    }

    fn effect(&self, name: String, weights: &DVector<f64>) -> FixedEffect {
        let estimate = weights.dot(&self.beta);
        let standard_error = self.precision.variance(weights).sqrt();
        let t = estimate / standard_error;
        let df = self.precision.df(weights);
        let interval =
            ConfidenceInterval::around(estimate, t_critical(self.confidence, df) * standard_error, self.confidence);
        FixedEffect { name, estimate, standard_error, t, df, p: t_two_sided(t, df), interval }
    }

    /// Tests several effects jointly. The effects are rotated until they are uncorrelated; each then has its own t and
    /// degrees of freedom.
    fn joint(&self, effects: std::ops::Range<usize>) -> Result<Option<JointTest>> {
        if effects.is_empty() {
            return Ok(None);
        }
        let first = effects.start;
        let count = effects.len();
        let covariance: DMatrix<f64> = self.precision.covariance.view((first, first), (count, count)).into_owned();
        let turned = SymmetricEigen::try_new(covariance, f64::EPSILON, 1000)
            .ok_or(AnalysisError::NotEstimable { why: "the covariance of the conditions cannot be decomposed" })?;
        let mut squares = 0.0;
        let mut dfs = Vec::with_capacity(count);
        for (variance, direction) in turned.eigenvalues.iter().zip(turned.eigenvectors.column_iter()) {
            let mut weights = DVector::zeros(self.beta.len());
            weights.rows_mut(first, count).copy_from(&direction);
            squares += weights.dot(&self.beta).powi(2) / variance;
            dfs.push(self.precision.df(&weights));
        }
        let f = squares / count as f64;
        let df = count as f64;
        let denominator_df = together(&dfs);
        Ok(Some(JointTest { f, df, denominator_df, p: f_above(f, df, denominator_df) }))
    }
}

/// Returns the degrees of freedom of the mean of squared t's: those of the F distribution with the same expectation; 2
/// if there is none.
fn together(dfs: &[f64]) -> f64 {
    let alike = dfs.windows(2).all(|two| (two[0] - two[1]).abs() < 1e-8 * two[0].abs());
    if alike {
        return dfs.iter().sum::<f64>() / dfs.len() as f64;
    }
    if dfs.iter().any(|df| *df <= 2.0) {
        return 2.0;
    }
    let expected: f64 = dfs.iter().map(|df| df / (df - 2.0)).sum();
    2.0 * expected / (expected - dfs.len() as f64)
}
