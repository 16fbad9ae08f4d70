//! `nima calibrate`: calibrations from files, each with a verdict, or all calibrations of an emulated rig.

mod board;
mod correspondence;
mod gravity;
mod rig;

use std::path::Path;

use clap::Subcommand;
use nima_core::calibration::CalibrationRecord;
use nima_recording::store;
use nima_report::output;

#[derive(Debug, Subcommand)]
pub(super) enum CalibrateCommand {
    /// Find the tool's weight and the sensor's bias from still poses
    Gravity(gravity::GravityArguments),
    /// Find the rotation between the sensor under the tissue and the wrist sensor from pairs of forces
    Correspondence(correspondence::CorrespondenceArguments),
    /// Draw a checkerboard at true size, for printing
    Board(board::CalibrateBoardArguments),
    /// Let the simulated technician of an emulated rig run all its calibrations, and save them (takes a few minutes)
    Rig(rig::CalibrateRigArguments),
}

pub(super) fn run(command: &CalibrateCommand) -> anyhow::Result<()> {
    match command {
        CalibrateCommand::Gravity(arguments) => gravity::run(arguments),
        CalibrateCommand::Correspondence(arguments) => correspondence::run(arguments),
        CalibrateCommand::Board(arguments) => board::run(arguments),
        CalibrateCommand::Rig(arguments) => rig::run(arguments),
    }
}

/// Checks, before the work starts, that a calibration of kind `R` can be written to `out`, and the previous one next to
/// it.
fn check<R: CalibrationRecord>(out: &Path, input: &Path) -> anyhow::Result<()> {
    output::check(out, &[input])?;
    store::check_kind::<R>(out)?;
    if out.exists() { output::check(&store::previous(out), &[input]) } else { Ok(()) }
}
