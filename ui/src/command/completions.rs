//! `nima completions` and `nima man`: files for packages, generated from the definition of the command line.

use std::path::{Path, PathBuf};

use anyhow::Context as _;
use clap::{Args, Command};
use clap_complete::Shell;
use nima_report::output;

use super::command_line;

const NAME: &str = "nima";

#[derive(Debug, Args)]
pub(super) struct CompletionsArguments {
    /// Shell to complete for
    shell: Shell,
}

#[derive(Debug, Args)]
pub(super) struct ManArguments {
    /// Folder for the pages, one per command: nima.1, nima-run.1 and so on
    #[arg(value_name = "DIR")]
    folder: PathBuf,
}

pub(super) fn completions(arguments: &CompletionsArguments) -> anyhow::Result<()> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut command_line(), NAME, &mut script);
    output::line(String::from_utf8_lossy(&script).trim_end())
}

pub(super) fn man(arguments: &ManArguments) -> anyhow::Result<()> {
    // The pages of `help` only repeat the others.
    let mut command = command_line().disable_help_subcommand(true);
    command.build();
    std::fs::create_dir_all(&arguments.folder)
        .with_context(|| format!("cannot create the folder {}", arguments.folder.display()))?;
    pages(&arguments.folder, &command)
}

/// Writes the pages of a command and its subcommands.
fn pages(folder: &Path, command: &Command) -> anyhow::Result<()> {
    for below in command.get_subcommands().filter(|below| !below.is_hide_set()) {
        pages(folder, below)?;
    }
    let name = command.get_display_name().unwrap_or_else(|| command.get_name()).to_owned();
    let mut page = Vec::new();
    let version = concat!("nima ", env!("CARGO_PKG_VERSION"));
    clap_mangen::Man::new(command.clone()).title(&name).source(version).render(&mut page)?;
    output::write(folder, &format!("{name}.1"), &String::from_utf8_lossy(&page))
}
