//! The optional parts of this program. A feature of `Cargo.toml` controls each of them, and only this file lists those in the
//! build: an extra offers its parts through [`Extra`], and callers request a part by its kind. An extra with very large
//! libraries is a program outside the workspace instead, which adds itself (`src/extras/department/`).
//!
//! An extra has its files in one folder: `screen` is its part of the window, `text` and `words` are its texts.

#[cfg(feature = "bridges")]
mod bridges;
#[cfg(feature = "camera")]
mod camera;
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

use std::{net::SocketAddr, path::Path, sync::OnceLock};

use clap::{ArgMatches, Subcommand};
use nima_panels::{PanelExtras, StripUi, Tile};
use nima_screen::link::ArmLink;
use nima_simulation::{ObjectFeed, SimulationPlan};
use nima_wizards::{Wizard, offer_camera};

use crate::{
    console::page::Page,
    ground_truth::TruthComparison,
    scoring::RunScorer,
    watching::{Show, WatchServer},
};

const BUILT: &[&dyn Extra] = &[
    #[cfg(feature = "bridges")]
    &bridges::Bridges,
    #[cfg(feature = "camera")]
    &camera::CameraExtra,
    #[cfg(feature = "lab")]
    &lab::Lab,
    #[cfg(feature = "live")]
    &live::LiveExtra,
    #[cfg(feature = "tasks")]
    &tasks::Tasks,
    #[cfg(feature = "two-machines")]
    &two_machines::TwoMachines,
    #[cfg(feature = "user-studies")]
    &user_studies::UserStudies,
];

/// Extras that a program outside the workspace adds.
static ADDED: OnceLock<&'static [&'static dyn Extra]> = OnceLock::new();

/// Extra that is a separate program instead of a feature.
pub(crate) const DEPARTMENT: &str = "department";

/// Commands of extras, with the feature that builds each.
const COMMANDS: [(&str, &str); 10] = [
    ("camera", "camera"),
    (DEPARTMENT, DEPARTMENT),
    ("emulate", "lab"),
    ("follower", "two-machines"),
    ("identify", "lab"),
    ("pair", "two-machines"),
    ("score", "tasks"),
    ("study", "lab"),
    ("study-report", "user-studies"),
    ("user-study", "user-studies"),
];

/// Parts that an extra can offer.
pub trait Extra: Sync {
    /// Adds its commands to the command line.
    fn commands(&self, line: clap::Command) -> clap::Command {
        line
    }

    /// Runs the given command; `None` if the command does not belong to this extra.
    fn run(&self, _given: &ArgMatches) -> Option<anyhow::Result<()>> {
        None
    }

    /// Serves viewers of this kind at this address.
    fn server(&self, _show: Show, _at: SocketAddr) -> Option<anyhow::Result<Box<dyn WatchServer>>> {
        None
    }

    /// Sends event marks over the Lab Streaming Layer, with this file of liblsl; `liblsl` is the installed one.
    fn marks(&self, _library: &Path) -> Option<anyhow::Result<Box<dyn WatchServer>>> {
        None
    }

    /// Returns the connection to a machine with the arm.
    fn way(&self) -> Option<&'static dyn ArmLink> {
        None
    }

    /// Called once, before any command runs.
    fn begin(&self) {}

    /// Compares forces with the true forces, which this extra's command `emulate` reports.
    fn comparison(&self) -> Option<Box<dyn TruthComparison>> {
        None
    }

    fn camera_wizard(&self) -> Option<fn() -> Box<dyn Wizard>> {
        None
    }

    /// Returns a page of the window that reserves the machine while it is open.
    fn page(&self) -> Option<fn() -> Box<dyn Page>> {
        None
    }

    /// Returns the Trade-off panel.
    fn tradeoff(&self) -> Option<fn() -> Box<dyn Tile>> {
        None
    }

    /// Returns the strip below the gain slider that shows the highest gain at which a gripping hand is stable.
    fn stable_gain(&self) -> Option<StripUi> {
        None
    }

    /// Scores the run of a plan with a task; `watched` reports the events of the objects.
    fn scorer(
        &self,
        _plan: &SimulationPlan,
        _watched: &mut Option<ObjectFeed>,
    ) -> Option<anyhow::Result<Box<dyn RunScorer>>> {
        None
    }
}

