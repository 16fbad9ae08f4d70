//! `nima user-study note`.

use std::path::PathBuf;

use clap::Args;
use nima_recording::store::utc_now;

use super::opened;

#[derive(Debug, Args)]
pub(in crate::extras::user_studies) struct NoteArguments {
    /// Folder of the study
    #[arg(value_name = "DIR")]
    study: PathBuf,
    /// Text of the note; it must not identify the participant
    #[arg(long, value_name = "TEXT")]
    text: String,
    /// Participant that the note is about
    #[arg(long, value_name = "P01")]
    participant: Option<String>,
}

pub(super) fn run(arguments: &NoteArguments) -> anyhow::Result<()> {
    let NoteArguments { study, text, participant } = arguments;
    Ok(opened(study)?.note(participant.as_deref(), text, &utc_now())?)
}
