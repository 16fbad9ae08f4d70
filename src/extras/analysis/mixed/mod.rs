//! A linear mixed model with a random intercept per participant.
//!
//! `y = X beta + b(participant) + e`, with `b ~ N(0, participant variance)` and `e ~ N(0, residual variance)`, all
//! independent. The fixed effects are an intercept, the conditions relative to a reference (treatment coding), and the
//! covariates unmodified. Unequal numbers of trials and missing trials are allowed.
//!
//! The ratio of the two variances is found by a one-dimensional search; the rest follows from it in closed form (Bates,
//! Mächler, Bolker & Walker, Fitting linear mixed-effects models using lme4, Journal of Statistical Software 67, 2015,
//! section 3; here with sums over participants). Degrees of freedom are Satterthwaite's, as in lmerTest (Kuznetsova,
//! Brockhoff & Christensen, Journal of Statistical Software 82, 2017; Giesbrecht & Burns, Biometrics 41, 1985), with
//! derivatives in closed form where lmerTest uses differences.

mod design;
mod fit;
mod likelihood;
mod optimum;
mod satterthwaite;

use crate::check;
use crate::error::{AnalysisError, Result};
use design::MixedDesign;
use serde::Serialize;

pub use fit::{FixedEffect, JointTest, MixedFit};

/// The criterion to be maximised.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub enum MixedCriterion {
    /// Restricted likelihood: variances without the bias caused by the fixed effects. For everything except comparing
    /// models with different fixed effects.
    #[default]
    Reml,
    Ml,
}

/// Measurements, one entry per trial, with their explanatory variables.
///
/// ```
/// use nima_analysis::{mixed::{MixedCriterion, MixedModel}, AnalysisError};
///
/// // Peak force of four participants, N, twice under each condition.
/// let participant = ["a", "a", "a", "a", "b", "b", "b", "b", "c", "c", "c", "c", "d", "d", "d", "d"];
/// let condition = ["none", "none", "matched", "matched"].repeat(4);
/// let force = [5.1, 4.8, 4.0, 4.3, 6.2, 6.0, 5.3, 5.0, 4.1, 4.4, 3.9, 3.2, 5.5, 5.9, 4.6, 4.8];
/// let fit = MixedModel::new(&participant, &condition, "none", &force)?.fit(MixedCriterion::Reml, 0.95)?;
/// let matched = fit.effect("matched").unwrap();
/// assert!((matched.estimate + 0.8625).abs() < 1e-9 && (matched.df - 11.0).abs() < 1e-6 && matched.p < 0.001);
/// # Ok::<(), AnalysisError>(())
/// ```
#[derive(Clone, Debug)]
pub struct MixedModel {
    participant: Vec<String>,
    condition: Vec<String>,
    reference: String,
    response: Vec<f64>,
    covariates: Vec<(String, Vec<f64>)>,
}

impl MixedModel {
    /// `participant`, `condition` and `response` of each trial, all of one length; the conditions are compared with
    /// `reference`, which must occur among them. With a single condition there is only the intercept.
    pub fn new<P: AsRef<str>, C: AsRef<str>>(
        participant: &[P],
        condition: &[C],
        reference: &str,
        response: &[f64],
    ) -> Result<Self> {
        check::values("responses", response, 3)?;
        check::as_many("the participants", participant.len(), "the responses", response.len())?;
        check::as_many("the conditions", condition.len(), "the responses", response.len())?;
        if !condition.iter().any(|name| name.as_ref() == reference) {
            return Err(AnalysisError::UnknownCondition { name: reference.to_owned() });
        }
        Ok(Self {
            participant: participant.iter().map(|name| name.as_ref().to_owned()).collect(),
            condition: condition.iter().map(|name| name.as_ref().to_owned()).collect(),
            reference: reference.to_owned(),
            response: response.to_vec(),
            covariates: Vec::new(),
        })
    }

    /// Adds a covariate, such as the number of the trial or the position of the condition in the order: one value per
    /// trial, used unmodified (not centred).
    pub fn covariate(mut self, name: &str, values: &[f64]) -> Result<Self> {
        check::as_many(&format!("the values of '{name}'"), values.len(), "the responses", self.response.len())?;
        check::finite(&format!("the covariate '{name}'"), values)?;
        self.covariates.push((name.to_owned(), values.to_vec()));
        Ok(self)
    }

    /// Fits the model; `confidence` is the level of the intervals.
    ///
    /// Refuses a column that depends on others, fewer trials or participants than the effects and variances need, and
    /// responses that the effects explain without residual.
    pub fn fit(&self, criterion: MixedCriterion, confidence: f64) -> Result<MixedFit> {
        check::fraction("the confidence", confidence)?;
        let design = MixedDesign::of(self)?;
        let ratio = optimum::ratio(&design, criterion)?;
        MixedFit::at(&design, ratio, criterion, confidence)
    }
}
