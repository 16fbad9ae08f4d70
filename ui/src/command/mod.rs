//! The command line of `nima`: one file per subcommand. A failure prints one clear line on stderr and exits with a non-zero
//! status.

mod calibrate;
mod check;
mod completions;
mod console;
mod devices;
mod evaluate;
mod export;
pub(crate) mod missing;
mod remote_follower;
mod replay;
mod report;
pub(crate) mod rig_args;
pub(crate) mod run;
mod run_outcome;
mod sessions;
pub(crate) mod time_range;
mod train;

use std::process::ExitCode;

use clap::{
    ArgMatches, CommandFactory as _, Parser, Subcommand,
    builder::{PossibleValuesParser, TypedValueParser as _},
    error::{ContextKind, ContextValue},
};
use nima_files::shortened;
use nima_screen::stderr::print_line;
pub use run::positive_seconds;
use tracing::level_filters::LevelFilter;

use crate::{
    extras::{self, Extra},
    logging::{self, LEVELS},
};

/// Exit code if no window can be opened (`EX_UNAVAILABLE`): the start script then runs `nima run`.
const NO_WINDOW: u8 = 69;

/// Operator console for haptic teleoperation in laparoscopy. Research software, not for clinical use.
#[derive(Debug, Parser)]
#[command(name = "nima", version, max_term_width = 100)]
struct Cli {
    /// Write the log messages of background threads to stderr, with times; the environment variable `NIMA_LOG` does the
    /// same
    #[arg(long, global = true, value_name = "LEVEL", value_parser = PossibleValuesParser::new(LEVELS).try_map(|level| level.parse::<LevelFilter>()))]
    log: Option<LevelFilter>,
    #[command(subcommand)]
    command: Option<CliCommand>,
}

#[derive(Debug, Subcommand)]
enum CliCommand {
    /// Open the console (also the default without a command)
    Console(console::ConsoleArguments),
    /// Show a recording of this or another program in playback; missing signals are unknown
    View(console::ViewArguments),
    /// Run the control loop without a window, then print its timing and errors
    Run(run::RunArguments),
    /// Replay a recorded session through the same loop: compare every tick, or show the effect of other settings
    Replay(replay::ReplayArguments),
    /// Export a recorded session as a table, or an excerpt of it as a separate session
    Export(export::ExportArguments),
    /// List, keep or delete recorded sessions
    Sessions(sessions::SessionsArguments),
    /// Write a report page about recorded sessions: events, times and problems
    Report(report::ReportArguments),
    /// List connected devices and test them; print cause and remedy of each problem
    Devices(devices::DevicesArguments),
    /// Calibrate from a file, or calibrate a whole emulated rig; print held-out errors and a verdict
    #[command(subcommand, arg_required_else_help = false)]
    Calibrate(calibrate::CalibrateCommand),
    /// Check whether a rig is ready for the day, and save a record; the exit status is 1 if the rig is not ready
    #[command(subcommand, arg_required_else_help = false)]
    Check(check::CheckCommand),
    /// Train models on data
    #[command(subcommand, arg_required_else_help = false)]
    Train(train::TrainCommand),
    /// Evaluate models on data that were not used for training
    #[command(subcommand, arg_required_else_help = false)]
    Evaluate(evaluate::EvaluateCommand),
    /// Print the shell script that completes the commands and options of `nima`
    Completions(completions::CompletionsArguments),
    /// Write the manual pages of all commands into a folder
    Man(completions::ManArguments),
}

/// Returns the command line, with the commands of this build's extras.
fn command_line() -> clap::Command {
    extras::commands(Cli::command())
}

/// Reports invalid arguments in one line, without the usage text.
fn usage(error: &clap::Error) -> ExitCode {
    if let Some(ContextValue::String(name)) = error.get(ContextKind::InvalidSubcommand)
        && let Some(words) = extras::absent_command(&command_line(), name)
    {
        print_line(format_args!("nima: {words}"));
        return ExitCode::FAILURE;
    }
    let text = error.to_string();
    let complaint = text.lines().take_while(|line| !line.starts_with("Usage:")).collect::<Vec<_>>().join(" ");
    let complaint = one_line(&complaint);
    let complaint = complaint.trim_start_matches("error: ").trim_end_matches(" For more information, try '--help'.");
    print_line(format_args!("nima: {complaint}; see --help"));
    ExitCode::from(2)
}

/// Folds text from files and devices into one line of limited length.
fn one_line(text: &str) -> String {
    const MAX: usize = 2000;
    shortened(&text.split_whitespace().collect::<Vec<_>>().join(" "), MAX)
}

/// Runs the command line of this process, with the extras that a program outside the workspace adds.
pub fn main(added: &'static [&'static dyn Extra]) -> ExitCode {
    extras::add(added);
    let given = match command_line().try_get_matches() {
        Ok(given) => given,
        Err(error) if error.use_stderr() => return usage(&error),
        // `--help` and `--version` end up here, too.
        Err(error) => error.exit(),
    };
    logging::begin(given.get_one("log").copied());
    #[cfg(unix)]
    nima_devices::os::survive_file_size_limit();
    extras::begin();
    let result = extras::part(|extra| extra.run(&given)).unwrap_or_else(|| run_own(&given));
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            // Print one line: join the chain of causes, and fold line breaks in foreign messages.
            let line = one_line(&format!("{error:#}"));
            if error.is::<crate::console::NoWindow>() {
                print_line(format_args!(
                    "nima: cannot open a window ({line}); start nima on a desktop, or use `nima run` in this \
                     terminal"
                ));
                return ExitCode::from(NO_WINDOW);
            }
            print_line(format_args!("nima: {line}"));
            ExitCode::FAILURE
        }
    }
}

/// Runs a command that every build has.
fn run_own(given: &ArgMatches) -> anyhow::Result<()> {
    let command = extras::given(given).transpose()?;
    match command.unwrap_or_else(|| CliCommand::Console(console::ConsoleArguments::default())) {
        CliCommand::Console(arguments) => console::run(&arguments),
        CliCommand::View(arguments) => console::view(arguments),
        CliCommand::Run(arguments) => run::run(&arguments),
        CliCommand::Replay(arguments) => replay::run(&arguments),
        CliCommand::Export(arguments) => export::run(&arguments),
        CliCommand::Sessions(arguments) => sessions::run(&arguments),
        CliCommand::Report(arguments) => report::run(&arguments),
        CliCommand::Devices(arguments) => devices::run(&arguments),
        CliCommand::Calibrate(calibrate) => calibrate::run(&calibrate),
        CliCommand::Check(check) => check::run(&check),
        CliCommand::Train(train) => train::run(&train),
        CliCommand::Evaluate(evaluate) => evaluate::run(&evaluate),
        CliCommand::Completions(arguments) => completions::completions(&arguments),
        CliCommand::Man(arguments) => completions::man(&arguments),
    }
}
