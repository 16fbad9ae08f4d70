//! Arguments of `nima study stability-map`: none.

use clap::Args;
use nima_study::stability_map::StabilityMapOptions;

use super::ExperimentArguments;

#[derive(Debug, Args)]
pub(in crate::extras::lab) struct StabilityMapStudy;

impl ExperimentArguments for StabilityMapStudy {
    type Experiment = StabilityMapOptions;

    fn experiment(&self) -> anyhow::Result<StabilityMapOptions> {
        Ok(StabilityMapOptions)
    }
}
