//! Entries of the journal.

use std::collections::BTreeMap;

use nima_score::{Score, TrialOutcome};
use serde::{Deserialize, Serialize};

use crate::{Label, QuestionnaireAnswers};

/// The measures of a trial that have a value, by their keys.
pub type TrialMeasures = BTreeMap<String, f64>;

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct JournalEntry {
    /// From 1.
    pub n: u64,
    /// Time of writing, in the form given by the caller.
    pub at: String,
    /// The event.
    #[serde(flatten)]
    pub event: StudyEvent,
}

/// Practice, or a trial that counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TrialPhase {
    Practice,
    Trial,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TrialId {
    /// Practice, or one that counts.
    pub phase: TrialPhase,
    /// Number among the trials of its phase, from 1.
    pub number: u32,
    /// Number of the attempt, from 1; higher after interruptions.
    pub attempt: u32,
}

/// Ending of a trial that has a result.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TrialEnding {
    Completed,
    OutOfTime,
}

impl TrialEnding {
    /// Returns the ending of a trial with a result; `None` if it was given up or interrupted.
    pub const fn of(outcome: TrialOutcome) -> Option<Self> {
        match outcome {
            TrialOutcome::Completed => Some(Self::Completed),
            TrialOutcome::OutOfTime => Some(Self::OutOfTime),
            TrialOutcome::Aborted | TrialOutcome::Unfinished => None,
        }
    }
}

/// An event of a study.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "event", rename_all = "snake_case")]
pub enum StudyEvent {
    /// The folder was created.
    StudyMade {
        commitment: String,
    },
    ParticipantBegan {
        participant: String,
    },
    TrialBegan {
        participant: String,
        #[serde(flatten)]
        trial: TrialId,
        /// Not in practice.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        label: Option<Label>,
        /// Done by a simulated person.
        simulated: bool,
    },
    TrialEnded {
        participant: String,
        #[serde(flatten)]
        trial: TrialId,
        ending: TrialEnding,
        measures: TrialMeasures,
        /// Measures that reveal the condition, encrypted; in every trial of a blind study, also if there are none.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        withheld: Option<String>,
        /// The recording, in the folder of the study.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        session: Option<String>,
    },
    /// The trial was given up.
    TrialAborted {
        participant: String,
        #[serde(flatten)]
        trial: TrialId,
        why: String,
        /// Whether the computer stalled briefly: such an attempt does not count. A stall does not depend on the
        /// condition.
        #[serde(default, skip_serializing_if = "std::ops::Not::not")]
        stalled: bool,
        /// Details that may reveal the condition, encrypted; in every such entry of a blind study.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        withheld: Option<String>,
    },
    /// The program ended in the middle of the trial: detected when the study was opened again.
    TrialInterrupted {
        participant: String,
        #[serde(flatten)]
        trial: TrialId,
    },
    BreakTaken {
        participant: String,
        seconds: f64,
        simulated: bool,
    },
    Answered {
        participant: String,
        /// The condition to which they refer; `None` at the end.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        after: Option<Label>,
        answers: QuestionnaireAnswers,
        simulated: bool,
    },
    /// A person excludes a trial, or a participant.
    Excluded {
        participant: String,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        number: Option<u32>,
        why: String,
    },
    Noted {
        #[serde(default, skip_serializing_if = "Option::is_none")]
        participant: Option<String>,
        text: String,
    },
    /// The last line was incomplete, as after a power failure, and was dropped.
    TornLineDropped {
        bytes: u64,
    },
    /// The assignment was revealed.
    Unblinded {
        who: String,
        why: String,
        commitment: String,
    },
}

/// Returns the measures of a score that have a value.
pub(crate) fn measures(score: &Score) -> TrialMeasures {
    score.measures().filter_map(|measure| Some((measure.key(), measure.value?))).collect()
}
