//! Arguments of `nima study gates`.

use clap::Args;
use nima_study::gates::GateOptions;

use super::ExperimentArguments;

#[derive(Debug, Args)]
pub(in crate::extras::lab) struct GatesStudy {
    /// Number of requests, up to 1e12
    #[arg(long, value_name = "N", default_value = "1e8", value_parser = requests)]
    requests: u64,
    /// Seed of the random requests
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
}

/// Parses a whole number, also in the form `1e8`.
fn requests(text: &str) -> Result<u64, String> {
    match text.parse::<f64>() {
        Ok(count) if (1.0..=1e12).contains(&count) && count.fract() == 0.0 => Ok(count as u64),
        _ => Err("enter a whole number from 1 to 1e12".to_owned()),
    }
}

impl ExperimentArguments for GatesStudy {
    type Experiment = GateOptions;

    fn experiment(&self) -> anyhow::Result<GateOptions> {
        Ok(GateOptions { requests: self.requests, seed: self.seed })
    }
}
