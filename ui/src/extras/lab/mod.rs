//! The laboratory: emulated devices, studies that print results, and their parts of the window.

mod emulate;
mod ground_truth;
mod identify;
mod recording_input;
mod screen;
mod study;
mod text;

use clap::{ArgMatches, Subcommand};
use nima_panels::{StripUi, Tile};

use super::{Extra, given};
use crate::ground_truth::TruthComparison;

pub(super) struct Lab;

#[derive(Debug, Subcommand)]
enum LabCommand {
    /// Emulate devices on their real interfaces (serial port, network, HID)
    Emulate(emulate::EmulateArguments),
    /// Identify the impedance in a recording, sample by sample, from past data only
    Identify(identify::IdentifyArguments),
    /// Run an experiment and print its results
    #[command(subcommand, arg_required_else_help = false)]
    Study(study::StudyCommand),
}

impl Extra for Lab {
    fn commands(&self, line: clap::Command) -> clap::Command {
        LabCommand::augment_subcommands(line)
    }

    fn run(&self, matches: &ArgMatches) -> Option<anyhow::Result<()>> {
        Some(match given(matches)? {
            Ok(LabCommand::Emulate(arguments)) => emulate::run(&arguments),
            Ok(LabCommand::Identify(arguments)) => identify::run(&arguments),
            Ok(LabCommand::Study(command)) => study::run(&command),
            Err(error) => Err(error.into()),
        })
    }

    fn begin(&self) {
        nima_baselines::provide();
        nima_emulation::emulated::provide_handles();
    }

    fn comparison(&self) -> Option<Box<dyn TruthComparison>> {
        Some(Box::new(ground_truth::TipComparison::default()))
    }

    fn tradeoff(&self) -> Option<fn() -> Box<dyn Tile>> {
        Some(|| Box::new(screen::TradeoffPanel::default()))
    }

    fn stable_gain(&self) -> Option<StripUi> {
        Some(screen::stable_gain_ui)
    }
}
