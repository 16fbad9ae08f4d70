//! The folder of a study, and the operations on it.

mod actions;
mod making;
mod sessions;

use std::{
    fmt,
    path::{Path, PathBuf},
};

use crate::{
    Assignment, CountedTrial, Exclusion, LearningModel, StudyError, StudyEvent, StudyPlan, StudyState, StudyStep,
    StudyTable, TrialId, TrialPhase,
    exclusion::exclusions,
    journal::{self, Chain, StudyJournal},
    learning::learning,
    seal::{self, Key},
    secret::RuleHashes,
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
const REASON: &str = "reason";

/// Returns the purpose of an encryption that is valid for one trial only.
fn purpose(plan: &StudyPlan, what: &str, participant: &str, trial: TrialId) -> String {
    let TrialId { phase, number, attempt } = trial;
    if plan.is_bound() { format!("{what} {participant} {phase:?} {number} {attempt}") } else { what.to_owned() }
}

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
    /// The hash of the journal, as it was read.
    chain: Chain,
    state: StudyState,
    /// Reason why a recording is not encrypted or decrypted yet.
    trouble: Option<String>,
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
    /// recorded. Recordings that cannot be encrypted or decrypted do not prevent it; see [`UserStudy::take_trouble`].
    ///
    /// # Errors
    /// There is no study, another program has it open, or a file was changed or damaged.
    pub fn open(folder: &Path, at: &str) -> Result<Self, StudyError> {
        let mut study = Self::load(folder)?;
        let path = folder.join(JOURNAL);
        let (journal, entries) = StudyJournal::open(&path, study.begin(), at)?;
        study.journal = Some(journal);
        study.follow(&path, &entries)?;
        let open = |(name, progress): (&str, &crate::ParticipantProgress)| Some((name.to_owned(), progress.open()?));
        let interrupted: Vec<_> = study.state.participants().filter_map(open).collect();
        for (participant, trial) in interrupted {
            study.write(at, StudyEvent::TrialInterrupted { participant, trial })?;
        }
        let tidied = study.tidy();
        study.keep_trouble(tidied);
        Ok(study)
    }

    /// Opens the study for reading: nothing is changed, and another program may have it open.
    ///
    /// # Errors
    /// As [`UserStudy::open`].
    pub fn read(folder: &Path) -> Result<Self, StudyError> {
        let mut study = Self::load(folder)?;
        let path = folder.join(JOURNAL);
        let contents = journal::read(&path, study.begin())?;
        study.follow(&path, &contents.entries)?;
        study.chain = contents.chain;
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
        let rules = text(PLAN)?;
        let plan = StudyPlan::parse(&rules).map_err(|why| damaged(PLAN, why))?;
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
        let now = RuleHashes { study: StudyPlan::hash_of(&rules), scene: seal::hash(scene.as_bytes()) };
        // A file that pretends to be of an older version differs from its hash too.
        let none = RuleHashes::NONE;
        let rules = secret.rules().or_else(|| plan.is_bound().then_some(&none));
        let changed = rules.and_then(|rules| {
            let pairs = [(PLAN, &rules.study, &now.study), (SCENE, &rules.scene, &now.scene)];
            pairs.into_iter().find(|(_, committed, now)| committed != now)
        });
        if let Some((name, ..)) = changed {
            let why = "it was changed after the study was created: the commitment covers it; restore it from a copy";
            return Err(damaged(name, why.to_owned()));
        }
        let state = StudyState::new(&plan);
        let chain = Chain::NONE;
        let folder = folder.to_owned();
        let trouble = None;
        Ok(Self { folder, plan, scene, key, secret_text, secret, journal: None, chain, state, trouble })
    }

    fn follow(&mut self, path: &Path, entries: &[crate::JournalEntry]) -> Result<(), StudyError> {
        if !matches!(entries.first().map(|entry| &entry.event), Some(StudyEvent::StudyMade { .. })) {
            let why = "its first entry is not the creation of the study: restore it from a copy".to_owned();
            return Err(StudyError::Damaged { path: path.to_owned(), why });
        }
        let wrong = |(line, why): (u64, String)| StudyError::Journal { path: path.to_owned(), line, why };
        self.state = StudyState::of(&self.plan, entries).map_err(wrong)?;
        for entry in entries {
            self.check_sealed(&entry.event).map_err(|why| wrong((entry.n, why)))?;
        }
        Ok(())
    }

    /// Refuses sealed texts that were changed, or that belong to another trial.
    pub(crate) fn check_sealed(&self, event: &StudyEvent) -> Result<(), String> {
        let (what, participant, trial, withheld) = match event {
            StudyEvent::TrialEnded { participant, trial, withheld, .. } => (MEASURES, participant, trial, withheld),
            StudyEvent::TrialAborted { participant, trial, withheld, .. } => (REASON, participant, trial, withheld),
            _ => return Ok(()),
        };
        let Some(sealed) = withheld else { return Ok(()) };
        let opened = self.key.open(&purpose(&self.plan, what, participant, *trial), sealed);
        opened.map(drop).map_err(|error| format!("its sealed text is not of this trial: {error}"))
    }

    fn begin(&self) -> Chain {
        if self.plan.is_bound() { Chain::BEGIN } else { Chain::NONE }
    }

    /// Returns the hash of the whole journal; `None` in a study of an older version.
    pub fn journal_hash(&self) -> Option<&str> {
        self.journal.as_ref().map_or(&self.chain, StudyJournal::chain).hash()
    }

    /// Returns and clears the reason why a recording is still readable in a blind study, or still encrypted after the
    /// unblinding. The results in the journal do not depend on it.
    pub fn take_trouble(&mut self) -> Option<String> {
        self.trouble.take()
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
        let withheld = |participant: &str, made: &CountedTrial| {
            let trial = TrialId { phase: TrialPhase::Trial, number: made.number, attempt: made.attempt };
            let purpose = purpose(&self.plan, MEASURES, participant, trial);
            serde_json::from_slice(&self.key.open(&purpose, made.withheld.as_deref()?).ok()?).ok()
        };
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
