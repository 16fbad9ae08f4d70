//! `nima user-study table`.

use std::path::PathBuf;

use anyhow::Context as _;
use clap::Args;
use nima_files::write_atomically;
use nima_report::output;
use nima_user_study::{StudyTable, UserStudy};

#[derive(Debug, Args)]
pub(in crate::extras::user_studies) struct StudyTableArguments {
    /// Folder of the study
    #[arg(value_name = "DIR")]
    study: PathBuf,
    /// Table to write (CSV)
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Write the scores of the questionnaires instead of the trials
    #[arg(long)]
    questionnaires: bool,
}

pub(super) fn run(arguments: &StudyTableArguments) -> anyhow::Result<()> {
    let StudyTableArguments { study, out, questionnaires } = arguments;
    let study = UserStudy::read(study)?;
    output::check(out, &[&study.folder().join(nima_user_study::JOURNAL)])?;
    let StudyTable { csv, rows, excluded, missing } =
        if *questionnaires { study.questionnaires() } else { study.trials() };
    write_atomically(out, |file| file.write_all(csv.as_bytes()))
        .with_context(|| format!("cannot write {}", out.display()))?;
    output::line(&format!("{rows} rows in {}", out.display()))?;
    for nima_user_study::Exclusion { participant, trial, why } in excluded {
        let what = trial.map_or_else(|| "everything".to_owned(), |trial| format!("trial {trial}"));
        output::line(&format!("excluded: {participant}, {what}: {why}"))?;
    }
    missing
        .iter()
        .try_for_each(|(participant, trial)| output::line(&format!("without a result: {participant}, trial {trial}")))
}
