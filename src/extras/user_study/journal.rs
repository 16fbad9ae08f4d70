//! The journal of a study: one line of JSON for each event, append-only.
//!
//! A line is valid when it ends with a line break and is on the disk; [`StudyJournal::append`] returns after that. Bytes
//! after the last line break, left by a power failure, were never confirmed: they are dropped and reported, and nothing
//! before them is touched.

use std::{
    fs::{File, OpenOptions, TryLockError},
    io::{self, Read as _, Seek as _, SeekFrom, Write as _},
    path::{Path, PathBuf},
};

use crate::{JournalEntry, StudyError, StudyEvent};

/// Maximum journal that is read, bytes.
const MAX: u64 = 256 << 20;

#[derive(Debug)]
pub(crate) struct StudyJournal {
    path: PathBuf,
    file: File,
    entries: u64,
    /// Start of the next line.
    end: u64,
}

/// Contents of a journal.
#[derive(Debug)]
pub(crate) struct JournalContents {
    pub(crate) entries: Vec<JournalEntry>,
    /// Bytes after the last line break.
    pub(crate) torn: u64,
    end: u64,
}

/// Reads a journal without changing it.
pub(crate) fn read(path: &Path) -> Result<JournalContents, StudyError> {
    let bytes = nima_files::read(path, MAX).map_err(StudyError::io(path))?;
    parse(path, &bytes)
}

fn parse(path: &Path, bytes: &[u8]) -> Result<JournalContents, StudyError> {
    let end = bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |at| at + 1);
    let mut entries = Vec::new();
    for (line, text) in (1..).zip(bytes[..end].split_inclusive(|byte| *byte == b'\n')) {
        let damaged = |why: String| StudyError::Journal { path: path.to_owned(), line, why };
        let entry: JournalEntry = serde_json::from_slice(text)
            .map_err(|error| damaged(format!("it is not a journal entry ({error}): restore the file from a copy")))?;
        if entry.n != line {
            return Err(damaged(format!("it has number {}: lines are missing or were moved", entry.n)));
        }
        entries.push(entry);
    }
    Ok(JournalContents { entries, torn: (bytes.len() - end) as u64, end: end as u64 })
}

impl StudyJournal {
    /// Creates an empty journal.
    pub(crate) fn create(path: &Path) -> Result<Self, StudyError> {
        let file = alone(OpenOptions::new().create_new(true), path)?;
        Ok(Self { path: path.to_owned(), file, entries: 0, end: 0 })
    }

    /// Opens it exclusively. An incomplete last line is cut off and reported by an entry, which the caller finds among
    /// the contents.
    pub(crate) fn open(path: &Path, at: &str) -> Result<(Self, Vec<JournalEntry>), StudyError> {
        let mut file = alone(&mut OpenOptions::new(), path)?;
        let about = file.metadata().map_err(StudyError::io(path))?;
        if !about.is_file() || about.len() > MAX {
            let why = "it is not a journal: not a regular file, or too large".to_owned();
            return Err(StudyError::Damaged { path: path.to_owned(), why });
        }
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).map_err(StudyError::io(path))?;
        let JournalContents { mut entries, torn, end } = parse(path, &bytes)?;
        let mut journal = Self { path: path.to_owned(), file, entries: entries.len() as u64, end };
        if torn > 0 {
            journal.file.set_len(end).map_err(StudyError::io(path))?;
            entries.push(journal.append(at, StudyEvent::TornLineDropped { bytes: torn })?);
        }
        Ok((journal, entries))
    }

    /// Appends a line; it is on the disk when this returns.
    pub(crate) fn append(&mut self, at: &str, event: StudyEvent) -> Result<JournalEntry, StudyError> {
        let entry = JournalEntry { n: self.entries + 1, at: at.to_owned(), event };
        let written = self.write(&entry);
        if written.is_err() {
            // Otherwise the next line would follow an incomplete one.
            self.file.set_len(self.end).ok();
        }
        self.end += written.map_err(StudyError::io(&self.path))?;
        self.entries += 1;
        Ok(entry)
    }

    fn write(&mut self, entry: &JournalEntry) -> io::Result<u64> {
        let mut line = serde_json::to_vec(entry)?;
        line.push(b'\n');
        self.file.seek(SeekFrom::Start(self.end))?;
        self.file.write_all(&line)?;
        self.file.sync_data()?;
        Ok(line.len() as u64)
    }
}

/// Opens it for writing by this program only; others may read it.
fn alone(options: &mut OpenOptions, path: &Path) -> Result<File, StudyError> {
    let in_use = || StudyError::InUse { folder: path.parent().unwrap_or_else(|| Path::new(".")).to_owned() };
    match lock(options.read(true).write(true), path) {
        Ok(file) => Ok(file),
        Err(TryLockError::WouldBlock) => Err(in_use()),
        Err(TryLockError::Error(source)) => Err(StudyError::Io { path: path.to_owned(), source }),
    }
}

#[cfg(not(windows))]
fn lock(options: &OpenOptions, path: &Path) -> Result<File, TryLockError> {
    let file = options.open(path).map_err(TryLockError::Error)?;
    file.try_lock().map(|()| file)
}

/// Prevents other programs from opening the journal for writing. A lock would also keep them from reading it.
#[cfg(windows)]
fn lock(options: &mut OpenOptions, path: &Path) -> Result<File, TryLockError> {
    // Constants of the Windows API.
    const SHARE_READ: u32 = 1;
    const SHARING_VIOLATION: i32 = 32;
    let opened = std::os::windows::fs::OpenOptionsExt::share_mode(options, SHARE_READ).open(path);
    opened.map_err(|error| match error.raw_os_error() {
        Some(SHARING_VIOLATION) => TryLockError::WouldBlock,
        _ => TryLockError::Error(error),
    })
}
