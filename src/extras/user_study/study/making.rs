//! Making the folder of a study: whole, or not at all.

use std::{
    fs::{self, File},
    io,
    path::Path,
};

use super::{CONDITIONS, JOURNAL, KEY, PLAN, SCENE, SEALED, UserStudy};
use crate::{
    Assignment, StudyError, StudyEvent, StudyFile, StudyPlan,
    journal::StudyJournal,
    seal::{self, Key},
    secret::RuleHashes,
};

impl UserStudy {
    /// Creates the folder of a study: whole, or not at all. `scene` is the text of the scene file, which is stored in
    /// the folder.
    ///
    /// # Errors
    /// The folder is not empty, the file has mistakes, or an I/O error.
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
        let mut journal = StudyJournal::create(&made.path().join(JOURNAL))?;
        journal.append(at, StudyEvent::StudyMade { commitment })?;
        drop(journal);
        synced(made.path()).map_err(StudyError::io(folder))?;
        // Other systems replace an empty folder.
        if cfg!(windows) && folder.exists() {
            fs::remove_dir(folder).map_err(StudyError::io(folder))?;
        }
        fs::rename(made.path(), folder).map_err(StudyError::io(folder))?;
        synced(parent).map_err(StudyError::io(parent))?;
        Self::open(folder, at)
    }
}

/// Writes the files of a new study; returns the commitment.
fn fill(folder: &Path, file: &StudyFile, scene: &str) -> io::Result<String> {
    let key = Key::new()?;
    let mut plan = StudyPlan::draw(file, String::new())?;
    let text = |plan: &StudyPlan| toml::to_string(plan).map_err(io::Error::other);
    let rules = RuleHashes { study: StudyPlan::hash_of(&text(&plan)?), scene: seal::hash(scene.as_bytes()) };
    let secret = serde_json::to_string_pretty(&Assignment::draw(file)?.with_rules(rules))? + "\n";
    let commitment = seal::hash(secret.as_bytes());
    plan.commitment.clone_from(&commitment);
    let plan = text(&plan)?;
    for (name, text) in
        [(PLAN, &plan), (SCENE, &scene.to_owned()), (SEALED, &(key.seal(CONDITIONS, secret.as_bytes())? + "\n"))]
    {
        let path = folder.join(name);
        nima_files::write_atomically(&path, |file| file.write_all(text.as_bytes()))?;
        // Windows syncs only files that are open for writing.
        File::options().write(true).open(path)?.sync_all()?;
    }
    nima_files::write_private(&folder.join(KEY), &(key.to_hex() + "\n"))?;
    Ok(commitment)
}

/// Makes the names in the folder durable too.
fn synced(folder: &Path) -> io::Result<()> {
    if cfg!(unix) { File::open(folder)?.sync_all() } else { Ok(()) }
}
