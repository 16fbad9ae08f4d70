//! `nima user-study status`.

use std::{fmt::Write as _, path::PathBuf};

use clap::Args;
use nima_report::output;
use nima_user_study::{Label, StudyStep, UserStudy};
use serde::Serialize;

#[derive(Debug, Args)]
pub(in crate::extras::user_studies) struct StudyStatusArguments {
    /// Folder of the study
    #[arg(value_name = "DIR")]
    study: PathBuf,
    /// Print the status as one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct ParticipantStatus<'a> {
    participant: &'a str,
    order: &'a [Label],
    practice: usize,
    trials: usize,
    without_result: usize,
    interruptions: u32,
    excluded: Option<&'a str>,
    next: StudyStep,
}

#[derive(Serialize)]
struct StudyStatus<'a> {
    name: &'a str,
    blind: bool,
    unblinded: Option<&'a nima_user_study::Unblinding>,
    simulated: bool,
    commitment: &'a str,
    /// Hash of the whole journal.
    journal: Option<&'a str>,
    trials_of_each: u32,
    participants: Vec<ParticipantStatus<'a>>,
    excluded: Vec<nima_user_study::Exclusion>,
    notes: &'a [(String, Option<String>, String)],
    torn_bytes: &'a [u64],
}

pub(super) fn run(arguments: &StudyStatusArguments) -> anyhow::Result<()> {
    let study = UserStudy::read(&arguments.study)?;
    let status = StudyStatus::of(&study)?;
    if arguments.json { output::json(&status) } else { output::line(status.as_text().trim_end()) }
}

impl<'a> StudyStatus<'a> {
    fn of(study: &'a UserStudy) -> anyhow::Result<Self> {
        let plan = study.plan();
        let state = study.state();
        let standing = |participant: &'a nima_user_study::Participant| {
            let progress = state.progress(&participant.name);
            let results = |with: bool| {
                progress.map_or(0, |one| one.trials.iter().filter(|made| made.measures.is_some() == with).count())
            };
            Ok(ParticipantStatus {
                participant: &participant.name,
                order: &participant.order,
                practice: progress.map_or(0, |one| one.practice_s.len()),
                trials: results(true),
                without_result: results(false),
                interruptions: progress.map_or(0, |one| one.interruptions),
                excluded: progress.and_then(|one| one.excluded.as_deref()),
                next: study.next(&participant.name)?,
            })
        };
        Ok(Self {
            name: &plan.name,
            blind: plan.blind,
            unblinded: state.unblinding.as_ref(),
            simulated: state.is_simulated(),
            commitment: &plan.commitment,
            journal: study.journal_hash(),
            trials_of_each: plan.trials_of_each(),
            participants: plan.participants.iter().map(standing).collect::<anyhow::Result<_>>()?,
            excluded: study.exclusions(),
            notes: &state.notes,
            torn_bytes: &state.torn,
        })
    }

    fn as_text(&self) -> String {
        let sealed = match (self.blind, self.unblinded) {
            (false, _) => "not blind".to_owned(),
            (true, None) => "blind".to_owned(),
            (true, Some(by)) => format!("unblinded by {} at {} ({})", by.who, by.at, by.why),
        };
        let mut text = format!("{}: {sealed}\ncommitment {}\n", self.name, self.commitment);
        if let Some(hash) = self.journal {
            writeln!(text, "journal {hash}").ok();
        }
        if self.simulated {
            text.push_str("SIMULATED: contains trials or answers of simulated people\n");
        }
        for one in &self.participants {
            let order: Vec<String> = one.order.iter().map(ToString::to_string).collect();
            let lost = if one.without_result > 0 {
                format!(", {} without a result", one.without_result)
            } else {
                String::new()
            };
            writeln!(
                text,
                "{} ({}): practice {}, trials {} of {}{lost}; next: {}",
                one.participant,
                order.join(" "),
                one.practice,
                one.trials,
                self.trials_of_each,
                one.next
            )
            .ok();
        }
        for nima_user_study::Exclusion { participant, trial, why } in &self.excluded {
            let what = trial.map_or_else(|| "everything".to_owned(), |trial| format!("trial {trial}"));
            writeln!(text, "excluded from the analysis: {participant}, {what}: {why}").ok();
        }
        for (at, about, words) in self.notes {
            writeln!(text, "note {at}{}: {words}", about.as_ref().map_or_else(String::new, |name| format!(" {name}")))
                .ok();
        }
        text
    }
}
