//! Operations on a study, each written to its journal before the call returns.

use std::{
    io,
    path::{Path, PathBuf},
};

use nima_score::Score;
use serde::Serialize;

use super::{MEASURES, REASON, UserStudy, purpose};
use crate::{
    Condition, Label, Participant, QuestionnaireAnswers, StudyError, StudyEvent, StudyStep, TrialEnding, TrialId,
    TrialMeasures, entry::measures, unblinding_risk,
};

/// A trial that has begun. Its `Debug` does not reveal the condition.
#[derive(Debug)]
pub struct RunningTrial {
    participant: String,
    trial: TrialId,
    label: Option<Label>,
    condition: Condition,
    session: Option<PathBuf>,
}

impl RunningTrial {
    pub const fn trial(&self) -> TrialId {
        self.trial
    }

    /// Returns the label of its condition; `None` in practice.
    pub const fn label(&self) -> Option<Label> {
        self.label
    }

    /// Returns the feedback to the hand: only for the loop, must never be displayed.
    pub const fn condition(&self) -> &Condition {
        &self.condition
    }

    /// Returns the path of its recording, if it is recorded. Encrypted when the trial is over.
    pub fn session(&self) -> Option<&Path> {
        self.session.as_deref()
    }
}

impl UserStudy {
    /// Begins the next trial; it is in the journal when this returns.
    ///
    /// # Errors
    /// [`StudyError::NotNow`] if the next step is not a trial.
    pub fn begin_trial(&mut self, participant: &str, simulated: bool, at: &str) -> Result<RunningTrial, StudyError> {
        let who = self.plan.participant(participant)?.clone();
        let next = self.state.next(&self.plan, &who);
        let (trial, label) = next.trial().ok_or_else(|| not_now(participant, "a trial", &next))?;
        let condition = self.condition(&who, trial, label).cloned();
        let condition = condition.ok_or_else(|| StudyError::Refused("the assignment has no such label".to_owned()))?;
        let session = self.plan.record.then(|| self.session_of(participant, trial)).transpose()?;
        if !self.state.progress(participant).is_some_and(|progress| progress.began) {
            self.write(at, StudyEvent::ParticipantBegan { participant: participant.to_owned() })?;
        }
        self.write(at, StudyEvent::TrialBegan { participant: participant.to_owned(), trial, label, simulated })?;
        Ok(RunningTrial { participant: participant.to_owned(), trial, label, condition, session })
    }

    fn condition(&self, who: &Participant, trial: TrialId, label: Option<Label>) -> Option<&Condition> {
        if let Some(label) = label {
            return self.secret.condition(label);
        }
        // If practice has no fixed condition, use each in turn.
        let turn = (trial.number as usize).checked_sub(1)? % who.order.len().max(1);
        self.secret.practice().or_else(|| self.secret.condition(*who.order.get(turn)?))
    }

    /// Ends a trial with a result. A recording that cannot be encrypted does not lose the result; see
    /// [`UserStudy::take_trouble`].
    ///
    /// # Errors
    /// I/O errors of the journal.
    pub fn end_trial(
        &mut self,
        running: RunningTrial,
        ending: TrialEnding,
        score: &Score,
        at: &str,
    ) -> Result<(), StudyError> {
        let is_reported = self.state.is_open(&self.plan);
        let (telling, report): (TrialMeasures, TrialMeasures) =
            measures(score).into_iter().partition(|(key, _)| !is_reported && unblinding_risk::tells(key));
        let withheld = self.withheld(MEASURES, &running.participant, running.trial, &telling)?;
        let RunningTrial { participant, trial, session, .. } = running;
        let recording = session.filter(|path| path.is_file());
        let session = recording.as_deref().map(|path| self.name_after_trial(path));
        let ended = StudyEvent::TrialEnded { participant, trial, ending, measures: report, withheld, session };
        let written = self.write(at, ended);
        self.seal_recording(recording.as_deref());
        written
    }

    /// Gives up a trial; the rule of the study determines the next step. `details` may reveal the condition: in a blind
    /// study they are encrypted, otherwise they are a part of the reason.
    ///
    /// # Errors
    /// I/O errors of the journal.
    pub fn abort_trial(
        &mut self,
        running: RunningTrial,
        why: &str,
        details: Option<&str>,
        at: &str,
    ) -> Result<(), StudyError> {
        self.abort(running, (why, details), false, at)
    }

    /// Gives up a trial because the computer stalled briefly. If the rule of the study repeats interrupted trials, this
    /// attempt does not count.
    ///
    /// # Errors
    /// I/O errors of the journal.
    pub fn abort_stalled_trial(
        &mut self,
        running: RunningTrial,
        why: &str,
        details: Option<&str>,
        at: &str,
    ) -> Result<(), StudyError> {
        self.abort(running, (why, details), true, at)
    }

    fn abort(
        &mut self,
        running: RunningTrial,
        (why, details): (&str, Option<&str>),
        stalled: bool,
        at: &str,
    ) -> Result<(), StudyError> {
        let RunningTrial { participant, trial, session, .. } = running;
        let withheld = self.withheld(REASON, &participant, trial, &details.unwrap_or_default())?;
        let shown = details.filter(|_| withheld.is_none());
        let why = shown.map_or_else(|| why.to_owned(), |details| format!("{why}: {details}"));
        let written = self.write(at, StudyEvent::TrialAborted { participant, trial, why, stalled, withheld });
        self.seal_recording(session.as_deref().filter(|path| path.is_file()));
        written
    }

