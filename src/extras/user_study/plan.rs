//! The public part of a study: `study.toml` in its folder.

use nima_score::{FeedbackSchedule, TaskCriterion};
use serde::{Deserialize, Serialize};

use crate::{
    Breaks, ExclusionRule, InterruptionPolicy, Label, NotReached, Practice, Questionnaires, StudyError, StudyFile,
    order, seal,
};

/// Version of the file's format: version 1 had no feedback; version 2 had a commitment to the assignment only, a journal
/// without hashes, and sealed texts that were not bound to their trials.
const VERSION: u32 = 3;
const BOUND: u32 = 3;
/// Start of the line with the commitment.
const COMMITMENT: &str = "commitment = ";
const OLDEST: u32 = 1;

/// A study without its conditions. The next step follows from it and the journal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StudyPlan {
    version: u32,
    /// Name for screen and report.
    pub name: String,
    /// Built-in name or file.
    pub rig: String,
    /// The primary measure.
    pub primary: String,
    /// Further measures of the report.
    pub secondary: Vec<String>,
    /// Trials under each condition.
    pub trials: u32,
    /// Whether the conditions are hidden until the unblinding.
    pub blind: bool,
    /// Whether trials are recorded.
    pub record: bool,
    /// Action after an interrupted trial.
    pub interrupted: InterruptionPolicy,
    /// Maximum attempts at a trial.
    pub attempts: u32,
    pub labels: Vec<Label>,
    /// BLAKE2b-256 of the sealed assignment, in hexadecimal digits: proves later that neither the assignment nor the
    /// rules of the study were changed.
    pub commitment: String,
    /// Criterion that ends practice, and the action if it is not met.
    pub practice: Option<PracticePlan>,
    /// Rule for the trials after which the participant is shown the result, and the criterion for skill.
    #[serde(default)]
    pub feedback: ResultDisplay,
    pub breaks: Option<Breaks>,
    /// Questionnaires, and when they are filled in.
    pub questionnaires: Questionnaires,
    pub exclusion: Vec<ExclusionRule>,
    pub participants: Vec<Participant>,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PracticePlan {
    pub not_reached: NotReached,
    pub criterion: TaskCriterion,
}

/// Trials after which the participant is shown the result.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ResultDisplay {
    pub rule: FeedbackSchedule,
    /// Criterion for skill.
    pub criterion: TaskCriterion,
}

/// A participant, by a pseudonym.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Participant {
    /// P01, P02, ...
    pub name: String,
    /// The labels in this participant's order.
    pub order: Vec<Label>,
}

impl StudyPlan {
    /// Draws a plan for a checked file.
    pub(crate) fn draw(file: &StudyFile, commitment: String) -> std::io::Result<Self> {
        let labels = Label::first(file.conditions.len());
        let seed = match file.seed {
            Some(seed) => seed,
            None => u64::from_le_bytes(seal::random()?),
        };
        let orders = order::orders(labels.len(), file.participants as usize, seed);
        let digits = file.participants.to_string().len().max(2);
        let participant = |(at, order): (usize, Vec<usize>)| Participant {
            name: format!("P{:0digits$}", at + 1),
            order: order.into_iter().map(|place| labels[place]).collect(),
        };
        let participants = orders.into_iter().enumerate().map(participant).collect();
        let practising =
            |practice: &Practice| PracticePlan { not_reached: practice.not_reached, criterion: practice.criterion };
        Ok(Self {
            version: VERSION,
            name: file.name.clone(),
            rig: file.rig.clone(),
            primary: file.primary.clone(),
            secondary: file.secondary.clone(),
            trials: file.trials,
            blind: file.blind,
            record: file.record,
            interrupted: file.interrupted,
            attempts: file.attempts,
            labels: labels.clone(),
            commitment,
            practice: file.practice.as_ref().map(practising),
            feedback: ResultDisplay { rule: file.feedback, criterion: file.skill().unwrap_or_default() },
            breaks: file.breaks,
            questionnaires: file.questionnaires.clone(),
            exclusion: file.exclusion.clone(),
            participants,
        })
    }

    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        let plan: Self = nima_files::from_toml(text).map_err(|misfit| misfit.message().to_owned())?;
        match plan.version {
            OLDEST..=VERSION => Ok(plan),
            other => Err(format!(
                "it has version {other}, but this program supports versions {OLDEST} to {VERSION}: use a newer program"
            )),
        }
    }

    /// Returns the hash of the file without the commitment, which the commitment covers.
    pub(crate) fn hash_of(text: &str) -> String {
        let covered: String = text.split_inclusive('\n').filter(|line| !line.starts_with(COMMITMENT)).collect();
        seal::hash(covered.as_bytes())
    }

    /// Returns whether the commitment covers this file, the journal is chained, and sealed texts are bound to their
    /// trials.
    pub(crate) const fn is_bound(&self) -> bool {
        self.version >= BOUND
    }

    /// Returns the participant of this name.
    ///
    /// # Errors
    /// [`StudyError::Participant`] with the existing names.
    pub fn participant(&self, name: &str) -> Result<&Participant, StudyError> {
        let known = || match self.participants.as_slice() {
            [first, .., last] => format!("{} to {}", first.name, last.name),
            few => few.iter().map(|one| one.name.clone()).collect::<Vec<_>>().join(", "),
        };
        let found = self.participants.iter().find(|participant| participant.name == name);
        found.ok_or_else(|| StudyError::Participant { name: nima_files::quoted(name), known: known() })
    }

    /// Returns the number of trials of each participant, without practice.
    pub fn trials_of_each(&self) -> u32 {
        self.trials * self.labels.len() as u32
    }

    /// Returns the label of a trial, counted from 1; `None` beyond the last one.
    pub(crate) fn label(&self, participant: &Participant, number: u32) -> Option<Label> {
        participant.order.get((number.checked_sub(1)? / self.trials.max(1)) as usize).copied()
    }

    /// Returns the rows of the design that balances the orders; the number of participants should be a multiple of it.
    pub fn rows(&self) -> usize {
        order::williams(self.labels.len()).len()
    }
}
