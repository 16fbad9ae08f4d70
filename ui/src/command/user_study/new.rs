//! `nima user-study new`.

use std::path::PathBuf;

use anyhow::Context as _;
use clap::Args;
use nima_machine::config::RigConfig;
use nima_recording::store::utc_now;
use nima_user_study::Study;
use serde_json::json;

use crate::{
    command::output,
    user_study::{scene_of, study_file, under},
};

#[derive(Debug, Args)]
pub(in crate::command) struct Arguments {
    /// Study: `paper`, `short`, or a TOML file
    #[arg(value_name = "STUDY")]
    file: String,
    /// The folder, which must be new or empty
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Print the result as one JSON object
    #[arg(long)]
    json: bool,
}

pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let Arguments { file, out, json } = arguments;
    let study = study_file(file)?;
    let scene = scene_of(&study)?;
    let rig = RigConfig::load(&study.rig)?;
    for condition in &study.conditions {
        under(rig.clone(), condition).with_context(|| format!("condition \"{}\"", condition.name))?;
    }
    let scene = toml::to_string(&scene).context("the scene cannot be written")?;
    let made = Study::create(out, &study, &scene, &utc_now())?;
    let plan = made.plan();
    let (participants, rows) = (plan.participants.len(), plan.rows());
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
        format!("each order is there {} times", participants / rows)
    } else {
        format!("the orders are not balanced: take a multiple of {rows}")
    };
    output::line(&format!(
        "made {}: {participants} participants, {} conditions ({balance}), {} trials of each\n\
         commitment (BLAKE2b-256): {}\nkeep it outside of the folder: it proves later that nobody changed the assignment",
        out.display(),
        plan.labels.len(),
        plan.trials_of_each(),
        plan.commitment
    ))
}
