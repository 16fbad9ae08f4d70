//! Which condition is better, from a table of trials: participants, conditions, and any number of measures.
//!
//! Each measure is compared on its own. Where every participant was under several conditions: Wilcoxon's signed-rank test of each pair with the
//! Hodges-Lehmann difference, Friedman's test of all of them; where the groups are different people: Mann and Whitney's. In both cases the
//! pairs' p-values are corrected after Holm, and a mixed model with a random intercept per participant uses every trial. The statistics are those
//! of `nima_analysis`, which are checked against R and `SciPy`.

mod compare;
mod present;
mod table;
#[cfg(test)]
mod tests;

use std::path::PathBuf;

use nima_analysis::{AnalysisError, Interval, friedman::Friedman, mixed, signed_rank::Location};
use serde::Serialize;

pub use table::{Table, TableError, Trial};

use crate::Experiment;

/// The analysis of a table.
#[derive(Clone, Debug)]
pub struct Trials {
    /// The table (CSV): a row per trial, with `participant`, `condition`, and a column per measure.
    pub path: PathBuf,
    /// The measures; empty for every column of numbers.
    pub measures: Vec<String>,
    /// The condition with which others are compared; the first in alphabetical order if none is named.
    pub reference: Option<String>,
    /// Confidence of the intervals, as a share.
    pub confidence: f64,
    /// Tell for how many participants this power is reached.
    pub power: Option<f64>,
}

/// Why a table cannot be analysed.
#[derive(Debug, thiserror::Error)]
pub enum TrialsError {
    /// The table.
    #[error(transparent)]
    Table(#[from] TableError),
    /// No such condition.
    #[error("{path}: there is no condition \"{name}\"; there are: {known}")]
    Reference {
        /// The table.
        path: String,
        /// What was named.
        name: String,
        /// What there is.
        known: String,
    },
    /// A setting.
    #[error(transparent)]
    Setting(AnalysisError),
}

/// How the conditions are spread over the participants.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Design {
    /// Some participants were under several conditions.
    Within,
    /// Each participant was under one condition.
    Between,
    /// There is one condition.
    Single,
}

/// The result.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// The table.
    pub table: String,
    /// Trials in it.
    pub trials: usize,
    /// Participants in it.
    pub participants: usize,
    /// The conditions, in alphabetical order.
    pub conditions: Vec<String>,
    /// The one with which others are compared.
    pub reference: String,
    /// Confidence of the intervals.
    pub confidence: f64,
    /// Every measure.
    pub measures: Vec<OfMeasure>,
}

/// One measure.
#[derive(Clone, Debug, Serialize)]
pub struct OfMeasure {
    /// Name of its column.
    pub measure: String,
    /// Trials without a value.
    pub missing: usize,
    /// How the conditions are spread over the participants.
    pub design: Design,
    /// What was measured under each condition.
    pub conditions: Vec<OfCondition>,
    /// All conditions at once, of the participants who were under all of them; where there are three or more.
    pub friedman: Option<Friedman>,
    /// How many participants that are.
    pub complete: usize,
    /// Every pair of conditions.
    pub pairs: Vec<Pair>,
    /// All trials: differences from the reference.
    pub mixed: Option<Mixed>,
    /// What could not be computed, and why.
    pub notes: Vec<String>,
}

/// A measure under one condition; of a participant with several trials their mean.
#[derive(Clone, Debug, Serialize)]
pub struct OfCondition {
    pub condition: String,
    pub participants: usize,
    pub trials: usize,
    pub median: f64,
    /// Of the median, by bootstrap (`BCa`).
    pub interval: Option<Interval>,
    pub mean: f64,
    pub sd: Option<f64>,
}

/// Two conditions, the first minus the second.
#[derive(Clone, Debug, Serialize)]
pub struct Pair {
    /// The first.
    pub first: String,
    /// The second; the reference, where it is one of the two.
    pub second: String,
    /// Participants under both, or in each group.
    pub participants: [usize; 2],
    /// Hodges-Lehmann difference.
    pub difference: Location,
    /// Two-sided p of the rank test.
    pub p: f64,
    /// Whether it is exact.
    pub exact: bool,
    /// The same after Holm, over the pairs of the measure.
    pub p_holm: f64,
    /// Within: matched-pairs rank-biserial correlation. Between: Cliff's delta. -1 to 1.
    pub rank_effect: f64,
    /// Hedges' g: of the differences, or of the groups.
    pub g: Option<f64>,
    /// Participants that are needed for the wanted power, if the difference is as measured.
    pub needed: Option<usize>,
}

/// The mixed model: response ~ condition + trial + (1 | participant), REML.
#[derive(Clone, Debug, Serialize)]
pub struct Mixed {
    /// Differences from the reference, and the effect of the trial's number where the table has it.
    pub effects: Vec<mixed::Effect>,
    /// Whether the conditions differ at all.
    pub conditions: Option<mixed::JointTest>,
    /// Share of the participants in the variance.
    pub icc: f64,
}

impl Experiment for Trials {
    const NAME: &'static str = "analysis";
    const FILES: &'static [&'static str] = &[".md", ".csv", ".R"];
    type Findings = Report;
    type Error = TrialsError;

    fn inputs(&self) -> Vec<PathBuf> {
        vec![self.path.clone()]
    }

    fn run(&self, progress: &mut dyn FnMut(usize, usize, &str)) -> Result<Report, TrialsError> {
        let table = Table::read(&self.path, &self.measures)?;
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
        Ok(Report {
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
