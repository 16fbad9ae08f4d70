//! Arguments of `nima study stability`.

use clap::Args;
use nima_study::stability::StabilityOptions;

use super::ExperimentArguments;

#[derive(Debug, Args)]
pub(in crate::extras::lab) struct Stability {
    /// Number of ticks in the test for numerical drift, about 3 µs per tick
    #[arg(long, value_name = "N", default_value_t = 1_000_000)]
    ticks: u64,
    /// Skip windows longer than 300 samples
    #[arg(long)]
    quick: bool,
}

impl ExperimentArguments for Stability {
    type Experiment = StabilityOptions;

    fn experiment(&self) -> anyhow::Result<StabilityOptions> {
        Ok(StabilityOptions { ticks: self.ticks, quick: self.quick })
    }
}
