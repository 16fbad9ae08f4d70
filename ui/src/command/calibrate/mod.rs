//! `nima calibrate`: calibrations from recorded files.

mod gravity;

use clap::Subcommand;

#[derive(Debug, Subcommand)]
pub(super) enum CalibrateCommand {
    /// Take the tool's weight and the sensor's bias out, from still poses
    Gravity(gravity::Arguments),
}

pub(super) fn run(command: &CalibrateCommand) -> anyhow::Result<()> {
    match command {
        CalibrateCommand::Gravity(arguments) => gravity::run(arguments),
    }
}
