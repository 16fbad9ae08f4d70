//! The command line of `nima`: one file per subcommand. Failure is one clear line on stderr and a non-zero exit.

mod calibrate;
mod check;
mod console;
pub(crate) mod department;
mod devices;
mod emulate;
mod ending;
mod evaluate;
mod export;
mod follower;
mod identify;
mod motion;
mod network;
pub(crate) mod output;
mod pair;
mod replay;
mod report;
mod run;
mod score;
mod sessions;
mod setup;
mod shells;
mod stretch;
mod study;
mod study_report;
mod train;
pub(crate) mod truth;
mod user_study;

use std::process::ExitCode;

use clap::{Parser, Subcommand};
use nima_files::shortened;

use crate::telling::tell;

/// Exit code for "no window can be opened" (`EX_UNAVAILABLE`): the start script falls back to `nima run` on it.
const NO_WINDOW: u8 = 69;

/// Operator console for haptic teleoperation in laparoscopy. Research software, not for clinical use.
#[derive(Debug, Parser)]
#[command(name = "nima", version, max_term_width = 100)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Open the console (also what plain `nima` does)
    Console(console::Arguments),
    /// Run the same control loop without a window, then print its timing and errors
    Run(run::Arguments),
    /// Run the arm and its sensor here for a console at another machine (`nima console --follower HOST`)
    Follower(follower::Arguments),
    /// Pair this machine with another one, once, by a code that both show
    Pair(pair::Arguments),
    /// Replay a recorded session through the same loop and compare every tick, or change one thing in it
    Replay(replay::Arguments),
    /// Write a recorded session as a table, or a stretch of it as a session of its own
    Export(export::Arguments),
    /// List the sessions that the console recorded, keep one or delete one
    Sessions(sessions::Arguments),
    /// Write a page that tells what happened in recorded sessions, when, and what went wrong
    Report(report::Arguments),
    /// Score recorded sessions: time, path, speed, smoothness, force of each hand; also as a table of trials
    Score(score::Arguments),
    /// Identify impedance on a recording, sample by sample, from past data only
    Identify(identify::Arguments),
    /// Rigs of a department: certificates, which are shared, watch and record them from other machines
    #[command(subcommand, arg_required_else_help = false)]
    Department(department::DepartmentCommand),
    /// List connected devices and test them; for each failure, print its cause and what to do
    Devices(devices::Arguments),
    /// Emulate devices on their real interfaces (serial port, network, HID)
    Emulate(emulate::Arguments),
    /// Calibrate from a file, or a whole emulated rig; prints errors on held-out data and a verdict
    #[command(subcommand, arg_required_else_help = false)]
    Calibrate(calibrate::CalibrateCommand),
    /// Check whether a rig is ready for the day; keeps a record, and fails if it is not
    #[command(subcommand, arg_required_else_help = false)]
    Check(check::CheckCommand),
    /// Run an experiment and print its results
    #[command(subcommand, arg_required_else_help = false)]
    Study(study::StudyCommand),
    /// Run a user study: orders, blind conditions, trials, questionnaires
    #[command(subcommand, arg_required_else_help = false)]
    UserStudy(user_study::UserStudyCommand),
    /// Analyse a user study: one page with tables and pictures, the tables as CSV, and a script for R
    StudyReport(study_report::Arguments),
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

/// Reports invalid arguments in one line, without the usage text.
fn usage(error: &clap::Error) -> ExitCode {
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
    let command = match Cli::try_parse() {
        Ok(cli) => cli.command.unwrap_or_else(|| Command::Console(console::Arguments::default())),
        Err(error) if error.use_stderr() => return usage(&error),
        // --help and --version.
        Err(error) => error.exit(),
    };
    nima_emulation::emulated::provide_handles();
    nima_score::provide_tasks();
    let result = match command {
        Command::Console(arguments) => console::run(&arguments),
        Command::Run(arguments) => run::run(&arguments),
        Command::Follower(arguments) => follower::run(arguments),
        Command::Pair(arguments) => pair::run(&arguments),
        Command::Replay(arguments) => replay::run(&arguments),
        Command::Export(arguments) => export::run(&arguments),
        Command::Sessions(arguments) => sessions::run(&arguments),
        Command::Report(arguments) => report::run(&arguments),
        Command::Score(arguments) => score::run(&arguments),
        Command::Identify(arguments) => identify::run(&arguments),
        Command::Department(command) => department::run(&command),
        Command::Devices(arguments) => devices::run(&arguments),
        Command::Emulate(arguments) => emulate::run(&arguments),
        Command::Calibrate(calibrate) => calibrate::run(&calibrate),
        Command::Check(check) => check::run(&check),
        Command::Study(study) => study::run(&study),
        Command::UserStudy(study) => user_study::run(&study),
        Command::StudyReport(arguments) => study_report::run(&arguments),
        Command::Train(train) => train::run(&train),
        Command::Evaluate(evaluate) => evaluate::run(&evaluate),
        Command::Completions(arguments) => shells::completions(&arguments),
        Command::Man(arguments) => shells::man(&arguments),
    };
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
