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

use clap::Subcommand;

#[derive(Debug, Subcommand)]
pub(super) enum UserStudyCommand {
    /// Create the folder of a study: pseudonyms, orders, sealed conditions
    New(new::Arguments),
    /// Show the progress of all participants, and the next steps
    Status(status::Arguments),
    /// Run the next step of a participant
    Next(next::Arguments),
    /// Write a note to the journal
    Note(note::Arguments),
    /// Exclude a participant, or one trial, from the analysis
    Exclude(exclude::Arguments),
    /// Reveal the conditions; name, time and reason are stored
    Unblind(unblind::Arguments),
    /// Write the table of trials for `nima study trials`
    Table(table::Arguments),
    /// Let simulated participants do the whole study
    Simulate(simulate::Arguments),
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
