//! `nima user-study simulate`.

use std::path::PathBuf;

use anyhow::bail;
use clap::Args;
use nima_recording::store::utc_now;
use nima_report::output;
use nima_user_study::{StudyStep, simulated::SimulatedParticipant};

use super::{opened, warn};
use crate::{
    extras::user_studies::study::{made, run_virtual},
    shutdown::Leave,
};

#[derive(Debug, Args)]
pub(in crate::extras::user_studies) struct SimulateStudyArguments {
    /// Folder of a study in which no real person has taken part
    #[arg(value_name = "DIR")]
    study: PathBuf,
    /// Seed of the simulated participants
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Stop after this many steps; run the command again to continue
    #[arg(long, value_name = "N")]
    steps: Option<usize>,
}

pub(super) fn run(arguments: &SimulateStudyArguments) -> anyhow::Result<()> {
    let SimulateStudyArguments { study, seed, steps } = arguments;
    let mut study = opened(study)?;
    let is_real = |(_, one): (&str, &nima_user_study::ParticipantProgress)| {
        one.trials.iter().any(|made| !made.simulated) || one.answers.iter().any(|given| !given.2)
    };
    if study.state().participants().any(is_real) {
        bail!("real people have taken part in this study: create another folder for a simulation");
    }
    let leave = Leave::on_signals()?;
    let names: Vec<String> = study.plan().participants.iter().map(|one| one.name.clone()).collect();
    let mut left = steps.unwrap_or(usize::MAX);
    for (number, name) in (0..).zip(names) {
        let person = SimulatedParticipant::new(*seed, number);
        while left > 0 {
            let (before, since_break) = made(&study, &name);
            match study.next(&name)? {
                StudyStep::Done { .. } => break,
                StudyStep::Break { min_s } => study.take_break(&name, min_s, true, &utc_now())?,
                StudyStep::Questionnaire { questionnaire, .. } => {
                    study.answer(&name, person.answers(questionnaire, before), true, &utc_now())?;
                }
                StudyStep::Running { .. } => bail!("{name}: a trial is running"),
                StudyStep::Practice { attempt, .. } | StudyStep::Trial { attempt, .. } => {
                    run_virtual(&mut study, &name, &person.hand(before, since_break, attempt), &leave)?;
                    warn(&mut study);
                }
            }
            if leave.is_asked() {
                bail!("ended on request; run the same command to continue");
            }
            left -= 1;
        }
        let results = study
            .state()
            .progress(&name)
            .map_or(0, |one| one.trials.iter().filter(|made| made.ending.is_some()).count());
        output::line(&format!("{name}: {results} trials with a result; next: {}", study.next(&name)?))?;
        if left == 0 {
            break;
        }
    }
    Ok(())
}
