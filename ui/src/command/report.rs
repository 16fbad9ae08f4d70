//! `nima report`: writes a page about one session, or compares several.

use std::path::PathBuf;

use clap::Args;
use nima_recording::session::SessionReader;
use nima_report as report;
use nima_report::output;
use nima_screen::stderr::print_line;

use super::missing::report_missing;

#[derive(Debug, Args)]
pub(super) struct ReportArguments {
    /// Session files written by `nima run --record` or the console; several are compared
    #[arg(required = true, value_name = "SESSION.mcap")]
    sessions: Vec<PathBuf>,
    /// Write report.html into this folder (created if missing; replaces the file and keeps its permissions; follows links;
    /// rejects input files, devices and pipes)
    #[arg(long, value_name = "DIR", required_unless_present = "json")]
    out: Option<PathBuf>,
    /// Print the results as one JSON object
    #[arg(long)]
    json: bool,
}

pub(super) fn run(arguments: &ReportArguments) -> anyhow::Result<()> {
    let ReportArguments { sessions, out, json } = arguments;
    for session in sessions {
        // A file that cannot be opened is reported below.
        if let Ok(reader) = SessionReader::open(session) {
            report_missing(session, &reader);
        }
    }
    if let (Some(out), false) = (out, json) {
        let page = report::write(sessions, out)?;
        return output::line(&format!("written: {}", page.display()));
    }
    let figures = report::read(sessions)?;
    if let Some(out) = out {
        let page = report::write_figures(&figures, sessions, out)?;
        print_line(format_args!("nima: written: {}", page.display()));
    }
    output::json(&serde_json::json!({ "sessions": figures }))
}
