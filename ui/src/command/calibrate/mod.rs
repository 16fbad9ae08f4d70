//! `nima calibrate`: calibrations from files, with their verdict.

mod correspondence;
mod gravity;

use clap::Subcommand;

#[derive(Debug, Subcommand)]
pub(super) enum CalibrateCommand {
    /// Take the tool's weight and the sensor's bias out, from still poses
    Gravity(gravity::Arguments),
    /// How the sensor under the tissue is turned against the one at the wrist, from pairs of forces
    Correspondence(correspondence::Arguments),
}

pub(super) fn run(command: &CalibrateCommand) -> anyhow::Result<()> {
    match command {
        CalibrateCommand::Gravity(arguments) => gravity::run(arguments),
        CalibrateCommand::Correspondence(arguments) => correspondence::run(arguments),
    }
}
