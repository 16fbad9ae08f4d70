//! The folder of a study, and all that can be done with it.

mod sessions;

use std::{
    fmt,
    fs::{self, File},
    io,
    path::{Path, PathBuf},
};

use nima_score::Score;

use crate::{
    Answers, Condition, Ending, Event, Exclusion, Label, Learning, Measures, Opened, Participant, Plan, State, Step,
    StudyError, StudyFile, Table, TrialId,
    entry::measures,
    exclusion::exclusions,
    journal::{self, Journal},
    learning::learning,
    seal::{self, Key},
    table, telling,
};

/// The journal's name in its folder.
pub const JOURNAL: &str = "journal.jsonl";
const PLAN: &str = "study.toml";
const SCENE: &str = "scene.toml";
const SEALED: &str = "conditions.sealed";
const OPENED: &str = "conditions.json";
const KEY: &str = "study.key";
/// What is encrypted.
const CONDITIONS: &str = "conditions";
const MEASURES: &str = "measures";

/// An open study. Its `Debug` does not tell the conditions.
pub struct Study {
    folder: PathBuf,
    plan: Plan,
    scene: String,
    key: Key,
    /// What was committed to, letter by letter.
    secret_text: String,
    secret: Opened,
    /// None for reading only.
    journal: Option<Journal>,
    state: State,
}

impl fmt::Debug for Study {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { folder, plan, state, .. } = self;
        f.debug_struct("Study")
            .field("folder", folder)
            .field("plan", plan)
            .field("state", state)
            .finish_non_exhaustive()
    }
}

/// A trial that has begun. Its `Debug` does not tell the condition.
#[derive(Debug)]
pub struct Running {
    participant: String,
    trial: TrialId,
    label: Option<Label>,
    condition: Condition,
    session: Option<PathBuf>,
}

impl Running {
    /// Which trial.
    pub const fn trial(&self) -> TrialId {
        self.trial
    }

    /// What stands for its condition; nothing in practice.
    pub const fn label(&self) -> Option<Label> {
        self.label
    }

    /// What the hand is to feel: for the loop alone, nothing may show it.
    pub const fn condition(&self) -> &Condition {
        &self.condition
    }

    /// Where to record it, if it is to be recorded. Encrypted when the trial is over.
    pub fn session(&self) -> Option<&Path> {
        self.session.as_deref()
    }
}

