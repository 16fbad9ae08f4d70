//! Arguments of `nima study release`: none.

use clap::Args;
use nima_study::release::Options;

use super::Asked;

#[derive(Debug, Args)]
pub(in crate::command) struct Release;

impl Asked for Release {
    type Experiment = Options;

    fn experiment(&self) -> anyhow::Result<Options> {
        Ok(Options)
    }
}
