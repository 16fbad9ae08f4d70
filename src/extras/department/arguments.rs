//! The arguments of `nima department`.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use nima_console::command::positive_seconds;
use nima_panels::roles::Role;
use nima_words::language::Language;

#[derive(Debug, Subcommand)]
pub(crate) enum DepartmentCommand {
    /// Create a department on this machine, which then issues the certificates
    Create {
        /// Name of the department: letters, digits and -
        name: String,
    },
    /// Issue a certificate: a file for a rig or for a viewing machine
    Issue {
        /// Name of that machine: letters, digits and -
        name: String,
        /// Allow viewing only
        #[arg(long)]
        watcher: bool,
        /// Certificate file to write
        #[arg(long, value_name = "FILE")]
        out: PathBuf,
    },
    /// Install the certificate issued for this machine
    Join {
        /// Certificate file
        file: PathBuf,
    },
    /// List the rigs that are shared now
    Rigs(RigsArguments),
    /// Show a rig of another machine in a view-only window
    Monitor(MonitorArguments),
    /// Record the sessions of a rig of another machine into a local folder
    Record(RecordArguments),
}

#[derive(Debug, Args)]
pub(crate) struct RigsArguments {
    /// Query this address instead of the local network; may be repeated
    #[arg(long, value_name = "HOST[:PORT]")]
    pub(crate) at: Vec<String>,
    /// Print the list as one JSON object
    #[arg(long)]
    pub(crate) json: bool,
}

/// Parses the role of a view-only window.
fn watching_role(word: &str) -> Result<Role, String> {
    match word {
        "surgeon" => Ok(Role::Surgeon),
        "technician" => Ok(Role::Technician),
        _ => Err("surgeon or technician".to_owned()),
    }
}

#[derive(Debug, Args)]
pub(crate) struct RigSelection {
    /// Name of the rig, if several are shared on the local network
    pub(crate) rig: Option<String>,
    /// Address of the rig (default: search the local network)
    #[arg(long, value_name = "HOST[:PORT]")]
    pub(crate) at: Option<String>,
}

#[derive(Debug, Args)]
pub(crate) struct MonitorArguments {
    #[command(flatten)]
    pub(crate) which: RigSelection,
    /// Start in this view: surgeon or technician
    #[arg(long, value_name = "ROLE", default_value = "surgeon", value_parser = watching_role)]
    pub(crate) role: Role,
    /// Language of the window: en or de (default: the language of the console on this computer)
    #[arg(long, value_name = "LANGUAGE", hide_possible_values = true)]
    pub(crate) language: Option<Language>,
    /// Close after this many seconds
    #[arg(long, visible_alias = "seconds", value_name = "S", value_parser = positive_seconds)]
    pub(crate) exit_after: Option<f64>,
    /// Save a screenshot (PNG) just before closing; needs --exit-after
    #[arg(long, value_name = "FILE", requires = "exit_after")]
    pub(crate) screenshot: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct RecordArguments {
    #[command(flatten)]
    pub(crate) which: RigSelection,
    /// Folder for the session files
    #[arg(long, value_name = "DIR")]
    pub(crate) into: PathBuf,
    /// Seconds to record (default: until Ctrl-C)
    #[arg(long, value_name = "S", value_parser = positive_seconds)]
    pub(crate) seconds: Option<f64>,
}
