//! Two machines: the arm is at one, the handle and the screen are at the other.

mod follower;
mod line;
pub(super) mod network;
mod pair;
mod screen;
mod text;
mod words;

use clap::{ArgMatches, Subcommand};

use super::{Extra, given};
use crate::link::Way;

pub(super) struct TwoMachines;

#[derive(Debug, Subcommand)]
enum Command {
    /// Run the arm and its sensor here for a console at another machine (`nima console --follower HOST`)
    Follower(follower::Arguments),
    /// Pair this machine with another one, once, by a code that both show
    Pair(pair::Arguments),
}

impl Extra for TwoMachines {
    fn commands(&self, line: clap::Command) -> clap::Command {
        Command::augment_subcommands(line)
    }

    fn run(&self, matches: &ArgMatches) -> Option<anyhow::Result<()>> {
        Some(match given(matches)? {
            Ok(Command::Follower(arguments)) => follower::run(arguments),
            Ok(Command::Pair(arguments)) => pair::run(&arguments),
            Err(error) => Err(error.into()),
        })
    }

    fn way(&self) -> Option<&'static dyn Way> {
        Some(&network::Network)
    }
}
