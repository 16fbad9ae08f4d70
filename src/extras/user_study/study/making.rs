//! Making the folder of a study: whole, or not at all.

use std::{
    fs::{self, File},
    io,
    path::Path,
};

use super::{CONDITIONS, JOURNAL, KEY, PLAN, SCENE, SEALED, Study};
use crate::{
    Event, Opened, Plan, StudyError, StudyFile,
    journal::Journal,
    seal::{self, Key},
};

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
        // Elsewhere an empty folder is replaced.
        if cfg!(windows) && folder.exists() {
            fs::remove_dir(folder).map_err(StudyError::io(folder))?;
        }
        fs::rename(made.path(), folder).map_err(StudyError::io(folder))?;
        synced(parent).map_err(StudyError::io(parent))?;
        Self::open(folder, at)
    }
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
        // Windows writes out only what may be written to.
        File::options().write(true).open(path)?.sync_all()?;
    }
    nima_files::write_private(&folder.join(KEY), &(key.to_hex() + "\n"))?;
    Ok(commitment)
}

/// Names in a folder are on the disk too.
fn synced(folder: &Path) -> io::Result<()> {
    if cfg!(unix) { File::open(folder)?.sync_all() } else { Ok(()) }
}
