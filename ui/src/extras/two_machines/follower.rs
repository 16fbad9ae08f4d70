//! `nima follower`: the arm and its sensor on this machine, for a console on another one.

use std::path::PathBuf;

use clap::Args;
use nima_machine::config::SchedulingClass;
use nima_screen::stderr::print_line;

use super::network;
use crate::{
    command::{rig_args::Setup, run},
    watching::WatchArguments,
};

#[derive(Debug, Args)]
pub(super) struct FollowerArguments {
    #[command(flatten)]
    setup: Setup,
    /// Address of this machine to listen on (default: only consoles on this machine)
    #[arg(long, value_name = "ADDRESS[:PORT]")]
    listen: Option<String>,
    /// Seconds to run (default: until Ctrl-C)
    #[arg(long, value_name = "S", value_parser = run::positive_seconds, allow_negative_numbers = true)]
    seconds: Option<f64>,
    /// Scheduling class to request for the loop: ordinary, fifo or deadline (default: the rig's)
    #[arg(long, value_name = "CLASS")]
    scheduling: Option<SchedulingClass>,
    /// Record the session of this machine into a new file
    #[arg(long, value_name = "FILE.mcap")]
    record: Option<PathBuf>,
    #[command(flatten)]
    watching: WatchArguments,
    /// Print the results as one JSON object
    #[arg(long)]
    json: bool,
}

pub(super) fn run(arguments: FollowerArguments) -> anyhow::Result<()> {
    let at = network::listening(arguments.listen.as_deref())?;
    let FollowerArguments { setup, seconds, scheduling, record, watching, json, .. } = arguments;
    // The console determines the rendering.
    let run = run::RunArguments { setup, seconds, scheduling, record, watching, json, ..run::RunArguments::default() };
    run::run_with(&run, |rig, scene| {
        let line = network::listen(rig, scene, at)?;
        print_line(format_args!("the follower listens at {at}"));
        Ok(Some(line))
    })
}
