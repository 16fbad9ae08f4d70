//! Arguments of `nima study faults`.

use clap::Args;
use nima_study::faults::FaultOptions;

use super::ExperimentArguments;
use crate::command::run::positive_seconds;

#[derive(Debug, Args)]
pub(in crate::extras::lab) struct FaultsStudy {
    /// Number of moments at which each fault is injected while engaged, 1 to 20
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=20))]
    moments: u32,
    /// Length of each of the 40 fault-free runs, in which no fault may be reported, s
    #[arg(long, value_name = "S", default_value_t = 20.0, value_parser = positive_seconds)]
    calm: f64,
}

impl ExperimentArguments for FaultsStudy {
    type Experiment = FaultOptions;

    fn experiment(&self) -> anyhow::Result<FaultOptions> {
        Ok(FaultOptions { moments: self.moments, live: true, calm_s: self.calm })
    }
}
