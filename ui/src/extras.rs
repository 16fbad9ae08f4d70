//! What this program has beside the console itself. A feature of `Cargo.toml` leaves each out, and this file is the one place that knows which are
//! here: an extra offers its parts through [`Extra`], and whoever needs a part asks for it by its kind.
//!
//! An extra has its files in one folder: `screen` is what the window shows of it, `text` and `words` are its texts.

#[cfg(feature = "bridges")]
mod bridges;
#[cfg(feature = "camera")]
mod camera;
#[cfg(feature = "department")]
mod department;
#[cfg(feature = "lab")]
mod lab;
#[cfg(feature = "live")]
mod live;
#[cfg(feature = "tasks")]
mod tasks;
#[cfg(feature = "two-machines")]
mod two_machines;
#[cfg(feature = "user-studies")]
mod user_studies;

use std::{net::SocketAddr, path::Path};

use clap::{ArgMatches, Subcommand};
use nima_simulation::{Plan, Watched};

use crate::{
    command::department::DepartmentCommand,
    console::{
        page::Page,
        panels::{StripUi, Tile},
        wizards::Wizard,
    },
    link::Way,
    scoring::Scorer,
    truth::Comparison,
    watching::{Server, Show},
};

/// The extras of this build.
const BUILT: &[&dyn Extra] = &[
    #[cfg(feature = "bridges")]
    &bridges::Bridges,
    #[cfg(feature = "camera")]
    &camera::Camera,
    #[cfg(feature = "department")]
    &department::Department,
    #[cfg(feature = "lab")]
    &lab::Lab,
    #[cfg(feature = "live")]
    &live::Live,
    #[cfg(feature = "tasks")]
    &tasks::Tasks,
    #[cfg(feature = "two-machines")]
    &two_machines::TwoMachines,
    #[cfg(feature = "user-studies")]
    &user_studies::UserStudies,
];

/// Commands of extras, with the feature that builds each.
const COMMANDS: [(&str, &str); 9] = [
    ("camera", "camera"),
    ("emulate", "lab"),
    ("follower", "two-machines"),
    ("identify", "lab"),
    ("pair", "two-machines"),
    ("score", "tasks"),
    ("study", "lab"),
    ("study-report", "user-studies"),
    ("user-study", "user-studies"),
];

/// The parts that an extra may offer.
pub(crate) trait Extra: Sync {
    /// Adds its commands to the command line.
    fn commands(&self, line: clap::Command) -> clap::Command {
        line
    }

    /// Runs the command that was given; `None` if it is not one of this extra's.
    fn run(&self, _given: &ArgMatches) -> Option<anyhow::Result<()>> {
        None
    }

    /// Runs a command of `nima department`.
    fn department(&self, _command: &DepartmentCommand) -> Option<anyhow::Result<()>> {
        None
    }

    /// Lets others watch in this way at this address.
    fn server(&self, _show: Show, _at: SocketAddr) -> Option<anyhow::Result<Box<dyn Server>>> {
        None
    }

    /// Sends marks of what happens over the Lab Streaming Layer, by this file of liblsl or [the installed one](crate::watching::INSTALLED).
    fn marks(&self, _library: &Path) -> Option<anyhow::Result<Box<dyn Server>>> {
        None
    }

    /// The way to a machine with the arm.
    fn way(&self) -> Option<&'static dyn Way> {
        None
    }

    /// Called once, before any command runs.
    fn begin(&self) {}

    /// Compares forces with the true ones, which the command `emulate` of this extra tells.
    fn comparison(&self) -> Option<Box<dyn Comparison>> {
        None
    }

    /// The wizard of the endoscope's camera.
    fn camera_wizard(&self) -> Option<fn() -> Box<dyn Wizard>> {
        None
    }

    /// A page of the window that holds the machine while it is used.
    fn page(&self) -> Option<fn() -> Box<dyn Page>> {
        None
    }

    /// The panel of computing time against accuracy.
    fn tradeoff(&self) -> Option<fn() -> Box<dyn Tile>> {
        None
    }

    /// The strip below the gain slider: up to which gain a gripping hand is stable.
    fn stable_gain(&self) -> Option<StripUi> {
        None
    }

    /// Scores the run of a plan with a task; `watched` tells what happens to the objects.
    fn scorer(&self, _plan: &Plan, _watched: &mut Option<Watched>) -> Option<anyhow::Result<Box<dyn Scorer>>> {
        None
    }
}

/// The first part of this kind.
pub(crate) fn part<T>(mut offered: impl FnMut(&'static dyn Extra) -> Option<T>) -> Option<T> {
    BUILT.iter().find_map(|extra| offered(*extra))
}

/// Whether this build can emulate the devices of a rig.
pub(crate) fn emulates() -> bool {
    part(Extra::comparison).is_some()
}

/// Lets every extra begin, before any command runs.
pub(crate) fn begin() {
    for extra in BUILT {
        extra.begin();
    }
}

/// The command line with the commands of the extras.
pub(crate) fn commands(line: clap::Command) -> clap::Command {
    BUILT.iter().fold(line, |line, extra| extra.commands(line))
}

/// The command that a command line gives, if it is one of these.
pub(crate) fn given<C: Subcommand>(matches: &ArgMatches) -> Option<Result<C, clap::Error>> {
    let (name, _) = matches.subcommand()?;
    C::has_subcommand(name).then(|| C::from_arg_matches(matches))
}

/// Why this command is unknown, if another build has it and this command line nowhere does.
pub(crate) fn absent_command(line: &clap::Command, name: &str) -> Option<anyhow::Error> {
    fn has(line: &clap::Command, name: &str) -> bool {
        line.get_subcommands().any(|command| command.get_name() == name || has(command, name))
    }
    let (_, feature) = COMMANDS.into_iter().find(|(known, _)| *known == name)?;
    (!has(line, name)).then(|| not_built(&format!("command `{name}`"), feature))
}

/// What is told of a part that another build has.
pub(crate) fn not_built(what: &str, feature: &str) -> anyhow::Error {
    anyhow::anyhow!(
        "this build has no {what}; build it with `cargo build --release --locked -p nima-console --features {feature}`"
    )
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory as _;

    use super::*;

    #[derive(Debug, clap::Parser)]
    struct Own {
        #[command(subcommand)]
        command: OwnCommand,
    }

    #[derive(Debug, Subcommand)]
    enum OwnCommand {
        /// Its own help
        Calibrate,
    }

    /// A build without an extra can only name the feature of a command that is listed.
    #[test]
    fn every_command_of_an_extra_is_listed() {
        let line = commands(Own::command());
        let own = line.get_subcommands().filter(|command| command.get_name() != "calibrate");
        let below = line.find_subcommand("calibrate").unwrap().get_subcommands();
        let mut known: Vec<&str> = own.chain(below).map(clap::Command::get_name).collect();
        known.sort_unstable();
        assert_eq!(known, COMMANDS.map(|(command, _)| command));
        assert!(absent_command(&line, "camera").is_none() && absent_command(&Own::command(), "camera").is_some());
        let help = line.find_subcommand("calibrate").and_then(clap::Command::get_about).map(ToString::to_string);
        assert_eq!(help.as_deref(), Some("Its own help"));
    }
}
