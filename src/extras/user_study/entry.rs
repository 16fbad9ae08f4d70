//! What is written into the journal.

use std::collections::BTreeMap;

use nima_score::{Outcome, Score};
use serde::{Deserialize, Serialize};

use crate::{Answers, Label};

/// The measures of a trial that have a value, by their keys.
pub type Measures = BTreeMap<String, f64>;

/// A line of the journal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Entry {
    /// Its number, from 1.
    pub n: u64,
    /// When it was written, as whoever writes it tells the time.
    pub at: String,
    /// What happened.
    #[serde(flatten)]
    pub event: Event,
}

/// Practice or a trial that counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Phase {
    Practice,
    Trial,
}

/// Which trial of a participant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TrialId {
    /// Practice, or one that counts.
    pub phase: Phase,
    /// Its number among those of its phase, from 1.
    pub number: u32,
    /// From 1; more after interruptions.
    pub attempt: u32,
}

/// How a trial ended that has a result.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Ending {
    Completed,
    OutOfTime,
}

impl Ending {
    /// Of a trial that has a result; `None` if it was given up or broken off.
    pub const fn of(outcome: Outcome) -> Option<Self> {
        match outcome {
            Outcome::Completed => Some(Self::Completed),
            Outcome::OutOfTime => Some(Self::OutOfTime),
            Outcome::Aborted | Outcome::Unfinished => None,
        }
    }
}

/// What happens in a study.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "event", rename_all = "snake_case")]
pub enum Event {
    /// The folder was made.
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
        /// By a simulated person.
        simulated: bool,
    },
    TrialEnded {
        participant: String,
        #[serde(flatten)]
        trial: TrialId,
        ending: Ending,
        measures: Measures,
        /// Measures that tell the condition, encrypted; in a blind study only.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        withheld: Option<String>,
        /// The recording, in the folder of the study.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        session: Option<String>,
    },
    /// Somebody gave it up.
    TrialAborted {
        participant: String,
        #[serde(flatten)]
        trial: TrialId,
        why: String,
    },
    /// The program ended in the middle of it: found when the study was opened again.
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
        /// The condition that they are about; `None` at the end.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        after: Option<Label>,
        answers: Answers,
        simulated: bool,
    },
    /// A person leaves out a trial, or a participant.
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
    /// The last line was incomplete, as a power cut leaves it, and was dropped.
    TornLineDropped {
        bytes: u64,
    },
    /// Somebody opened the assignment.
    Unblinded {
        who: String,
        why: String,
        commitment: String,
    },
}

/// The measures of a score that have a value.
pub(crate) fn measures(score: &Score) -> Measures {
    score.measures().filter_map(|measure| Some((measure.key(), measure.value?))).collect()
}
