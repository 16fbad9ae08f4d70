//! `nima user-study next`.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};
use clap::Args;
use nima_recording::store::utc_now;
use nima_report::output;
use nima_user_study::{ParticipantProgress, Questionnaire, QuestionnaireAnswers, StudyStep};
use serde_json::json;

use super::{opened, warn};
use crate::{
    extras::user_studies::study::{next_text, plain_hand, run_virtual},
    shutdown::Leave,
};

#[derive(Debug, Args)]
pub(in crate::extras::user_studies) struct NextTrialArguments {
    /// Folder of the study
    #[arg(value_name = "DIR")]
    study: PathBuf,
    /// Participant
    #[arg(long, value_name = "P01")]
    participant: String,
    /// Run a trial on the simulated rig with its simulated hand, on a virtual clock; a break takes no time
    #[arg(long = "virtual")]
    virtual_clock: bool,
    /// Answers to the next questionnaire, as TOML: `realism = 5`
    #[arg(long, value_name = "TOML", conflicts_with = "answers_file")]
    answers: Option<String>,
    /// File with answers; may contain the answers to several questionnaires
    #[arg(long, value_name = "FILE")]
    answers_file: Option<PathBuf>,
    /// Print the result as one JSON object
    #[arg(long)]
    json: bool,
}

pub(super) fn run(arguments: &NextTrialArguments) -> anyhow::Result<()> {
    let NextTrialArguments { study, participant, virtual_clock, answers, answers_file, json } = arguments;
    let mut study = opened(study)?;
    let step = study.next(participant)?;
    let words = match step {
        StudyStep::Done { .. } => bail!("{participant}: no next step ({step})"),
        StudyStep::Questionnaire { questionnaire, .. } => {
            let given = given(questionnaire, answers.as_deref(), answers_file.as_deref())?;
            study.answer(participant, given, false, &utc_now())?;
            format!("{step}: kept")
        }
        _ if answers.is_some() || answers_file.is_some() => {
            bail!("{participant}: the next step is {step}, which takes no answers")
        }
        _ if !virtual_clock => {
            bail!("{participant}: the next step is {step}; add --virtual to run it in the simulated rig")
        }
        StudyStep::Break { min_s } => {
            study.take_break(participant, min_s, true, &utc_now())?;
            "break (simulated)".to_owned()
        }
        StudyStep::Practice { .. } | StudyStep::Trial { .. } | StudyStep::Running { .. } => {
            let leave = Leave::on_signals()?;
            let hand = plain_hand(&study, participant)?;
            let ran = run_virtual(&mut study, participant, &hand, &leave)?;
            warn(&mut study);
            let shows = study.state().progress(participant).is_none_or(ParticipantProgress::shows_result);
            ran.as_text(shows)
        }
    };
    let next = study.next(participant)?;
    if *json {
        return output::json(&json!({ "participant": participant, "step": step, "result": words, "next": next }));
    }
    output::line(&format!("{participant}: {words}; {}", next_text(&next)))
}

fn given(asked: Questionnaire, text: Option<&str>, file: Option<&Path>) -> anyhow::Result<QuestionnaireAnswers> {
    let text = match (text, file) {
        (Some(text), _) => text.to_owned(),
        (None, Some(file)) => {
            nima_files::read_text(file, nima_files::CONFIG_MAX).with_context(|| file.display().to_string())?
        }
        (None, None) => String::new(),
    };
    QuestionnaireAnswers::from_toml(&text, asked)
        .map_err(|why| anyhow::anyhow!("{why}; add it with --answers or --answers-file"))
}
