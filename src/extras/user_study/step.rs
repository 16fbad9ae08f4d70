//! The next step of a participant.

use serde::Serialize;

use crate::{Label, Questionnaire, TrialId, TrialPhase};

/// The next step of a participant.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "step", rename_all = "snake_case")]
pub enum StudyStep {
    /// A practice trial.
    Practice {
        /// From 1.
        number: u32,
        /// From 1.
        attempt: u32,
    },
    /// A trial that counts.
    Trial {
        /// From 1.
        number: u32,
        /// From 1.
        attempt: u32,
        /// The label of its condition.
        label: Label,
    },
    Break {
        /// Minimum duration, s.
        #[serde(rename = "least_s")]
        min_s: f64,
    },
    Questionnaire {
        questionnaire: Questionnaire,
        /// The condition to which it refers; `None` at the end.
        after: Option<Label>,
    },
    /// A trial has started and has not ended: it is running, or the program ended during it.
    Running { trial: TrialId },
    /// Nothing.
    Done {
        /// The reason.
        why: EndReason,
    },
}

/// Reason why nothing is left to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum EndReason {
    /// All steps are finished.
    Finished,
    /// The participant is excluded.
    Excluded,
}

impl StudyStep {
    /// Returns the trial of this step, with its label if it counts.
    pub(crate) fn trial(&self) -> Option<(TrialId, Option<Label>)> {
        match *self {
            Self::Practice { number, attempt } => {
                Some((TrialId { phase: TrialPhase::Practice, number, attempt }, None))
            }
            Self::Trial { number, attempt, label } => {
                Some((TrialId { phase: TrialPhase::Trial, number, attempt }, Some(label)))
            }
            _ => None,
        }
    }
}

impl std::fmt::Display for StudyStep {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let again = |attempt: u32| if attempt > 1 { format!(", attempt {attempt}") } else { String::new() };
        match self {
            Self::Practice { number, attempt } => write!(f, "practice trial {number}{}", again(*attempt)),
            Self::Trial { number, attempt, label } => {
                write!(f, "trial {number} under condition {label}{}", again(*attempt))
            }
            Self::Break { min_s } => write!(f, "a break of at least {min_s:.0} s"),
            Self::Questionnaire { questionnaire, after: Some(label) } => {
                write!(f, "questionnaire {} about condition {label}", questionnaire.name())
            }
            Self::Questionnaire { questionnaire, after: None } => {
                write!(f, "questionnaire {} at the end", questionnaire.name())
            }
            Self::Running { trial } => write!(f, "the end of trial {}, which has begun", trial.number),
            Self::Done { why: EndReason::Finished } => write!(f, "nothing: all steps are done"),
            Self::Done { why: EndReason::Excluded } => write!(f, "nothing: the participant is excluded"),
        }
    }
}
