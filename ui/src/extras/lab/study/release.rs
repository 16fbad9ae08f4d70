//! Arguments of `nima study release`.

use clap::Args;
use nima_study::release::ReleaseOptions;

use super::{ExperimentArguments, clocks::StudyClocks};

#[derive(Debug, Args)]
pub(in crate::extras::lab) struct ReleaseStudy {
    #[command(flatten)]
    clocks: StudyClocks,
}

impl ExperimentArguments for ReleaseStudy {
    type Experiment = ReleaseOptions;

    fn experiment(&self) -> anyhow::Result<ReleaseOptions> {
        Ok(ReleaseOptions { clocks: self.clocks.chosen() })
    }
}
