//! The state of a study: a pure function of its plan and its journal.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::{EndReason, JournalEntry, Participant, ParticipantProgress, StudyEvent, StudyPlan, StudyStep};

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
pub struct StudyState {
    participants: BTreeMap<String, ParticipantProgress>,
    /// The first unblinding.
    pub unblinding: Option<Unblinding>,
    /// Notes: time, participant, text.
    pub notes: Vec<(String, Option<String>, String)>,
    /// Lengths of incomplete lines left by power failures, bytes.
    pub torn: Vec<u64>,
}

impl StudyState {
    pub fn new(plan: &StudyPlan) -> Self {
        let participants = plan
            .participants
            .iter()
            .map(|participant| (participant.name.clone(), ParticipantProgress::of(plan)))
            .collect();
        Self { participants, unblinding: None, notes: Vec::new(), torn: Vec::new() }
    }

    /// Returns the state after these entries.
    ///
    /// # Errors
    /// The number of the first entry that cannot follow the earlier ones, and the reason.
    pub fn of<'a>(
        plan: &StudyPlan,
        entries: impl IntoIterator<Item = &'a JournalEntry>,
    ) -> Result<Self, (u64, String)> {
        let mut state = Self::new(plan);
        for entry in entries {
            state.take(plan, entry).map_err(|why| (entry.n, why))?;
        }
        Ok(state)
    }

    /// Returns the participants and their progress, in the order of their names.
    pub fn participants(&self) -> impl Iterator<Item = (&str, &ParticipantProgress)> {
        self.participants.iter().map(|(name, progress)| (name.as_str(), progress))
    }

    /// Returns the progress of this participant.
    pub fn progress(&self, participant: &str) -> Option<&ParticipantProgress> {
        self.participants.get(participant)
    }

    /// Returns whether conditions may be shown.
    pub fn is_open(&self, plan: &StudyPlan) -> bool {
        !plan.blind || self.unblinding.is_some()
    }

    /// Returns the number of trials with a result.
    pub fn results(&self) -> usize {
        self.participants.values().flat_map(|one| &one.trials).filter(|made| made.measures.is_some()).count()
    }

    /// Returns whether parts of it were done by simulated people.
    pub fn is_simulated(&self) -> bool {
        let simulated = |one: &ParticipantProgress| {
            one.trials.iter().any(|made| made.simulated) || one.answers.iter().any(|given| given.2)
        };
        self.participants.values().any(simulated)
    }

    /// Returns the next step of this participant.
    pub fn next(&self, plan: &StudyPlan, participant: &Participant) -> StudyStep {
        let Some(progress) = self.participants.get(&participant.name) else {
            return StudyStep::Done { why: EndReason::Excluded };
        };
        progress.next(plan, participant)
    }

    /// Applies the next entry.
    ///
    /// # Errors
    /// Why it cannot follow the earlier ones.
    pub(crate) fn take(&mut self, plan: &StudyPlan, entry: &JournalEntry) -> Result<(), String> {
        let unblinded = plan.blind && self.unblinding.is_some();
        match &entry.event {
            StudyEvent::StudyMade { commitment } | StudyEvent::Unblinded { commitment, .. }
                if *commitment != plan.commitment =>
            {
                return Err(
                    "the commitment differs from that in study.toml: one of the two files was changed".to_owned()
                );
            }
            StudyEvent::StudyMade { .. } => {}
            StudyEvent::ParticipantBegan { participant } => {
                found(plan, &mut self.participants, participant)?.1.began = true;
            }
            StudyEvent::TrialBegan { participant, trial, label, simulated } => {
                let (who, progress) = found(plan, &mut self.participants, participant)?;
                progress.begin(plan, who, *trial, *label, *simulated)?;
            }
            StudyEvent::TrialEnded { participant, trial, ending, measures, withheld, .. } => {
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
            StudyEvent::TrialAborted { participant, trial, .. }
            | StudyEvent::TrialInterrupted { participant, trial } => {
                let (who, progress) = found(plan, &mut self.participants, participant)?;
                let simulated = progress.close(*trial, participant)?;
                if matches!(entry.event, StudyEvent::TrialAborted { stalled: true, .. }) {
                    progress.allow_attempt();
                }
                progress.interrupt(plan, who, *trial, simulated, unblinded);
            }
            StudyEvent::BreakTaken { participant, seconds, .. } => {
                found(plan, &mut self.participants, participant)?.1.rest(*seconds);
            }
            StudyEvent::Answered { participant, after, answers, simulated } => {
                let (who, progress) = found(plan, &mut self.participants, participant)?;
                let asked = StudyStep::Questionnaire { questionnaire: answers.questionnaire(), after: *after };
                let next = progress.next(plan, who);
                if next != asked {
                    return Err(format!(
                        "{participant} answered {}, but the next step is {next}",
                        answers.questionnaire().name()
                    ));
                }
                progress.answers.push((*after, answers.clone(), *simulated));
            }
            StudyEvent::Excluded { participant, number: None, why } => {
                found(plan, &mut self.participants, participant)?.1.excluded.get_or_insert_with(|| why.clone());
            }
            StudyEvent::Excluded { participant, number: Some(number), why } => {
                let progress = found(plan, &mut self.participants, participant)?.1;
                if !progress.trials.iter().any(|made| made.number == *number) {
                    return Err(format!("{participant} has not done trial {number}"));
                }
                progress.excluded_trials.insert(*number, why.clone());
            }
            StudyEvent::Noted { participant, text } => {
                self.notes.push((entry.at.clone(), participant.clone(), text.clone()));
            }
            StudyEvent::TornLineDropped { bytes } => self.torn.push(*bytes),
            StudyEvent::Unblinded { who, why, .. } => self.unblind(plan, entry, who, why),
        }
        Ok(())
    }

    fn unblind(&mut self, plan: &StudyPlan, entry: &JournalEntry, who: &str, why: &str) {
        let is_done = |participant: &Participant| matches!(self.next(plan, participant), StudyStep::Done { .. });
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
    plan: &'a StudyPlan,
    participants: &'a mut BTreeMap<String, ParticipantProgress>,
    name: &str,
) -> Result<(&'a Participant, &'a mut ParticipantProgress), String> {
    let participant = plan.participant(name).map_err(|error| error.to_string())?;
    let progress = participants.get_mut(name).ok_or_else(|| format!("there is no {name}"))?;
    Ok((participant, progress))
}
