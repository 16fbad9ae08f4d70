//! `nima department`: rigs that others may watch and record. The extra of this name does it.

use std::path::PathBuf;

use clap::{Args, Subcommand};

use super::run::positive_seconds;
use crate::{console::roles::Role, extras, language::Language};

#[derive(Debug, Subcommand)]
pub(crate) enum DepartmentCommand {
    /// Create a department on this machine, which issues the certificates
    Create {
        /// Its name: letters, digits and -
        name: String,
    },
    /// Issue a certificate: a file to carry to a rig or to a machine that watches
    Issue {
        /// Name of that machine: letters, digits and -
        name: String,
        /// It may watch only
        #[arg(long)]
        watcher: bool,
        /// The file
        #[arg(long, value_name = "FILE")]
        out: PathBuf,
    },
    /// Take the certificate that was issued for this machine
    Join {
        /// The file
        file: PathBuf,
    },
    /// List the rigs that are shared now
    Rigs(RigsArguments),
    /// Show a rig of another machine in a window that can do nothing to it
    Monitor(MonitorArguments),
    /// Record the sessions of a rig of another machine into a folder here
    Record(RecordArguments),
}

#[derive(Debug, Args)]
pub(crate) struct RigsArguments {
    /// Ask this address instead of the local network; may be repeated
    #[arg(long, value_name = "HOST[:PORT]")]
    pub(crate) at: Vec<String>,
    /// Print the list as one JSON object
    #[arg(long)]
    pub(crate) json: bool,
}

/// The views of a window that can do nothing to its rig.
fn watching_role(word: &str) -> Result<Role, String> {
    match word {
        "surgeon" => Ok(Role::Surgeon),
        "technician" => Ok(Role::Technician),
        _ => Err("surgeon or technician".to_owned()),
    }
}

/// A rig at another machine.
#[derive(Debug, Args)]
pub(crate) struct Which {
    /// Its name, if several are shared in the local network
    pub(crate) rig: Option<String>,
    /// Its address; without one it is looked for in the local network
    #[arg(long, value_name = "HOST[:PORT]")]
    pub(crate) at: Option<String>,
}

#[derive(Debug, Args)]
pub(crate) struct MonitorArguments {
    #[command(flatten)]
    pub(crate) which: Which,
    /// Start in this view: surgeon or technician
    #[arg(long, value_name = "ROLE", default_value = "surgeon", value_parser = watching_role)]
    pub(crate) role: Role,
    /// Language of the window: en or de (default: the one of the console on this computer)
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
    pub(crate) which: Which,
    /// Folder for the session files
    #[arg(long, value_name = "DIR")]
    pub(crate) into: PathBuf,
    /// Seconds to record (default: until Ctrl-C)
    #[arg(long, value_name = "S", value_parser = positive_seconds)]
    pub(crate) seconds: Option<f64>,
}

pub(super) fn run(command: &DepartmentCommand) -> anyhow::Result<()> {
    extras::part(|extra| extra.department(command))
        .unwrap_or_else(|| Err(extras::not_built("department", "department")))
}