/// Adds extras of a program outside the workspace; only the first call has an effect.
pub(crate) fn add(added: &'static [&'static dyn Extra]) {
    ADDED.get_or_init(|| added);
}

fn all() -> impl Iterator<Item = &'static dyn Extra> {
    BUILT.iter().chain(ADDED.get().copied().unwrap_or_default()).copied()
}

/// Returns the first part of this kind.
pub(crate) fn part<T>(offered: impl FnMut(&'static dyn Extra) -> Option<T>) -> Option<T> {
    all().find_map(offered)
}

/// Returns whether this build can emulate the devices of a rig.
pub(crate) fn emulates() -> bool {
    part(Extra::comparison).is_some()
}

/// Gives the window the parts of extras.
pub(crate) fn offer() {
    if let Some(wizard) = part(Extra::camera_wizard) {
        offer_camera(wizard);
    }
    let has_link = part(Extra::way).is_some();
    let extras = PanelExtras { tradeoff: part(Extra::tradeoff), stable_gain: part(Extra::stable_gain), has_link };
    extras.offer();
}

pub(crate) fn begin() {
    offer();
    all().for_each(Extra::begin);
}

/// Adds the commands of all extras.
pub(crate) fn commands(line: clap::Command) -> clap::Command {
    all().fold(line, |line, extra| extra.commands(line))
}

/// Returns the given command if it belongs to `C`.
pub fn given<C: Subcommand>(matches: &ArgMatches) -> Option<Result<C, clap::Error>> {
    let (name, _) = matches.subcommand()?;
    C::has_subcommand(name).then(|| C::from_arg_matches(matches))
}

/// Returns the error for a command that another build has and this command line has nowhere.
pub(crate) fn absent_command(line: &clap::Command, name: &str) -> Option<anyhow::Error> {
    fn has(line: &clap::Command, name: &str) -> bool {
        line.get_subcommands().any(|command| command.get_name() == name || has(command, name))
    }
    let (_, feature) = COMMANDS.into_iter().find(|(known, _)| *known == name)?;
    (!has(line, name)).then(|| not_built(&format!("command `{name}`"), feature))
}

/// Returns the error for a part that another build or program has.
pub(crate) fn not_built(what: &str, feature: &str) -> anyhow::Error {
    const SEPARATE: &str = "--manifest-path src/extras/department/Cargo.toml";
    let build = "cargo build --release --locked";
    if feature == DEPARTMENT {
        return anyhow::anyhow!(
            "this program has no {what}; `{build} {SEPARATE}` builds the one that has it, in src/extras/department/target/release"
        );
    }
    let is_separate = ADDED.get().is_some_and(|added| !added.is_empty());
    let package = if is_separate { SEPARATE } else { "-p nima-console" };
    anyhow::anyhow!("this build has no {what}; build it with `{build} {package} --features {feature}`")
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

    /// A build without an extra can name the feature only of a listed command.
    #[test]
    fn every_command_of_an_extra_is_listed() {
        let line = commands(Own::command());
        let own = line.get_subcommands().filter(|command| command.get_name() != "calibrate");
        let below = line.find_subcommand("calibrate").unwrap().get_subcommands();
        let mut known: Vec<&str> = own.chain(below).map(clap::Command::get_name).collect();
        known.sort_unstable();
        let listed = COMMANDS.map(|(command, _)| command);
        let listed: Vec<&str> = listed.into_iter().filter(|command| *command != DEPARTMENT).collect();
        assert_eq!(known, listed);
        assert!(absent_command(&line, "camera").is_none() && absent_command(&Own::command(), "camera").is_some());
        let help = line.find_subcommand("calibrate").and_then(clap::Command::get_about).map(ToString::to_string);
        assert_eq!(help.as_deref(), Some("Its own help"));
    }
}
