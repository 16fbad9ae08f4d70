//! `nima study trials`.

use std::path::PathBuf;

use clap::Args;
use nima_study::trials::Trials;

use super::ExperimentArguments;

#[derive(Debug, Args)]
pub(in crate::extras::lab) struct TrialsArguments {
    /// Table (CSV): one row per trial with `participant`, `condition`, optionally `trial`, and one column per measure
    #[arg(value_name = "TRIALS.csv")]
    table: PathBuf,
    /// Measures: names of columns; may be repeated (default: every numeric column)
    #[arg(long, value_name = "COLUMN")]
    measure: Vec<String>,
    /// Condition with which the others are compared (default: the first in alphabetical order)
    #[arg(long, value_name = "CONDITION")]
    reference: Option<String>,
    /// Confidence level of the intervals, as a fraction
    #[arg(long, value_name = "FRACTION", value_parser = fraction, default_value = "0.95")]
    confidence: f64,
    /// Print the number of participants needed for this power (a fraction), if the true differences are those in the
    /// table
    #[arg(long, value_name = "FRACTION", value_parser = fraction)]
    power: Option<f64>,
}

fn fraction(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(fraction) if (0.5..1.0).contains(&fraction) => Ok(fraction),
        _ => Err("enter a fraction from 0.5 to below 1, such as 0.95".to_owned()),
    }
}

impl ExperimentArguments for TrialsArguments {
    type Experiment = Trials;

    fn experiment(&self) -> anyhow::Result<Trials> {
        let Self { table, measure, reference, confidence, power } = self;
        Ok(Trials {
            path: table.clone(),
            measures: measure.clone(),
            reference: reference.clone(),
            confidence: *confidence,
            power: *power,
        })
    }
}
