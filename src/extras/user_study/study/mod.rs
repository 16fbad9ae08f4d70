//! The folder of a study, and the operations on it.

mod actions;
mod making;
mod sessions;

use std::{
    fmt,
    path::{Path, PathBuf},
};

use crate::{
    Assignment, Exclusion, LearningModel, StudyError, StudyEvent, StudyPlan, StudyState, StudyStep, StudyTable,
    exclusion::exclusions,
    journal::{self, StudyJournal},
    learning::learning,
    seal::{self, Key},
    table,
};

pub use actions::RunningTrial;

/// The journal's name in its folder.
pub const JOURNAL: &str = "journal.jsonl";
const PLAN: &str = "study.toml";
const SCENE: &str = "scene.toml";
const SEALED: &str = "conditions.sealed";
const OPENED: &str = "conditions.json";
const KEY: &str = "study.key";
/// Purpose of the encryption.
const CONDITIONS: &str = "conditions";
const MEASURES: &str = "measures";

/// An open study. Its `Debug` does not reveal the conditions.
pub struct UserStudy {
    folder: PathBuf,
    plan: StudyPlan,
    scene: String,
    key: Key,
    /// The exact text that was committed to.
    secret_text: String,
    secret: Assignment,
    /// `None` if the study was opened for reading only.
    journal: Option<StudyJournal>,
    state: StudyState,
}

impl fmt::Debug for UserStudy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { folder, plan, state, .. } = self;
        f.debug_struct("Study")
            .field("folder", folder)
            .field("plan", plan)
            .field("state", state)
            .finish_non_exhaustive()
    }
}

impl UserStudy {
    /// Opens the study exclusively for writing. A trial that had begun and has not ended was interrupted, which is
    /// recorded.
    ///
    /// # Errors
    /// There is no study, another program has it open, or a file was changed or damaged.
    pub fn open(folder: &Path, at: &str) -> Result<Self, StudyError> {
        let mut study = Self::load(folder)?;
        let path = folder.join(JOURNAL);
        let (journal, entries) = StudyJournal::open(&path, at)?;
        study.journal = Some(journal);
        study.follow(&path, &entries)?;
        let open = |(name, progress): (&str, &crate::ParticipantProgress)| Some((name.to_owned(), progress.open()?));
        let interrupted: Vec<_> = study.state.participants().filter_map(open).collect();
        for (participant, trial) in interrupted {
            study.write(at, StudyEvent::TrialInterrupted { participant, trial })?;
        }
        study.tidy()?;
        Ok(study)
    }

    /// Opens the study for reading: nothing is changed, and another program may have it open.
    ///
    /// # Errors
    /// As [`UserStudy::open`].
    pub fn read(folder: &Path) -> Result<Self, StudyError> {
        let mut study = Self::load(folder)?;
        let path = folder.join(JOURNAL);
        let contents = journal::read(&path)?;
        study.follow(&path, &contents.entries)?;
        // Another program may be writing this line now; opening the study for writing truncates it.
        if contents.torn > 0 {
            study.state.torn.push(contents.torn);
        }
        Ok(study)
    }

    fn load(folder: &Path) -> Result<Self, StudyError> {
        let text = |name: &str| {
            let path = folder.join(name);
            nima_files::read_text(&path, nima_files::CONFIG_MAX).map_err(StudyError::io(path))
        };
        let damaged = |name: &str, why: String| StudyError::Damaged { path: folder.join(name), why };
        let plan = StudyPlan::parse(&text(PLAN)?).map_err(|why| damaged(PLAN, why))?;
        let key = Key::from_hex(&text(KEY)?).ok_or_else(|| damaged(KEY, "it is not a study key".to_owned()))?;
        let plain = key.open(CONDITIONS, &text(SEALED)?).map_err(|error| damaged(SEALED, error.to_string()))?;
        if seal::hash(&plain) != plan.commitment {
            let why = "the assignment does not match the commitment in study.toml: one of them was changed".to_owned();
            return Err(damaged(SEALED, why));
        }
        let unreadable = || damaged(SEALED, "it was written by a different version of this program".to_owned());
        let secret: Assignment = serde_json::from_slice(&plain).map_err(|_| unreadable())?;
        let secret_text = String::from_utf8(plain).map_err(|_| unreadable())?;
        let scene = text(SCENE)?;
        let state = StudyState::new(&plan);
        Ok(Self { folder: folder.to_owned(), plan, scene, key, secret_text, secret, journal: None, state })
    }

    fn follow(&mut self, path: &Path, entries: &[crate::JournalEntry]) -> Result<(), StudyError> {
        if !matches!(entries.first().map(|entry| &entry.event), Some(StudyEvent::StudyMade { .. })) {
            let why = "its first entry is not the creation of the study: restore it from a copy".to_owned();
            return Err(StudyError::Damaged { path: path.to_owned(), why });
        }
        let wrong = |(line, why): (u64, String)| StudyError::Journal { path: path.to_owned(), line, why };
        self.state = StudyState::of(&self.plan, entries).map_err(wrong)?;
        Ok(())
    }

    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Returns the public part of the study.
    pub const fn plan(&self) -> &StudyPlan {
        &self.plan
    }

    /// Returns the text of its scene file.
    pub fn scene(&self) -> &str {
        &self.scene
    }

    /// Returns its current state.
    pub const fn state(&self) -> &StudyState {
        &self.state
    }

    /// Returns the assignment if it may be shown: after the unblinding, or in a study that is not blind.
    pub fn opened(&self) -> Option<&Assignment> {
        self.state.is_open(&self.plan).then_some(&self.secret)
    }

    /// Returns the next step of this participant.
    ///
    /// # Errors
    /// [`StudyError::Participant`] if there is no such participant.
    pub fn next(&self, participant: &str) -> Result<StudyStep, StudyError> {
        Ok(self.state.next(&self.plan, self.plan.participant(participant)?))
    }

    /// Returns the table of trials for `nima study trials`.
    pub fn trials(&self) -> StudyTable {
        let withheld = |sealed: &str| serde_json::from_slice(&self.key.open(MEASURES, sealed).ok()?).ok();
        table::trials(&self.plan, &self.state, self.opened(), withheld)
    }

    /// Returns the scores of the questionnaires after each condition.
    pub fn questionnaires(&self) -> StudyTable {
        table::questionnaires(&self.plan, &self.state, self.opened())
    }

    /// Returns the exclusions from the analysis, with their reasons.
    pub fn exclusions(&self) -> Vec<Exclusion> {
        exclusions(&self.plan, &self.state)
    }

    /// Returns proficiency and learning curve of every participant who has begun.
    pub fn learning(&self) -> Vec<LearningModel> {
        learning(&self.state)
    }
}
