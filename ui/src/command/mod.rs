//! The command line of `nima`: one file per subcommand. Failure is one clear line on stderr and a non-zero exit.

mod calibrate;
mod check;
mod console;
pub(crate) mod department;
mod devices;
mod ending;
mod evaluate;
mod export;
mod far;
pub(crate) mod output;
mod replay;
mod report;
pub(crate) mod run;
mod sessions;
pub(crate) mod setup;
mod shells;
pub(crate) mod stretch;
mod train;

use std::process::ExitCode;

use clap::{
    ArgMatches, CommandFactory as _, Parser, Subcommand,
    builder::{PossibleValuesParser, TypedValueParser as _},
    error::{ContextKind, ContextValue},
};
use nima_files::shortened;
use tracing::level_filters::LevelFilter;

use crate::{
    extras,
    logging::{self, LEVELS},
    telling::tell,
};

/// Exit code for "no window can be opened" (`EX_UNAVAILABLE`): the start script falls back to `nima run` on it.
const NO_WINDOW: u8 = 69;

/// Operator console for haptic teleoperation in laparoscopy. Research software, not for clinical use.
#[derive(Debug, Parser)]
#[command(name = "nima", version, max_term_width = 100)]
struct Cli {
    /// Write what background threads report to stderr, with times; the variable `NIMA_LOG` does the same
    #[arg(long, global = true, value_name = "LEVEL", value_parser = PossibleValuesParser::new(LEVELS).try_map(|level| level.parse::<LevelFilter>()))]
    log: Option<LevelFilter>,
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Open the console (also what plain `nima` does)
    Console(console::Arguments),
    /// Run the same control loop without a window, then print its timing and errors
    Run(run::Arguments),
    /// Replay a recorded session through the same loop and compare every tick, or change one thing in it
    Replay(replay::Arguments),
    /// Write a recorded session as a table, or a stretch of it as a session of its own
    Export(export::Arguments),
    /// List the sessions that the console recorded, keep one or delete one
    Sessions(sessions::Arguments),
    /// Write a page that tells what happened in recorded sessions, when, and what went wrong
    Report(report::Arguments),
    /// Rigs of a department: certificates, which are shared, watch and record them from other machines
    #[command(subcommand, arg_required_else_help = false)]
    Department(department::DepartmentCommand),
    /// List connected devices and test them; for each failure, print its cause and what to do
    Devices(devices::Arguments),
    /// Calibrate from a file, or a whole emulated rig; prints errors on held-out data and a verdict
    #[command(subcommand, arg_required_else_help = false)]
    Calibrate(calibrate::CalibrateCommand),
    /// Check whether a rig is ready for the day; keeps a record, and fails if it is not
    #[command(subcommand, arg_required_else_help = false)]
    Check(check::CheckCommand),
    /// Train models from data
    #[command(subcommand, arg_required_else_help = false)]
    Train(train::TrainCommand),
    /// Evaluate models on data that were not used for training
    #[command(subcommand, arg_required_else_help = false)]
    Evaluate(evaluate::EvaluateCommand),
    /// Print the script by which a shell completes the commands and options of `nima`
    Completions(shells::CompletionsArguments),
    /// Write the manual pages of every command into a folder
    Man(shells::ManArguments),
}

/// The command line with what this build adds to it.
fn command_line() -> clap::Command {
    extras::commands(Cli::command())
}

/// Reports invalid arguments in one line, without the usage text.
fn usage(error: &clap::Error) -> ExitCode {
    if let Some(ContextValue::String(name)) = error.get(ContextKind::InvalidSubcommand)
        && let Some(words) = extras::absent_command(&command_line(), name)
    {
        tell(format_args!("nima: {words}"));
        return ExitCode::FAILURE;
    }
    let text = error.to_string();
    let complaint = text.lines().take_while(|line| !line.starts_with("Usage:")).collect::<Vec<_>>().join(" ");
    let complaint = one_line(&complaint);
    let complaint = complaint.trim_start_matches("error: ").trim_end_matches(" For more information, try '--help'.");
    tell(format_args!("nima: {complaint}; see --help"));
    ExitCode::from(2)
}

/// Folds any text of files and devices into one line of bounded length.
fn one_line(text: &str) -> String {
    const MOST: usize = 2000;
    shortened(&text.split_whitespace().collect::<Vec<_>>().join(" "), MOST)
}

/// Runs the command line of this process.
pub fn main() -> ExitCode {
    let given = match command_line().try_get_matches() {
        Ok(given) => given,
        Err(error) if error.use_stderr() => return usage(&error),
        // --help and --version.
        Err(error) => error.exit(),
    };
    logging::begin(given.get_one("log").copied());
    extras::begin();
    let result = extras::part(|extra| extra.run(&given)).unwrap_or_else(|| run_own(&given));
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            // One line: the chain of causes joined, line breaks in foreign messages folded.
            let line = one_line(&format!("{error:#}"));
            if error.is::<crate::console::NoWindow>() {
                tell(format_args!(
                    "nima: no window can be opened ({line}); start it on a desktop, or use `nima run` in this terminal"
                ));
                return ExitCode::from(NO_WINDOW);
            }
            tell(format_args!("nima: {line}"));
            ExitCode::FAILURE
        }
    }
}

/// Runs a command that every build has.
fn run_own(given: &ArgMatches) -> anyhow::Result<()> {
    let command = extras::given(given).transpose()?;
    match command.unwrap_or_else(|| Command::Console(console::Arguments::default())) {
        Command::Console(arguments) => console::run(&arguments),
        Command::Run(arguments) => run::run(&arguments),
        Command::Replay(arguments) => replay::run(&arguments),
        Command::Export(arguments) => export::run(&arguments),
        Command::Sessions(arguments) => sessions::run(&arguments),
        Command::Report(arguments) => report::run(&arguments),
        Command::Department(command) => department::run(&command),
        Command::Devices(arguments) => devices::run(&arguments),
        Command::Calibrate(calibrate) => calibrate::run(&calibrate),
        Command::Check(check) => check::run(&check),
        Command::Train(train) => train::run(&train),
        Command::Evaluate(evaluate) => evaluate::run(&evaluate),
        Command::Completions(arguments) => shells::completions(&arguments),
        Command::Man(arguments) => shells::man(&arguments),
    }
}
