//! `nima user-study unblind`.

use std::path::PathBuf;

use clap::Args;
use nima_recording::store::utc_now;
use nima_user_study::Study;
use serde_json::json;

use crate::{command::output, telling::tell};

#[derive(Debug, Args)]
pub(in crate::extras::user_studies) struct Arguments {
    /// Folder of the study
    #[arg(value_name = "DIR")]
    study: PathBuf,
    /// Name of the person who reveals the conditions; stored in the journal
    #[arg(long, value_name = "NAME")]
    name: String,
    /// Reason; stored in the journal
    #[arg(long, value_name = "TEXT")]
    reason: String,
    /// Print the conditions as one JSON object
    #[arg(long)]
    json: bool,
}

pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let Arguments { study, name, reason, json } = arguments;
    let mut study = Study::open(study, &utc_now())?;
    study.unblind(name, reason, &utc_now())?;
    if study.state().unblinding.as_ref().is_some_and(|unblinding| !unblinding.complete) {
        tell("warning: not all participants have finished; trials from now on are marked as unblinded");
    }
    let labels: Vec<_> = study.opened().into_iter().flat_map(nima_user_study::Opened::labels).collect();
    if *json {
        let labels: serde_json::Map<_, _> =
            labels.iter().map(|(label, name)| (label.to_string(), json!(name))).collect();
        return output::json(&json!({ "conditions": labels, "commitment": study.plan().commitment }));
    }
    let rows: Vec<String> = labels.iter().map(|(label, name)| format!("{label} = {name}")).collect();
    let file = study.folder().join("conditions.json");
    output::line(&format!(
        "{}\n`b2sum -l 256 {}` prints the commitment {}",
        rows.join("\n"),
        file.display(),
        study.plan().commitment
    ))
}
