//! The parts that this extra adds to the console.

use std::net::SocketAddr;

use clap::{ArgMatches, Subcommand};
use nima_console::{
    extras::{Extra, given},
    watching::{Show, WatchServer},
};
use nima_endoscope::FrameQueue;
use nima_screen::stderr::print_line;
use nima_session::sinks::Audience;
use nima_simulation::SimulationPlan;
use nima_words::text::current_session::WatchStatus;

use crate::{SharedRig, arguments::DepartmentCommand, commands};

/// View and record the rigs of a department from other machines.
pub struct Department;

#[derive(Debug, Subcommand)]
enum AddedCommand {
    /// Manage the rigs of a department: certificates, shared rigs, remote viewing and recording
    #[command(subcommand, arg_required_else_help = false)]
    Department(DepartmentCommand),
}

impl Extra for Department {
    fn commands(&self, line: clap::Command) -> clap::Command {
        AddedCommand::augment_subcommands(line)
    }

    fn run(&self, matches: &ArgMatches) -> Option<anyhow::Result<()>> {
        Some(match given(matches)? {
            Ok(AddedCommand::Department(command)) => commands::run(&command),
            Err(error) => Err(error.into()),
        })
    }

    fn server(&self, show: Show, at: SocketAddr) -> Option<anyhow::Result<Box<dyn WatchServer>>> {
        (show == Show::Share).then(|| share_at(at))
    }
}

impl WatchServer for SharedRig {
    fn audience(&self, _: &SimulationPlan, _: &FrameQueue) -> Box<dyn Audience> {
        self.audience()
    }

    fn shown(&self) -> WatchStatus {
        WatchStatus { at: format!("{} ({})", self.address(), self.name()), watchers: self.watchers() }
    }
}

fn share_at(address: SocketAddr) -> anyhow::Result<Box<dyn WatchServer>> {
    let own = commands::own_identity()?;
    let share = SharedRig::start(&own, address, !address.ip().is_loopback())?;
    print_line(format_args!(
        "nima: shared with department {} as {} at {}",
        own.department,
        share.name(),
        share.address()
    ));
    Ok(Box::new(share))
}
