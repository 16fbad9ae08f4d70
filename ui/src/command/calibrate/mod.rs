//! `nima calibrate`: calibrations from files, with their verdict.

mod correspondence;

use clap::Subcommand;

#[derive(Debug, Subcommand)]
pub(super) enum CalibrateCommand {
    /// How the sensor under the tissue is turned against the one at the wrist, from pairs of forces
    Correspondence(correspondence::Arguments),
}

pub(super) fn run(command: &CalibrateCommand) -> anyhow::Result<()> {
    match command {
        CalibrateCommand::Correspondence(arguments) => correspondence::run(arguments),
    }
}
