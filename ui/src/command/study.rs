//! `nima study`: experiments that print figures.

use clap::Subcommand;

use super::tradeoff;

#[derive(Debug, Subcommand)]
pub(super) enum StudyCommand {
    /// What every knob of the identification costs in time and gives in accuracy
    Tradeoff(tradeoff::Arguments),
}

pub(super) fn run(command: &StudyCommand) -> anyhow::Result<()> {
    match command {
        StudyCommand::Tradeoff(arguments) => tradeoff::run(arguments),
    }
}
