//! Training tasks: the score of a run or of a recorded session.

mod score;
pub(super) mod scoring;

use clap::{ArgMatches, Subcommand};
use nima_score::{TaskFile, provide_tasks};
use nima_simulation::{ObjectFeed, SimulationPlan};

use super::{Extra, given};
use crate::scoring::RunScorer;
use scoring::LiveScorer;

pub(super) struct Tasks;

#[derive(Debug, Subcommand)]
enum TaskCommand {
    /// Score recorded sessions: time, path, speed, smoothness and force of each hand; also as a table of trials
    Score(score::ScoreArguments),
}

impl Extra for Tasks {
    fn begin(&self) {
        provide_tasks();
    }

    fn commands(&self, line: clap::Command) -> clap::Command {
        TaskCommand::augment_subcommands(line)
    }

    fn run(&self, matches: &ArgMatches) -> Option<anyhow::Result<()>> {
        Some(match given(matches)? {
            Ok(TaskCommand::Score(arguments)) => score::run(&arguments),
            Err(error) => Err(error.into()),
        })
    }

    fn scorer(
        &self,
        plan: &SimulationPlan,
        watched: &mut Option<ObjectFeed>,
    ) -> Option<anyhow::Result<Box<dyn RunScorer>>> {
        let task = TaskFile::of(plan.scene.task.as_ref()?);
        Some(task.map(|task| Box::new(LiveScorer::new(&task, watched.take())) as _).map_err(Into::into))
    }
}
