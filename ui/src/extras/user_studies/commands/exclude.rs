//! `nima user-study exclude`.

use std::path::PathBuf;

use clap::Args;
use nima_recording::store::utc_now;

use super::opened;

#[derive(Debug, Args)]
pub(in crate::extras::user_studies) struct ExcludeTrialArguments {
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

pub(super) fn run(arguments: &ExcludeTrialArguments) -> anyhow::Result<()> {
    let ExcludeTrialArguments { study, participant, trial, reason } = arguments;
    Ok(opened(study)?.exclude(participant, *trial, reason, &utc_now())?)
}
