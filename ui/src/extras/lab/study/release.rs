//! Arguments of `nima study release`.

use clap::Args;
use nima_study::release::Options;

use super::{Asked, clocks::Clocks};

#[derive(Debug, Args)]
pub(in crate::extras::lab) struct Release {
    #[command(flatten)]
    clocks: Clocks,
}

impl Asked for Release {
    type Experiment = Options;

    fn experiment(&self) -> anyhow::Result<Options> {
        Ok(Options { clocks: self.clocks.chosen() })
    }
}
