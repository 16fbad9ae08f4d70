//! Arguments of `nima study passivity`: none.

use clap::Args;
use nima_study::passivity::Options;

use super::Asked;

#[derive(Debug, Args)]
pub(in crate::command) struct Passivity;

impl Asked for Passivity {
    type Experiment = Options;

    fn experiment(&self) -> anyhow::Result<Options> {
        Ok(Options)
    }
}
