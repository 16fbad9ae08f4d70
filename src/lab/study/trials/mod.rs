//! Compares conditions in a table of trials: participants, conditions, and any number of measures.
//!
//! Each measure is compared separately. If every participant was under several conditions: Wilcoxon's signed-rank test
//! of each pair with the Hodges-Lehmann difference, and Friedman's test of all of them; if the groups are different
//! people: the Mann-Whitney test. In both cases the pairs' p-values are corrected after Holm, and a mixed model with a
//! random intercept per participant uses every trial. The statistics are from `nima_analysis`, which are checked
//! against R and `SciPy`.

mod compare;
mod present;
mod table;
#[cfg(test)]
mod tests;

use std::path::PathBuf;

use nima_analysis::{AnalysisError, ConfidenceInterval, friedman::Friedman, mixed, signed_rank::Location};
use serde::Serialize;

pub use table::{TableError, TableTrial, TrialTable};

use crate::Experiment;

#[derive(Clone, Debug)]
pub struct Trials {
    /// The table (CSV): one row per trial, with `participant`, `condition`, and a column per measure.
    pub path: PathBuf,
    /// The measures; empty for every numeric column.
    pub measures: Vec<String>,
    /// The condition with which the others are compared; by default the first in alphabetical order.
    pub reference: Option<String>,
    /// Confidence level of the intervals, 0 to 1.
    pub confidence: f64,
    /// Reports the number of participants for which this power is reached.
    pub power: Option<f64>,
}

#[derive(Debug, thiserror::Error)]
pub enum TrialsError {
    #[error(transparent)]
    Table(#[from] TableError),
    #[error("{path}: there is no condition \"{name}\"; choose one of {known}")]
    Reference {
        path: String,
        /// The requested name.
        name: String,
        /// The existing conditions.
        known: String,
    },
    #[error(transparent)]
    Setting(AnalysisError),
}

/// Assignment of conditions to participants.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TrialDesign {
    /// Some participants were under several conditions.
    Within,
    /// Each participant was under one condition.
    Between,
    Single,
}

#[derive(Clone, Debug, Serialize)]
pub struct TrialReport {
    pub table: String,
    pub trials: usize,
    pub participants: usize,
    /// Conditions, in alphabetical order.
    pub conditions: Vec<String>,
    /// The condition with which the others are compared.
    pub reference: String,
    /// Confidence level of the intervals.
    pub confidence: f64,
    pub measures: Vec<OfMeasure>,
}

#[derive(Clone, Debug, Serialize)]
pub struct OfMeasure {
    pub measure: String,
    /// Trials without a value.
    pub missing: usize,
    /// Assignment of conditions to participants.
    pub design: TrialDesign,
    /// Measurements under each condition.
    pub conditions: Vec<OfCondition>,
    /// Test of all conditions at once, for the participants with data for every condition; if there are three or more
    /// conditions.
    pub friedman: Option<Friedman>,
    /// Number of these participants.
    pub complete: usize,
    /// Every pair of conditions.
    pub pairs: Vec<ConditionPair>,
    /// All trials: differences from the reference.
    pub mixed: Option<TrialMixed>,
    /// Values that could not be computed, with the reason.
    pub notes: Vec<String>,
}

/// A measure under one condition; for a participant with several trials, their mean.
#[derive(Clone, Debug, Serialize)]
pub struct OfCondition {
    pub condition: String,
    pub participants: usize,
    pub trials: usize,
    pub median: f64,
    /// Interval of the median, by bootstrap (`BCa`).
    pub interval: Option<ConfidenceInterval>,
    pub mean: f64,
    pub sd: Option<f64>,
}

/// Two conditions, the first minus the second.
#[derive(Clone, Debug, Serialize)]
pub struct ConditionPair {
    pub first: String,
    /// The other condition: the reference, if it is one of the two.
    pub second: String,
    /// Participants under both, or in each group.
    pub participants: [usize; 2],
    /// Hodges-Lehmann difference.
    pub difference: Location,
    /// Two-sided p of the rank test.
    pub p: f64,
    /// Whether `p` is exact.
    pub exact: bool,
    /// The p-value after Holm's correction over the pairs of the measure.
    pub p_holm: f64,
    /// Within: matched-pairs rank-biserial correlation. Between: Cliff's delta. -1 to 1.
    pub rank_effect: f64,
    /// Hedges' g: of the differences, or of the groups.
    pub g: Option<f64>,
    /// Number of participants for the requested power, if the true difference equals the measured one.
    pub needed: Option<usize>,
}

/// The mixed model: response ~ condition + trial + (1 | participant), REML.
#[derive(Clone, Debug, Serialize)]
pub struct TrialMixed {
    /// Differences from the reference, and the effect of the trial's number if the table has it.
    pub effects: Vec<mixed::FixedEffect>,
    /// Whether the conditions differ at all.
    pub conditions: Option<mixed::JointTest>,
    /// Fraction of the variance between participants.
    pub icc: f64,
}

impl Experiment for Trials {
    const NAME: &'static str = "analysis";
    const FILES: &'static [&'static str] = &[".md", ".csv", ".R"];
    type Findings = TrialReport;
    type Error = TrialsError;

    fn inputs(&self) -> Vec<PathBuf> {
        vec![self.path.clone()]
    }

    fn run(&self, progress: &mut dyn FnMut(usize, usize, &str)) -> Result<TrialReport, TrialsError> {
        let table = TrialTable::read(&self.path, &self.measures)?;
        let conditions = table.conditions();
        let first = conditions.first().cloned().unwrap_or_default();
        let reference = self.reference.clone().unwrap_or(first);
        if !conditions.contains(&reference) {
            let path = self.path.display().to_string();
            let known = conditions.join(", ");
            return Err(TrialsError::Reference { path, name: reference, known });
        }
        let total = table.measures.len();
        let of = |(done, measure): (usize, &String)| {
            progress(done, total, measure);
            compare::measure(&table, measure, &reference, self.confidence, self.power)
        };
        let measures = table.measures.iter().enumerate().map(of).collect::<Result<_, _>>();
        Ok(TrialReport {
            table: self.path.display().to_string(),
            trials: table.trials.len(),
            participants: table.participants(),
            conditions,
            reference,
            confidence: self.confidence,
            measures: measures.map_err(TrialsError::Setting)?,
        })
    }
}
