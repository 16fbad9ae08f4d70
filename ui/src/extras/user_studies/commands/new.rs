//! `nima user-study new`.

use std::path::PathBuf;

use clap::Args;
use nima_report::output;
use serde_json::json;

use crate::extras::user_studies::study::{create, study_file};

#[derive(Debug, Args)]
pub(in crate::extras::user_studies) struct NewStudyArguments {
    /// Study: `paper`, `short`, or a TOML file
    #[arg(value_name = "STUDY")]
    file: String,
    /// Folder for the study; must be new or empty
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Print the result as one JSON object
    #[arg(long)]
    json: bool,
}

pub(super) fn run(arguments: &NewStudyArguments) -> anyhow::Result<()> {
    let NewStudyArguments { file, out, json } = arguments;
    let study = study_file(file)?;
    let made = create(out, &study)?;
    let plan = made.plan();
    let participants = plan.participants.len();
    let rows = plan.rows();
    let balanced = participants.is_multiple_of(rows);
    if *json {
        return output::json(&json!({
            "study": out,
            "participants": participants,
            "labels": plan.labels,
            "balanced": balanced,
            "commitment": plan.commitment,
        }));
    }
    let balance = if balanced {
        format!("each order occurs {} times", participants / rows)
    } else {
        format!("the orders are not balanced: use a multiple of {rows}")
    };
    output::line(&format!(
        "created {}: {participants} participants, {} conditions ({balance}), {} trials for each participant\ncommitment \
         (BLAKE2b-256): {}\nkeep it outside the folder: it proves later that the assignment was not changed",
        out.display(),
        plan.labels.len(),
        plan.trials_of_each(),
        plan.commitment
    ))
}
