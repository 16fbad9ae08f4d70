//! `nima user-study unblind`.

use std::path::PathBuf;

use clap::Args;
use nima_recording::store::utc_now;
use nima_report::output;
use nima_screen::stderr::print_line;
use serde_json::json;

use super::opened;

#[derive(Debug, Args)]
pub(in crate::extras::user_studies) struct UnblindArguments {
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

pub(super) fn run(arguments: &UnblindArguments) -> anyhow::Result<()> {
    let UnblindArguments { study, name, reason, json } = arguments;
    let mut study = opened(study)?;
    study.unblind(name, reason, &utc_now())?;
    if study.state().unblinding.as_ref().is_some_and(|unblinding| !unblinding.complete) {
        print_line("warning: not all participants have finished; trials from now on are marked as unblinded");
    }
    let labels: Vec<_> = study.opened().into_iter().flat_map(nima_user_study::Assignment::labels).collect();
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
