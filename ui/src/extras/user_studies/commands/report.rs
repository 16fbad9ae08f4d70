//! `nima study-report`: the analysis of a user study.

use std::path::PathBuf;

use clap::Args;
use nima_user_study::Study;

use super::output;
use crate::study_report;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// The folder of the study
    #[arg(value_name = "DIR")]
    study: PathBuf,
    /// Where to write report.html, the tables (CSV) and the scripts for R (default: `report` in the folder of the study)
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Every measure, not only those that the study file named
    #[arg(long)]
    all: bool,
}

pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let Arguments { study, out, all } = arguments;
    let study = Study::read(study)?;
    let out = out.clone().unwrap_or_else(|| study.folder().join("report"));
    let page = study_report::write(&study, &out, *all)?;
    output::line(&format!("written: {}", page.display()))
}
