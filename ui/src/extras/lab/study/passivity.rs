//! Arguments of `nima study passivity`.

use clap::Args;
use nima_study::passivity::Options;

use super::{Asked, clocks::Clocks};

#[derive(Debug, Args)]
pub(in crate::extras::lab) struct Passivity {
    #[command(flatten)]
    clocks: Clocks,
}

impl Asked for Passivity {
    type Experiment = Options;

    fn experiment(&self) -> anyhow::Result<Options> {
        Ok(Options { clocks: self.clocks.chosen() })
    }
}
