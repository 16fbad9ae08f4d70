//! `nima user-study`: a study from its file to the last questionnaire. A file for each subcommand.

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
    /// Make the folder of a study: pseudonyms, orders, sealed conditions
    New(new::Arguments),
    /// Tell who has done what, and what comes next
    Status(status::Arguments),
    /// Do the next step of a participant
    Next(next::Arguments),
    /// Keep a note in the journal
    Note(note::Arguments),
    /// Leave a participant, or one trial, out of the analysis
    Exclude(exclude::Arguments),
    /// Open the conditions; who, when and why is kept
    Unblind(unblind::Arguments),
    /// Write the table of trials for `nima study trials`
    Table(table::Arguments),
    /// Let simulated people do the whole study
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
