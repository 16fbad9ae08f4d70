//! Recordings of trials: encrypted when the trial is over, decrypted by the unblinding.

use std::{
    fs::{self, File},
    io::{self, BufReader, BufWriter, Read},
    path::{Path, PathBuf},
};

use super::{OPENED, UserStudy};
use crate::{StudyError, TrialId, TrialPhase};

const SESSIONS: &str = "sessions";
/// The ending of an encrypted session.
const SEALED_END: &str = "sealed";
/// Purpose of the encryption.
const SESSION: &str = "session";
/// Minimum length of an encrypted session, bytes.
const SEALED_MIN: u64 = 1 << 20;

impl UserStudy {
    /// Returns the path of a recording.
    pub(super) fn session_of(&self, participant: &str, trial: TrialId) -> Result<PathBuf, StudyError> {
        let folder = self.folder.join(SESSIONS);
        fs::create_dir_all(&folder).map_err(StudyError::io(&folder))?;
        let phase = if trial.phase == TrialPhase::Practice { "practice" } else { "trial" };
        Ok(folder.join(format!("{participant}-{phase}-{:02}-{}.mcap", trial.number, trial.attempt)))
    }

    /// Returns the name that a recording has in the folder after its trial.
    pub(super) fn name_after_trial(&self, plain: &Path) -> String {
        let kept = if self.state.is_open(&self.plan) { plain.to_owned() } else { with_end(plain) };
        let name = kept.file_name().unwrap_or_default().to_string_lossy();
        format!("{SESSIONS}/{name}")
    }

    /// Encrypts the recording of a trial whose end is in the journal. A failure loses nothing: the recording is encrypted
    /// when the study is opened again.
    pub(super) fn seal_recording(&mut self, plain: Option<&Path>) {
        let sealed = plain.map_or(Ok(()), |plain| self.put_away(plain));
        self.keep_trouble(sealed);
    }

    /// Keeps an error of the recordings for [`UserStudy::take_trouble`].
    pub(super) fn keep_trouble(&mut self, done: Result<(), StudyError>) {
        let action = if self.state.is_open(&self.plan) { "decrypt" } else { "encrypt" };
        if let Err(error) = done {
            self.trouble = Some(format!(
                "cannot {action} a recording: {error}; if the disk is full, free space, then open the study again"
            ));
        }
    }

    /// Encrypts a recording if it must be hidden.
    fn put_away(&self, plain: &Path) -> Result<(), StudyError> {
        if self.state.is_open(&self.plan) {
            return Ok(());
        }
        let sealed = with_end(plain);
        let length = fs::metadata(plain).map_err(StudyError::io(plain))?.len();
        let size = self.sealed_size(length);
        self.pass(plain, &sealed, |from, to| {
            // Forces compress worse than zeros, so the length would reveal the condition.
            let padding = io::repeat(0).take(size.saturating_sub(length));
            let head = length.to_le_bytes();
            let padded = head.as_slice().chain(from).chain(padding);
            self.key.seal_stream(&self.purpose_of_session(plain), padded, to)
        })
    }

    /// Returns the length to which sessions are padded: a power of two, the same for all sessions from the first one that
    /// needed it.
    fn sealed_size(&self, length: u64) -> u64 {
        let entries = fs::read_dir(self.folder.join(SESSIONS)).into_iter().flatten().flatten();
        let sealed = entries.filter(|entry| entry.path().extension().is_some_and(|end| end == SEALED_END));
        let sizes = sealed.filter_map(|entry| Some(entry.metadata().ok()?.len().checked_next_power_of_two()? / 2));
        sizes.fold(length.next_power_of_two().max(SEALED_MIN), u64::max)
    }

    /// Returns the purpose of the encryption, which names the trial.
    fn purpose_of_session(&self, plain: &Path) -> String {
        let name = plain.file_name().unwrap_or_default().to_string_lossy();
        if self.plan.is_bound() { format!("{SESSION} {name}") } else { SESSION.to_owned() }
    }

    fn open_session(&self, plain: &Path, from: impl Read, to: &mut dyn io::Write) -> io::Result<()> {
        let purpose = self.purpose_of_session(plain);
        if !self.plan.is_bound() {
            return self.key.open_stream(&purpose, from, to);
        }
        self.key.open_stream(&purpose, from, &mut Unpadded { to, length: Vec::new(), rest: 0 })
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
    /// unblinding all are decrypted and the assignment is readable. A file that fails does not prevent the others; the
    /// first error is returned.
    pub(super) fn tidy(&self) -> Result<(), StudyError> {
        let mut done = Ok(());
        let is_open = self.state.is_open(&self.plan);
        let opened = self.folder.join(OPENED);
        if is_open && !opened.exists() {
            let written = nima_files::write_atomically(&opened, |file| file.write_all(self.secret_text.as_bytes()));
            done = written.map_err(StudyError::io(opened));
        }
        let Ok(sessions) = fs::read_dir(self.folder.join(SESSIONS)) else { return done };
        for path in sessions.filter_map(|entry| Some(entry.ok()?.path())) {
            let end = path.extension().unwrap_or_default();
            let passed = if is_open && end == SEALED_END {
                let plain = path.with_extension("");
                self.pass(&path, &plain, |from, to| self.open_session(&plain, from, to))
            } else if !is_open && end == "mcap" {
                self.put_away(&path)
            } else {
                Ok(())
            };
            done = done.and(passed);
        }
        done
    }
}

/// Passes on a session without the length before it and the padding after it.
struct Unpadded<'a> {
    to: &'a mut dyn io::Write,
    /// The bytes of the length that have arrived.
    length: Vec<u8>,
    rest: u64,
}

impl io::Write for Unpadded<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if let Some(missing) = size_of::<u64>().checked_sub(self.length.len() + 1) {
            let (length, _) = bytes.split_at(bytes.len().min(missing + 1));
            self.length.extend_from_slice(length);
            if let Ok(length) = self.length.as_slice().try_into() {
                self.rest = u64::from_le_bytes(length);
            }
            return Ok(length.len());
        }
        let kept = usize::try_from(self.rest).unwrap_or(usize::MAX).min(bytes.len());
        self.to.write_all(&bytes[..kept])?;
        self.rest -= kept as u64;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.to.flush()
    }
}

fn with_end(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(".");
    name.push(SEALED_END);
    PathBuf::from(name)
}
