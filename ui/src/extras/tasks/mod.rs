//! Training tasks: what a run or a recorded session scored.

mod score;
pub(super) mod scoring;

use clap::{ArgMatches, Subcommand};
use nima_world::{Plan, Watched};

use super::{Extra, given};
use crate::scoring::Scorer;
use scoring::Scoring;

/// The extra.
pub(super) struct Tasks;

#[derive(Debug, Subcommand)]
enum Command {
    /// Score recorded sessions: time, path, speed, smoothness, force of each hand; also as a table of trials
    Score(score::Arguments),
}

impl Extra for Tasks {
    fn commands(&self, line: clap::Command) -> clap::Command {
        Command::augment_subcommands(line)
    }

    fn run(&self, matches: &ArgMatches) -> Option<anyhow::Result<()>> {
        Some(match given(matches)? {
            Ok(Command::Score(arguments)) => score::run(&arguments),
            Err(error) => Err(error.into()),
        })
    }

    fn scorer(&self, plan: &Plan, watched: &mut Option<Watched>) -> Option<Box<dyn Scorer>> {
        let task = plan.scene.task.as_ref()?;
        Some(Box::new(Scoring::new(task, watched.take())))
    }
}
