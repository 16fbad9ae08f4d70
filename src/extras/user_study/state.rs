//! The state of a study: a pure function of its plan and its journal.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::{Done, Entry, Event, Participant, Plan, Progress, Step};

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Unblinding {
    /// The person who requested it.
    pub who: String,
    /// The reason.
    pub why: String,
    /// The time.
    pub at: String,
    /// Trials that had a result then.
    pub trials_before: usize,
    /// Whether every participant had finished.
    pub complete: bool,
}

/// The state of a study.
#[derive(Clone, Debug)]
pub struct State {
    participants: BTreeMap<String, Progress>,
    /// The first unblinding.
    pub unblinding: Option<Unblinding>,
    /// Notes: time, participant, text.
    pub notes: Vec<(String, Option<String>, String)>,
    /// Lengths of incomplete lines left by power failures, bytes.
    pub torn: Vec<u64>,
}

impl State {
    pub fn new(plan: &Plan) -> Self {
        let participants =
            plan.participants.iter().map(|participant| (participant.name.clone(), Progress::of(plan))).collect();
        Self { participants, unblinding: None, notes: Vec::new(), torn: Vec::new() }
    }

    /// Returns the state after these entries.
    ///
    /// # Errors
    /// The number of the first entry that cannot follow the earlier ones, and the reason.
    pub fn of<'a>(plan: &Plan, entries: impl IntoIterator<Item = &'a Entry>) -> Result<Self, (u64, String)> {
        let mut state = Self::new(plan);
        for entry in entries {
            state.take(plan, entry).map_err(|why| (entry.n, why))?;
        }
        Ok(state)
    }

    /// Returns the participants and their progress, in the order of their names.
    pub fn participants(&self) -> impl Iterator<Item = (&str, &Progress)> {
        self.participants.iter().map(|(name, progress)| (name.as_str(), progress))
    }

    /// Returns the progress of this participant.
    pub fn progress(&self, participant: &str) -> Option<&Progress> {
        self.participants.get(participant)
    }

    /// Whether conditions may be shown.
    pub fn is_open(&self, plan: &Plan) -> bool {
        !plan.blind || self.unblinding.is_some()
    }

    /// Number of trials with a result.
    pub fn results(&self) -> usize {
        self.participants.values().flat_map(|one| &one.trials).filter(|made| made.measures.is_some()).count()
    }

    /// Whether parts of it were done by simulated people.
    pub fn is_simulated(&self) -> bool {
        let simulated =
            |one: &Progress| one.trials.iter().any(|made| made.simulated) || one.answers.iter().any(|given| given.2);
        self.participants.values().any(simulated)
    }

    /// Returns the next step of this participant.
    pub fn next(&self, plan: &Plan, participant: &Participant) -> Step {
        let Some(progress) = self.participants.get(&participant.name) else {
            return Step::Done { why: Done::Excluded };
        };
        progress.next(plan, participant)
    }

    /// Applies the next entry.
    ///
    /// # Errors
    /// Why it cannot follow the earlier ones.
    pub(crate) fn take(&mut self, plan: &Plan, entry: &Entry) -> Result<(), String> {
        let unblinded = plan.blind && self.unblinding.is_some();
        match &entry.event {
            Event::StudyMade { commitment } | Event::Unblinded { commitment, .. } if *commitment != plan.commitment => {
                return Err("the commitment is not that of study.toml: one of the two files was changed".to_owned());
            }
            Event::StudyMade { .. } => {}
            Event::ParticipantBegan { participant } => found(plan, &mut self.participants, participant)?.1.began = true,
            Event::TrialBegan { participant, trial, label, simulated } => {
                let (who, progress) = found(plan, &mut self.participants, participant)?;
                progress.begin(plan, who, *trial, *label, *simulated)?;
            }
            Event::TrialEnded { participant, trial, ending, measures, withheld, .. } => {
                let (who, progress) = found(plan, &mut self.participants, participant)?;
                let simulated = progress.close(*trial, participant)?;
                progress.end(
                    plan,
                    who,
                    *trial,
                    Some((*ending, measures.clone(), withheld.clone())),
                    simulated,
                    unblinded,
                );
            }
            Event::TrialAborted { participant, trial, .. } | Event::TrialInterrupted { participant, trial } => {
                let (who, progress) = found(plan, &mut self.participants, participant)?;
                let simulated = progress.close(*trial, participant)?;
                progress.interrupt(plan, who, *trial, simulated, unblinded);
            }
            Event::BreakTaken { participant, seconds, .. } => {
                found(plan, &mut self.participants, participant)?.1.rest(*seconds);
            }
            Event::Answered { participant, after, answers, simulated } => {
                let (who, progress) = found(plan, &mut self.participants, participant)?;
                let asked = Step::Questionnaire { questionnaire: answers.questionnaire(), after: *after };
                let next = progress.next(plan, who);
                if next != asked {
                    return Err(format!(
                        "{participant} answered {}, but next is {next}",
                        answers.questionnaire().name()
                    ));
                }
                progress.answers.push((*after, answers.clone(), *simulated));
            }
            Event::Excluded { participant, number: None, why } => {
                found(plan, &mut self.participants, participant)?.1.excluded.get_or_insert_with(|| why.clone());
            }
            Event::Excluded { participant, number: Some(number), why } => {
                let progress = found(plan, &mut self.participants, participant)?.1;
                if !progress.trials.iter().any(|made| made.number == *number) {
                    return Err(format!("{participant} has not made trial {number}"));
                }
                progress.excluded_trials.insert(*number, why.clone());
            }
            Event::Noted { participant, text } => {
                self.notes.push((entry.at.clone(), participant.clone(), text.clone()));
            }
            Event::TornLineDropped { bytes } => self.torn.push(*bytes),
            Event::Unblinded { who, why, .. } => self.unblind(plan, entry, who, why),
        }
        Ok(())
    }

    fn unblind(&mut self, plan: &Plan, entry: &Entry, who: &str, why: &str) {
        let is_done = |participant: &Participant| matches!(self.next(plan, participant), Step::Done { .. });
        let unblinding = Unblinding {
            who: who.to_owned(),
            why: why.to_owned(),
            at: entry.at.clone(),
            trials_before: self.results(),
            complete: plan.participants.iter().all(is_done),
        };
        self.unblinding.get_or_insert(unblinding);
    }
}

/// Returns a participant with its progress.
fn found<'a>(
    plan: &'a Plan,
    participants: &'a mut BTreeMap<String, Progress>,
    name: &str,
) -> Result<(&'a Participant, &'a mut Progress), String> {
    let participant = plan.participant(name).map_err(|error| error.to_string())?;
    let progress = participants.get_mut(name).ok_or_else(|| format!("there is no {name}"))?;
    Ok((participant, progress))
}
