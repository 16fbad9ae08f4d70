//! Recordings of trials: encrypted when the trial is over, decrypted by the unblinding.

use std::{
    fs::{self, File},
    io::{self, BufReader, BufWriter},
    path::{Path, PathBuf},
};

use super::{OPENED, UserStudy};
use crate::{StudyError, TrialId, TrialPhase};

const SESSIONS: &str = "sessions";
/// The ending of an encrypted session.
const SEALED_END: &str = "sealed";
/// Purpose of the encryption.
const SESSION: &str = "session";

impl UserStudy {
    /// Returns the path of a recording.
    pub(super) fn session_of(&self, participant: &str, trial: TrialId) -> Result<PathBuf, StudyError> {
        let folder = self.folder.join(SESSIONS);
        fs::create_dir_all(&folder).map_err(StudyError::io(&folder))?;
        let phase = if trial.phase == TrialPhase::Practice { "practice" } else { "trial" };
        Ok(folder.join(format!("{participant}-{phase}-{:02}-{}.mcap", trial.number, trial.attempt)))
    }

    /// Encrypts a recording if it must be hidden; returns its name in the folder.
    pub(super) fn put_away(&self, plain: &Path) -> Result<String, StudyError> {
        let kept = if self.state.is_open(&self.plan) {
            plain.to_owned()
        } else {
            let sealed = with_end(plain);
            self.pass(plain, &sealed, |from, to| self.key.seal_stream(SESSION, from, to))?;
            sealed
        };
        let name = kept.file_name().unwrap_or_default().to_string_lossy();
        Ok(format!("{SESSIONS}/{name}"))
    }

    /// Writes `to` from `from`, whole and on the disk, and removes `from`.
    fn pass(
        &self,
        from: &Path,
        to: &Path,
        through: impl FnOnce(BufReader<File>, &mut dyn io::Write) -> io::Result<()>,
    ) -> Result<(), StudyError> {
        let source = File::open(from).map_err(StudyError::io(from))?;
        let mut target = tempfile::NamedTempFile::new_in(self.folder.join(SESSIONS)).map_err(StudyError::io(to))?;
        through(BufReader::new(source), &mut BufWriter::new(target.as_file_mut())).map_err(StudyError::io(from))?;
        target.as_file().sync_all().map_err(StudyError::io(to))?;
        target.persist(to).map_err(|error| StudyError::Io { path: to.to_owned(), source: error.error })?;
        fs::remove_file(from).map_err(StudyError::io(from))
    }

    /// Makes the folder match the journal: recordings left by an interrupted program are encrypted, and after the
    /// unblinding all are decrypted and the assignment is readable.
    pub(super) fn tidy(&self) -> Result<(), StudyError> {
        let is_open = self.state.is_open(&self.plan);
        let opened = self.folder.join(OPENED);
        if is_open && !opened.exists() {
            let written = nima_files::write_atomically(&opened, |file| file.write_all(self.secret_text.as_bytes()));
            written.map_err(StudyError::io(opened))?;
        }
        let Ok(sessions) = fs::read_dir(self.folder.join(SESSIONS)) else { return Ok(()) };
        for path in sessions.filter_map(|entry| Some(entry.ok()?.path())) {
            let end = path.extension().unwrap_or_default();
            if is_open && end == SEALED_END {
                self.pass(&path, &path.with_extension(""), |from, to| self.key.open_stream(SESSION, from, to))?;
            } else if !is_open && end == "mcap" {
                self.put_away(&path)?;
            }
        }
        Ok(())
    }
}

fn with_end(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(".");
    name.push(SEALED_END);
    PathBuf::from(name)
}
