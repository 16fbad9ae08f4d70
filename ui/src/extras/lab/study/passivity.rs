//! Arguments of `nima study passivity`.

use clap::Args;
use nima_study::passivity::PassivityOptions;

use super::{ExperimentArguments, clocks::StudyClocks};

#[derive(Debug, Args)]
pub(in crate::extras::lab) struct Passivity {
    #[command(flatten)]
    clocks: StudyClocks,
}

impl ExperimentArguments for Passivity {
    type Experiment = PassivityOptions;

    fn experiment(&self) -> anyhow::Result<PassivityOptions> {
        Ok(PassivityOptions { clocks: self.clocks.chosen() })
    }
}
