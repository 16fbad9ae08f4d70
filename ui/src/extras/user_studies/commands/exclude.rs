//! `nima user-study exclude`.

use std::path::PathBuf;

use clap::Args;
use nima_recording::store::utc_now;
use nima_user_study::Study;

#[derive(Debug, Args)]
pub(in crate::extras::user_studies) struct Arguments {
    /// Folder of the study
    #[arg(value_name = "DIR")]
    study: PathBuf,
    /// Participant
    #[arg(long, value_name = "P01")]
    participant: String,
    /// Only this trial
    #[arg(long, value_name = "N")]
    trial: Option<u32>,
    /// Reason, which appears in the report
    #[arg(long, value_name = "TEXT")]
    reason: String,
}

pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let Arguments { study, participant, trial, reason } = arguments;
    Ok(Study::open(study, &utc_now())?.exclude(participant, *trial, reason, &utc_now())?)
}
