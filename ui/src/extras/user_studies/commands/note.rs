//! `nima user-study note`.

use std::path::PathBuf;

use clap::Args;
use nima_recording::store::utc_now;
use nima_user_study::Study;

#[derive(Debug, Args)]
pub(in crate::extras::user_studies) struct Arguments {
    /// The folder of the study
    #[arg(value_name = "DIR")]
    study: PathBuf,
    /// The note; it must not tell who the participant is
    #[arg(long, value_name = "TEXT")]
    text: String,
    /// About whom
    #[arg(long, value_name = "P01")]
    participant: Option<String>,
}

pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let Arguments { study, text, participant } = arguments;
    Ok(Study::open(study, &utc_now())?.note(participant.as_deref(), text, &utc_now())?)
}