    /// Encrypts a value for its trial; `None` if the conditions may be shown. There is always a text, of always the same
    /// length, because otherwise both would reveal the condition.
    fn withheld(
        &self,
        what: &str,
        participant: &str,
        trial: TrialId,
        value: &impl Serialize,
    ) -> Result<Option<String>, StudyError> {
        if self.state.is_open(&self.plan) {
            return Ok(None);
        }
        let purpose = purpose(&self.plan, what, participant, trial);
        let text = serde_json::to_vec(value).map_err(io::Error::from);
        let sealed = text.and_then(|text| self.key.seal_padded(&purpose, &text));
        sealed.map(Some).map_err(StudyError::io(&self.folder))
    }

    /// Records a break, even one that was not due.
    ///
    /// # Errors
    /// [`StudyError::Refused`] if it was shorter than the study requires.
    pub fn take_break(&mut self, participant: &str, seconds: f64, simulated: bool, at: &str) -> Result<(), StudyError> {
        let next = self.next(participant)?;
        if let StudyStep::Break { min_s } = next
            && seconds < min_s
        {
            return Err(StudyError::Refused(format!(
                "{participant}: the break must last {min_s:.0} s, but it lasted {seconds:.0} s"
            )));
        }
        if matches!(next, StudyStep::Running { .. }) || !seconds.is_finite() {
            return Err(not_now(participant, "a break", &next));
        }
        self.write(at, StudyEvent::BreakTaken { participant: participant.to_owned(), seconds, simulated })
    }

    /// Records the answers to the next questionnaire.
    ///
    /// # Errors
    /// [`StudyError::NotNow`] if it is not the next step, [`StudyError::Answers`] if the form does not allow an answer.
    pub fn answer(
        &mut self,
        participant: &str,
        answers: QuestionnaireAnswers,
        simulated: bool,
        at: &str,
    ) -> Result<(), StudyError> {
        let next = self.next(participant)?;
        let StudyStep::Questionnaire { questionnaire, after } = next else {
            return Err(not_now(participant, "a questionnaire", &next));
        };
        if questionnaire != answers.questionnaire() {
            return Err(not_now(participant, answers.questionnaire().name(), &next));
        }
        answers.check().map_err(|why| StudyError::Answers { participant: participant.to_owned(), why })?;
        self.write(at, StudyEvent::Answered { participant: participant.to_owned(), after, answers, simulated })
    }

    /// Excludes a participant, or one trial, from the analysis.
    ///
    /// # Errors
    /// The trial has not been made.
    pub fn exclude(&mut self, participant: &str, number: Option<u32>, why: &str, at: &str) -> Result<(), StudyError> {
        self.plan.participant(participant)?;
        if why.trim().is_empty() {
            return Err(StudyError::Refused("an exclusion requires a reason".to_owned()));
        }
        self.write(at, StudyEvent::Excluded { participant: participant.to_owned(), number, why: why.to_owned() })
    }

    /// Records a note.
    ///
    /// # Errors
    /// The participant does not exist.
    pub fn note(&mut self, participant: Option<&str>, text: &str, at: &str) -> Result<(), StudyError> {
        participant.map(|name| self.plan.participant(name)).transpose()?;
        self.write(at, StudyEvent::Noted { participant: participant.map(str::to_owned), text: text.to_owned() })
    }

    /// Reveals the assignment, which is recorded. From then on the tables name the conditions.
    ///
    /// # Errors
    /// [`StudyError::Refused`] without a name and a reason, in a study that is not blind, and the second time.
    pub fn unblind(&mut self, who: &str, why: &str, at: &str) -> Result<(), StudyError> {
        let refused = |why: String| Err(StudyError::Refused(why));
        if who.trim().is_empty() || why.trim().is_empty() {
            return refused("unblinding requires a name and a reason".to_owned());
        }
        if !self.plan.blind {
            return refused("the study is not blind: its conditions are known".to_owned());
        }
        if let Some(before) = &self.state.unblinding {
            return refused(format!("the study was unblinded already, by {} at {}", before.who, before.at));
        }
        let [who, why] = [who, why].map(|text| text.trim().to_owned());
        self.write(at, StudyEvent::Unblinded { who, why, commitment: self.plan.commitment.clone() })?;
        self.tidy()
    }

    pub(super) fn write(&mut self, at: &str, event: StudyEvent) -> Result<(), StudyError> {
        let Some(journal) = &mut self.journal else { return Err(StudyError::ReadOnly) };
        // An entry that the state refuses must not be written: the journal could then no longer be read.
        let mut state = self.state.clone();
        let refused = |why: String| StudyError::Refused(why);
        state
            .take(&self.plan, &crate::JournalEntry { n: 0, at: at.to_owned(), event: event.clone() })
            .map_err(refused)?;
        journal.append(at, event)?;
        self.state = state;
        Ok(())
    }
}

fn not_now(participant: &str, asked: &str, next: &StudyStep) -> StudyError {
    StudyError::NotNow { participant: participant.to_owned(), asked: asked.to_owned(), next: next.to_string() }
}
