//! `nima study-report`: the analysis of a user study.

use std::path::PathBuf;

use clap::Args;
use nima_report::output;
use nima_user_study::UserStudy;

use crate::extras::user_studies::report;

#[derive(Debug, Args)]
pub(in crate::extras::user_studies) struct StudyReportArguments {
    /// Folder of the study
    #[arg(value_name = "DIR")]
    study: PathBuf,
    /// Folder for report.html, the tables (CSV) and the scripts for R (default: `report` in the folder of the study)
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Analyse every measure, not only those in the study file
    #[arg(long)]
    all: bool,
}

pub(in crate::extras::user_studies) fn run(arguments: &StudyReportArguments) -> anyhow::Result<()> {
    let StudyReportArguments { study, out, all } = arguments;
    let study = UserStudy::read(study)?;
    let out = out.clone().unwrap_or_else(|| study.folder().join("report"));
    let page = report::write(&study, &out, *all)?;
    output::line(&format!("written: {}", page.display()))
}
