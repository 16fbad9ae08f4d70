//! User studies: orders, blind conditions, trials, questionnaires, and their analysis.

mod commands;
mod report;
mod screen;
mod study;
mod text;

use clap::{ArgMatches, Subcommand};

use super::{Extra, given};
use crate::console::page::Page;

pub(super) struct UserStudies;

#[derive(Debug, Subcommand)]
enum UserStudiesCommand {
    /// Run a user study: orders, blind conditions, trials, questionnaires
    #[command(subcommand, arg_required_else_help = false)]
    UserStudy(commands::UserStudyCommand),
    /// Analyse a user study: one page with tables and plots, the tables as CSV, and a script for R
    StudyReport(commands::report::StudyReportArguments),
}

impl Extra for UserStudies {
    fn commands(&self, line: clap::Command) -> clap::Command {
        UserStudiesCommand::augment_subcommands(line)
    }

    fn run(&self, matches: &ArgMatches) -> Option<anyhow::Result<()>> {
        Some(match given(matches)? {
            Ok(UserStudiesCommand::UserStudy(command)) => commands::run(&command),
            Ok(UserStudiesCommand::StudyReport(arguments)) => commands::report::run(&arguments),
            Err(error) => Err(error.into()),
        })
    }

    fn page(&self) -> Option<fn() -> Box<dyn Page>> {
        Some(|| Box::new(screen::Studies::default()))
    }
}
