//! Two machines: the arm is at one, the handle and the screen are at the other.

mod follower;
mod line;
mod link_text;
pub(super) mod network;
mod pair;
mod screen;
mod text;

use clap::{ArgMatches, Subcommand};
use nima_screen::link::ArmLink;

use super::{Extra, given};

pub(super) struct TwoMachines;

#[derive(Debug, Subcommand)]
enum TwoMachineCommand {
    /// Run the arm and its sensor here for a console on another machine (`nima console --follower HOST`)
    Follower(follower::FollowerArguments),
    /// Pair this machine with another one, once: each shows a code to enter on the other
    Pair(pair::PairArguments),
}

impl Extra for TwoMachines {
    fn commands(&self, line: clap::Command) -> clap::Command {
        TwoMachineCommand::augment_subcommands(line)
    }

    fn run(&self, matches: &ArgMatches) -> Option<anyhow::Result<()>> {
        Some(match given(matches)? {
            Ok(TwoMachineCommand::Follower(arguments)) => follower::run(arguments),
            Ok(TwoMachineCommand::Pair(arguments)) => pair::run(&arguments),
            Err(error) => Err(error.into()),
        })
    }

    fn way(&self) -> Option<&'static dyn ArmLink> {
        Some(&network::FollowerNetwork)
    }
}