impl Study {
    /// Makes the folder of a study: whole, or not at all. `scene` is the text of the scene file, which is kept in the folder.
    ///
    /// # Errors
    /// A folder with something in it, mistakes in the file, whatever the system says.
    pub fn create(folder: &Path, file: &StudyFile, scene: &str, at: &str) -> Result<Self, StudyError> {
        file.check()?;
        let is_empty = fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_none());
        if folder.symlink_metadata().is_ok() && !is_empty {
            return Err(StudyError::Exists { folder: folder.to_owned() });
        }
        let parent = folder.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or_else(|| Path::new("."));
        fs::create_dir_all(parent).map_err(StudyError::io(parent))?;
        let made = tempfile::Builder::new().prefix(".study-").tempdir_in(parent).map_err(StudyError::io(parent))?;
        let failed = StudyError::io(folder);
        let commitment = fill(made.path(), file, scene).map_err(failed)?;
        let mut journal = Journal::create(&made.path().join(JOURNAL))?;
        journal.append(at, Event::StudyMade { commitment })?;
        drop(journal);
        synced(made.path()).map_err(StudyError::io(folder))?;
        fs::rename(made.path(), folder).map_err(StudyError::io(folder))?;
        synced(parent).map_err(StudyError::io(parent))?;
        Self::open(folder, at)
    }

    /// Opens it to go on, for this program alone. A trial that had begun and has not ended was interrupted: that is written down.
    ///
    /// # Errors
    /// No study there, another program that has it open, a file that was changed or damaged.
    pub fn open(folder: &Path, at: &str) -> Result<Self, StudyError> {
        let mut study = Self::load(folder)?;
        let path = folder.join(JOURNAL);
        let (journal, entries) = Journal::open(&path, at)?;
        study.journal = Some(journal);
        study.follow(&path, &entries)?;
        let open = |(name, progress): (&str, &crate::Progress)| Some((name.to_owned(), progress.open()?));
        let interrupted: Vec<_> = study.state.participants().filter_map(open).collect();
        for (participant, trial) in interrupted {
            study.write(at, Event::TrialInterrupted { participant, trial })?;
        }
        study.tidy()?;
        Ok(study)
    }

    /// Opens it to look at it: nothing is changed, and another program may have it open.
    ///
    /// # Errors
    /// As [`Study::open`].
    pub fn read(folder: &Path) -> Result<Self, StudyError> {
        let mut study = Self::load(folder)?;
        let path = folder.join(JOURNAL);
        let contents = journal::read(&path)?;
        study.follow(&path, &contents.entries)?;
        // Another program may be writing this line just now; who opens the study cuts it off.
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
        let plan = Plan::parse(&text(PLAN)?).map_err(|why| damaged(PLAN, why))?;
        let key = Key::from_hex(&text(KEY)?).ok_or_else(|| damaged(KEY, "it is no key of a study".to_owned()))?;
        let plain = key.open(CONDITIONS, &text(SEALED)?).map_err(|error| damaged(SEALED, error.to_string()))?;
        if seal::hash(&plain) != plan.commitment {
            let why = "the assignment does not fit to the commitment in study.toml: one of them was changed".to_owned();
            return Err(damaged(SEALED, why));
        }
        let unreadable = || damaged(SEALED, "it was written by another version of the program".to_owned());
        let secret: Opened = serde_json::from_slice(&plain).map_err(|_| unreadable())?;
        let secret_text = String::from_utf8(plain).map_err(|_| unreadable())?;
        let (scene, state) = (text(SCENE)?, State::new(&plan));
        Ok(Self { folder: folder.to_owned(), plan, scene, key, secret_text, secret, journal: None, state })
    }

    fn follow(&mut self, path: &Path, entries: &[crate::Entry]) -> Result<(), StudyError> {
        if !matches!(entries.first().map(|entry| &entry.event), Some(Event::StudyMade { .. })) {
            let why = "it does not begin with the making of the study: restore it from a copy".to_owned();
            return Err(StudyError::Damaged { path: path.to_owned(), why });
        }
        let wrong = |(line, why): (u64, String)| StudyError::Journal { path: path.to_owned(), line, why };
        self.state = State::of(&self.plan, entries).map_err(wrong)?;
        Ok(())
    }

    /// Its folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// What everybody may know of it.
    pub const fn plan(&self) -> &Plan {
        &self.plan
    }

    /// The text of its scene file.
    pub fn scene(&self) -> &str {
        &self.scene
    }

    /// Where it stands.
    pub const fn state(&self) -> &State {
        &self.state
    }

    /// The assignment, where it may be shown: after the unblinding, or in a study that is not blind.
    pub fn opened(&self) -> Option<&Opened> {
        self.state.is_open(&self.plan).then_some(&self.secret)
    }

    /// What this participant does next.
    ///
    /// # Errors
    /// [`StudyError::Participant`].
    pub fn next(&self, participant: &str) -> Result<Step, StudyError> {
        Ok(self.state.next(&self.plan, self.plan.participant(participant)?))
    }

    /// Begins the trial that comes next; it is in the journal when this returns.
    ///
    /// # Errors
    /// [`StudyError::NotNow`] if something else comes next.
    pub fn begin_trial(&mut self, participant: &str, simulated: bool, at: &str) -> Result<Running, StudyError> {
        let who = self.plan.participant(participant)?.clone();
        let next = self.state.next(&self.plan, &who);
        let (trial, label) = next.trial().ok_or_else(|| not_now(participant, "a trial", &next))?;
        let condition = self.condition(&who, trial, label).cloned();
        let condition = condition.ok_or_else(|| StudyError::Refused("the assignment has no such label".to_owned()))?;
        let session = self.plan.record.then(|| self.session_of(participant, trial)).transpose()?;
        if !self.state.progress(participant).is_some_and(|progress| progress.began) {
            self.write(at, Event::ParticipantBegan { participant: participant.to_owned() })?;
        }
        self.write(at, Event::TrialBegan { participant: participant.to_owned(), trial, label, simulated })?;
        Ok(Running { participant: participant.to_owned(), trial, label, condition, session })
    }

    fn condition(&self, who: &Participant, trial: TrialId, label: Option<Label>) -> Option<&Condition> {
        if let Some(label) = label {
            return self.secret.condition(label);
        }
        // Without a condition of its own, practice takes each in turn.
        let turn = (trial.number as usize).checked_sub(1)? % who.order.len().max(1);
        self.secret.practice().or_else(|| self.secret.condition(*who.order.get(turn)?))
    }

    /// Ends a trial that has a result.
    ///
    /// # Errors
    /// Whatever the system says while writing.
    pub fn end_trial(&mut self, running: Running, ending: Ending, score: &Score, at: &str) -> Result<(), StudyError> {
        let is_told = self.state.is_open(&self.plan);
        let (telling, told): (Measures, Measures) =
            measures(score).into_iter().partition(|(key, _)| !is_told && telling::tells(key));
        let withheld = (!telling.is_empty()).then(|| {
            let text = serde_json::to_vec(&telling).map_err(io::Error::from)?;
            self.key.seal(MEASURES, &text)
        });
        let withheld = withheld.transpose().map_err(StudyError::io(&self.folder))?;
        let session = running.session.as_deref().filter(|path| path.is_file());
        let session = session.map(|path| self.put_away(path)).transpose()?;
        let Running { participant, trial, .. } = running;
        self.write(at, Event::TrialEnded { participant, trial, ending, measures: told, withheld, session })
    }

    /// Gives up a trial; the rule of the study says what follows.
    ///
    /// # Errors
    /// Whatever the system says while writing.
    pub fn abort_trial(&mut self, running: Running, why: &str, at: &str) -> Result<(), StudyError> {
        if let Some(path) = running.session.as_deref().filter(|path| path.is_file()) {
            self.put_away(path)?;
        }
        let Running { participant, trial, .. } = running;
        self.write(at, Event::TrialAborted { participant, trial, why: why.to_owned() })
    }

    /// Writes down a break, also one that was not due.
    ///
    /// # Errors
    /// [`StudyError::Refused`] if it was shorter than the study asks for.
    pub fn take_break(&mut self, participant: &str, seconds: f64, simulated: bool, at: &str) -> Result<(), StudyError> {
        let next = self.next(participant)?;
        if let Step::Break { least_s } = next
            && seconds < least_s
        {
            return Err(StudyError::Refused(format!(
                "{participant}: the break has to last {least_s:.0} s, and it was {seconds:.0} s"
            )));
        }
        if matches!(next, Step::Running { .. }) || !seconds.is_finite() {
            return Err(not_now(participant, "a break", &next));
        }
        self.write(at, Event::BreakTaken { participant: participant.to_owned(), seconds, simulated })
    }

    /// Takes the answers to the questionnaire that comes next.
    ///
    /// # Errors
    /// [`StudyError::NotNow`] if another one comes next, [`StudyError::Answers`] if the form does not allow an answer.
    pub fn answer(&mut self, participant: &str, answers: Answers, simulated: bool, at: &str) -> Result<(), StudyError> {
        let next = self.next(participant)?;
        let Step::Questionnaire { questionnaire, after } = next else {
            return Err(not_now(participant, "a questionnaire", &next));
        };
        if questionnaire != answers.questionnaire() {
            return Err(not_now(participant, answers.questionnaire().name(), &next));
        }
        answers.check().map_err(|why| StudyError::Answers { participant: participant.to_owned(), why })?;
        self.write(at, Event::Answered { participant: participant.to_owned(), after, answers, simulated })
    }

    /// Leaves a participant out of the analysis, or one trial.
    ///
    /// # Errors
    /// A trial that was not made.
    pub fn exclude(&mut self, participant: &str, number: Option<u32>, why: &str, at: &str) -> Result<(), StudyError> {
        self.plan.participant(participant)?;
        if why.trim().is_empty() {
            return Err(StudyError::Refused("an exclusion needs a reason".to_owned()));
        }
        self.write(at, Event::Excluded { participant: participant.to_owned(), number, why: why.to_owned() })
    }

    /// Keeps a note.
    ///
    /// # Errors
    /// An unknown participant.
    pub fn note(&mut self, participant: Option<&str>, text: &str, at: &str) -> Result<(), StudyError> {
        participant.map(|name| self.plan.participant(name)).transpose()?;
        self.write(at, Event::Noted { participant: participant.map(str::to_owned), text: text.to_owned() })
    }

    /// Opens the assignment: an act that is written down. From then on the tables name the conditions.
    ///
    /// # Errors
    /// [`StudyError::Refused`] without a name and a reason, in a study that is not blind, and the second time.
    pub fn unblind(&mut self, who: &str, why: &str, at: &str) -> Result<(), StudyError> {
        let refused = |why: String| Err(StudyError::Refused(why));
        if who.trim().is_empty() || why.trim().is_empty() {
            return refused("an unblinding needs a name and a reason".to_owned());
        }
        if !self.plan.blind {
            return refused("the study is not blind: its conditions are known".to_owned());
        }
        if let Some(before) = &self.state.unblinding {
            return refused(format!("the study was unblinded already, by {} at {}", before.who, before.at));
        }
        let [who, why] = [who, why].map(|text| text.trim().to_owned());
        self.write(at, Event::Unblinded { who, why, commitment: self.plan.commitment.clone() })?;
        self.tidy()
    }

    /// The table of trials for `nima study trials`.
    pub fn trials(&self) -> Table {
        let withheld = |sealed: &str| serde_json::from_slice(&self.key.open(MEASURES, sealed).ok()?).ok();
        table::trials(&self.plan, &self.state, self.opened(), withheld)
    }

    /// The scores of the questionnaires after each condition.
    pub fn questionnaires(&self) -> Table {
        table::questionnaires(&self.plan, &self.state, self.opened())
    }

    /// What is left out of the analysis, and why.
    pub fn exclusions(&self) -> Vec<Exclusion> {
        exclusions(&self.plan, &self.state)
    }

    /// Proficiency and learning curve of everybody who has begun.
    pub fn learning(&self) -> Vec<Learning> {
        learning(&self.state)
    }

    fn write(&mut self, at: &str, event: Event) -> Result<(), StudyError> {
        let Some(journal) = &mut self.journal else { return Err(StudyError::ReadOnly) };
        // What the state refuses must not stand in the journal, which could then not be read any more.
        let mut state = self.state.clone();
        let refused = |why: String| StudyError::Refused(why);
        state.take(&self.plan, &crate::Entry { n: 0, at: at.to_owned(), event: event.clone() }).map_err(refused)?;
        journal.append(at, event)?;
        self.state = state;
        Ok(())
    }
}

