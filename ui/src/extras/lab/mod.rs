//! The laboratory: emulated devices, studies that print results, and their parts of the window.

mod emulate;
mod identify;
mod motion;
mod screen;
mod study;
mod text;
mod truth;

use clap::{ArgMatches, Subcommand};

use super::{Extra, given};
use crate::{
    console::panels::{StripUi, Tile},
    truth::Comparison,
};

pub(super) struct Lab;

#[derive(Debug, Subcommand)]
enum Command {
    /// Emulate devices on their real interfaces (serial port, network, HID)
    Emulate(emulate::Arguments),
    /// Identify impedance on a recording, sample by sample, from past data only
    Identify(identify::Arguments),
    /// Run an experiment and print its results
    #[command(subcommand, arg_required_else_help = false)]
    Study(study::StudyCommand),
}

impl Extra for Lab {
    fn commands(&self, line: clap::Command) -> clap::Command {
        Command::augment_subcommands(line)
    }

    fn run(&self, matches: &ArgMatches) -> Option<anyhow::Result<()>> {
        Some(match given(matches)? {
            Ok(Command::Emulate(arguments)) => emulate::run(&arguments),
            Ok(Command::Identify(arguments)) => identify::run(&arguments),
            Ok(Command::Study(command)) => study::run(&command),
            Err(error) => Err(error.into()),
        })
    }

    fn begin(&self) {
        nima_baselines::provide();
        nima_emulation::emulated::provide_handles();
    }

    fn comparison(&self) -> Option<Box<dyn Comparison>> {
        Some(Box::new(truth::TipComparison::default()))
    }

    fn tradeoff(&self) -> Option<fn() -> Box<dyn Tile>> {
        Some(|| Box::new(screen::Tradeoff::default()))
    }

    fn stable_gain(&self) -> Option<StripUi> {
        Some(screen::stable_gain_ui)
    }
}
