//! User studies in a laboratory: the next step of each participant, and the condition, blind.
//!
//! A person writes a [`StudyFile`]. [`UserStudy::create`] makes a folder of it: pseudonyms, an order for each participant
//! ([`order`]), labels A, B, ... instead of the conditions, and the assignment of labels to conditions, encrypted and
//! committed to by its hash. Every event is written to the folder's journal, one line each, and is on the disk before
//! the call returns. [`StudyState`] (for example the next step of P03) is a pure function of [`StudyPlan`] and journal.
//! Questionnaires are scored as published ([`Questionnaire`]); [`UserStudy::trials`] returns the table for the analysis.
//!
//! Independent of loop, window, threads and clocks: times are passed in as text. A program that runs a trial gets its
//! condition from [`UserStudy::begin_trial`]; nothing here prints it.
//!
//! ```
//! use nima_user_study::{StudyStep, UserStudy, StudyFile};
//!
//! let text = "
//!     name = 'Two kinds of feedback'
//!     scene = 'rings'
//!     primary = 'completion_time_s'
//!     participants = 4
//!     trials = 2
//!     [[conditions]]
//!     name = 'reflection'
//!     mode = 'dfr'
//!     delay_ms = 50.0
//!     [[conditions]]
//!     name = 'without'
//!     no_force = true
//! ";
//! let file = StudyFile::from_toml(text)?;
//! let folder = tempfile::tempdir()?;
//! let place = folder.path().join("study");
//! let study = UserStudy::create(&place, &file, "name = 'scene'", "2026-01-01T09:00:00Z")?;
//! assert!(matches!(study.next("P01")?, StudyStep::Trial { number: 1, attempt: 1, .. }));
//! let public = std::fs::read_to_string(place.join("study.toml"))?;
//! assert!(!public.contains("dfr") && public.contains(&study.plan().commitment));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod answers;
mod condition;
mod entry;
mod error;
mod exclusion;
mod file;
mod journal;
mod label;
mod learning;
pub mod order;
mod plan;
mod progress;
mod questionnaire;
mod seal;
mod secret;
pub mod simulated;
mod state;
mod step;
mod study;
mod table;
#[cfg(test)]
mod tests;
mod unblinding_risk;

pub use answers::{QuestionnaireAnswers, Ratings};
pub use condition::Condition;
pub use entry::{JournalEntry, StudyEvent, TrialEnding, TrialId, TrialMeasures, TrialPhase};
pub use error::StudyError;
pub use exclusion::{Excludes, Exclusion, ExclusionRule, MeasureComparison};
pub use file::{
    ATTEMPTS_MAX, BREAK_AFTER_MAX, BREAK_MAX_S, Breaks, InterruptionPolicy, Mistakes, NotReached, PARTICIPANTS_MAX,
    PRACTICE_MAX, Practice, Questionnaires, StudyFile, TRIALS_MAX, keys_of,
};
pub use label::Label;
pub use learning::LearningModel;
pub use plan::{Participant, PracticePlan, ResultDisplay, StudyPlan};
pub use progress::{CountedTrial, ParticipantProgress};
pub use questionnaire::{
    PAIRS, Questionnaire, REALISM_ITEM, SUS_ITEMS, TLX_SCALES, TlxScale, of_sus, raw_tlx, weighted_tlx,
};
pub use secret::Assignment;
pub use state::{StudyState, Unblinding};
pub use step::{EndReason, StudyStep};
pub use study::{JOURNAL, RunningTrial, UserStudy};
pub use table::StudyTable;