fn not_now(participant: &str, asked: &str, next: &Step) -> StudyError {
    StudyError::NotNow { participant: participant.to_owned(), asked: asked.to_owned(), next: next.to_string() }
}

/// Writes the files of a new study; gives the commitment.
fn fill(folder: &Path, file: &StudyFile, scene: &str) -> io::Result<String> {
    let key = Key::new()?;
    let secret = serde_json::to_string_pretty(&Opened::draw(file)?)? + "\n";
    let commitment = seal::hash(secret.as_bytes());
    let plan = Plan::draw(file, commitment.clone())?;
    let plan = toml::to_string(&plan).map_err(io::Error::other)?;
    for (name, text) in
        [(PLAN, &plan), (SCENE, &scene.to_owned()), (SEALED, &(key.seal(CONDITIONS, secret.as_bytes())? + "\n"))]
    {
        let path = folder.join(name);
        nima_files::write_atomically(&path, |file| file.write_all(text.as_bytes()))?;
        File::open(path)?.sync_all()?;
    }
    nima_files::write_private(&folder.join(KEY), &(key.to_hex() + "\n"))?;
    Ok(commitment)
}

/// Names in a folder are on the disk too.
fn synced(folder: &Path) -> io::Result<()> {
    if cfg!(unix) { File::open(folder)?.sync_all() } else { Ok(()) }
}
