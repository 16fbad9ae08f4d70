//! `nima user-study`: a study from its file to the last questionnaire. One file per subcommand.

mod exclude;
mod new;
mod next;
mod note;
pub(super) mod report;
mod simulate;
mod status;
mod table;
mod unblind;

use std::path::Path;

use clap::Subcommand;
use nima_recording::store::utc_now;
use nima_screen::stderr::print_line;
use nima_user_study::{StudyError, UserStudy};

#[derive(Debug, Subcommand)]
pub(super) enum UserStudyCommand {
    /// Create the folder of a study: pseudonyms, orders, sealed conditions
    New(new::NewStudyArguments),
    /// Show the progress of all participants, and the next steps
    Status(status::StudyStatusArguments),
    /// Run the next step of a participant
    Next(next::NextTrialArguments),
    /// Write a note to the journal
    Note(note::NoteArguments),
    /// Exclude a participant, or one trial, from the analysis
    Exclude(exclude::ExcludeTrialArguments),
    /// Reveal the conditions; name, time and reason are stored
    Unblind(unblind::UnblindArguments),
    /// Write the table of trials for `nima study trials`
    Table(table::StudyTableArguments),
    /// Let simulated participants do the whole study
    Simulate(simulate::SimulateStudyArguments),
}

/// Opens a study for writing, with a warning if a recording is not encrypted or decrypted yet.
fn opened(folder: &Path) -> Result<UserStudy, StudyError> {
    let mut study = UserStudy::open(folder, &utc_now())?;
    warn(&mut study);
    Ok(study)
}

/// Prints the trouble of a study, if there is one.
fn warn(study: &mut UserStudy) {
    if let Some(trouble) = study.take_trouble() {
        print_line(format_args!("warning: {trouble}"));
    }
}

pub(super) fn run(command: &UserStudyCommand) -> anyhow::Result<()> {
    match command {
        UserStudyCommand::New(arguments) => new::run(arguments),
        UserStudyCommand::Status(arguments) => status::run(arguments),
        UserStudyCommand::Next(arguments) => next::run(arguments),
        UserStudyCommand::Note(arguments) => note::run(arguments),
        UserStudyCommand::Exclude(arguments) => exclude::run(arguments),
        UserStudyCommand::Unblind(arguments) => unblind::run(arguments),
        UserStudyCommand::Table(arguments) => table::run(arguments),
        UserStudyCommand::Simulate(arguments) => simulate::run(arguments),
    }
}
