//! `nima check`: whether a rig is ready for the day.

mod rig;

use clap::Subcommand;

#[derive(Debug, Subcommand)]
pub(super) enum CheckCommand {
    /// Run the ready check of an emulated or simulated rig (about a minute), and save its record
    Rig(rig::CheckRigArguments),
}

pub(super) fn run(command: &CheckCommand) -> anyhow::Result<()> {
    match command {
        CheckCommand::Rig(arguments) => rig::run(arguments),
    }
}
