//! Calibration of the endoscope's camera, from images of a checkerboard.

mod camera_calibration;
mod command;
mod report_text;
mod screen;
mod text;

use clap::{ArgMatches, Subcommand};
use nima_wizards::Wizard;

use super::{Extra, given};
use screen::CameraWizard;

pub(super) struct CameraExtra;

// Addition to `nima calibrate`. A doc comment here would replace that command's help.
#[derive(Debug, Subcommand)]
enum Calibrate {
    /// Calibrate the lens of the endoscope's camera with images of a checkerboard
    Camera(command::CalibrateCameraArguments),
}

impl Extra for CameraExtra {
    fn commands(&self, line: clap::Command) -> clap::Command {
        line.mut_subcommands(|command| {
            if command.get_name() == "calibrate" { Calibrate::augment_subcommands(command) } else { command }
        })
    }

    fn run(&self, matches: &ArgMatches) -> Option<anyhow::Result<()>> {
        let calibrate = matches.subcommand_matches("calibrate")?;
        Some(match given(calibrate)? {
            Ok(Calibrate::Camera(arguments)) => command::run(&arguments),
            Err(error) => Err(error.into()),
        })
    }

    fn camera_wizard(&self) -> Option<fn() -> Box<dyn Wizard>> {
        Some(|| Box::new(CameraWizard::default()))
    }
}
