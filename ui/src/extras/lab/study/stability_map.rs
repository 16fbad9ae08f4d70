//! Arguments of `nima study stability-map`: none.

use clap::Args;
use nima_study::stability_map::Options;

use super::Asked;

#[derive(Debug, Args)]
pub(in crate::extras::lab) struct StabilityMap;

impl Asked for StabilityMap {
    type Experiment = Options;

    fn experiment(&self) -> anyhow::Result<Options> {
        Ok(Options)
    }
}
