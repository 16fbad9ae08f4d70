//! Several conditions and trials, analysed with the mixed model.

use super::{Power, PowerSimulation, normal};
use crate::check;
use crate::error::{AnalysisError, Result};
use crate::mixed::{MixedCriterion, MixedFit, MixedModel};

/// A study with repeated measures: every participant has the same number of trials under every condition.
#[derive(Clone, Debug, PartialEq)]
pub struct MixedStudy {
    /// Effect of each condition except the reference, in the unit of the response; at least one.
    pub effects: Vec<f64>,
    /// Trials of each participant under each condition, at least one.
    pub trials: usize,
    /// Variance of the participants' intercepts; may be zero.
    pub participant_variance: f64,
    /// Variance within participants.
    pub residual_variance: f64,
}

impl MixedStudy {
    /// Creates a study with the variances of a pilot and the given effects, preferably the smallest relevant ones
    /// rather than those observed in the pilot.
    pub fn from_pilot(pilot: &MixedFit, effects: &[f64], trials: usize) -> Self {
        let participant_variance = pilot.participant_variance;
        let residual_variance = pilot.residual_variance;
        Self { effects: effects.to_vec(), trials, participant_variance, residual_variance }
    }

    fn check(&self) -> Result<()> {
        check::values("effects of conditions", &self.effects, 1)?;
        check::enough("trials under each condition", self.trials, 1)?;
        check::finite("the variance of the participants", &[self.participant_variance])?;
        if self.participant_variance < 0.0 {
            let range = "zero or a positive number";
            let value = self.participant_variance;
            return Err(AnalysisError::OutOfRange { what: "the variance of the participants", range, value });
        }
        check::positive("the residual variance", self.residual_variance)
    }
}

impl PowerSimulation {
    /// Returns the power of the joint F test of the conditions with `participants`, at least 2 and at most 100 000
    /// trials in total.
    pub fn mixed(&self, study: &MixedStudy, participants: usize) -> Result<Power> {
        study.check()?;
        check::enough("participants", participants, 2)?;
        let conditions = study.effects.len() + 1;
        let all = participants.saturating_mul(conditions).saturating_mul(study.trials);
        check::enough("trials", all, 3)?;
        check::not_too_many("trials", all, 100_000)?;
        let each = conditions * study.trials;
        let participant: Vec<String> = (0..all).map(|row| (row / each).to_string()).collect();
        let condition: Vec<String> = (0..all).map(|row| (row % conditions).to_string()).collect();
        let means: Vec<f64> =
            (0..all).map(|row| if row % conditions == 0 { 0.0 } else { study.effects[row % conditions - 1] }).collect();
        let between = study.participant_variance.sqrt();
        let within = study.residual_variance.sqrt();
        self.run(|rng| {
            let mut intercept = 0.0;
            let mut response = vec![0.0; all];
            for (row, value) in response.iter_mut().enumerate() {
                if row % each == 0 {
                    intercept = between * normal(rng);
                }
                *value = means[row] + intercept + within * normal(rng);
            }
            let fit = MixedModel::new(&participant, &condition, "0", &response)
                .and_then(|model| model.fit(MixedCriterion::Reml, 0.95));
            fit.ok().and_then(|fit| fit.conditions).map(|test| test.p)
        })
    }
}
