//! The journal of a study: one line of JSON for each event, append-only.
//!
//! A line is valid when it ends with a line break and is on the disk; [`StudyJournal::append`] returns after that. Bytes
//! after the last line break, left by a power failure, were never confirmed: they are dropped and reported, and nothing
//! before them is touched.
//!
//! Each line ends with the hash of itself and of the hash before it, so a line that was changed, removed or inserted is
//! found. The last hash stands for the whole journal: kept elsewhere, it also proves that the end was not replaced.

use std::{
    fs::{File, OpenOptions, TryLockError},
    io::{self, Read as _, Seek as _, SeekFrom, Write as _},
    path::{Path, PathBuf},
};

use crate::{JournalEntry, StudyError, StudyEvent, seal};

/// Maximum journal that is read, bytes.
const MAX: u64 = 256 << 20;
/// Between an entry and its hash.
const CHAIN: &str = ",\"chain\":\"";

#[derive(Debug)]
pub(crate) struct StudyJournal {
    path: PathBuf,
    file: File,
    entries: u64,
    /// Start of the next line.
    end: u64,
    chain: Chain,
}

/// The hash of the last line; empty before the first one. `None` in a study of a version without hashes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Chain(Option<String>);

/// Contents of a journal.
#[derive(Debug)]
pub(crate) struct JournalContents {
    pub(crate) entries: Vec<JournalEntry>,
    /// Bytes after the last line break.
    pub(crate) torn: u64,
    pub(crate) chain: Chain,
    end: u64,
}

/// Reads a journal without changing it.
pub(crate) fn read(path: &Path, chain: Chain) -> Result<JournalContents, StudyError> {
    let bytes = nima_files::read(path, MAX).map_err(StudyError::io(path))?;
    parse(path, &bytes, chain)
}

fn parse(path: &Path, bytes: &[u8], mut chain: Chain) -> Result<JournalContents, StudyError> {
    let end = bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |at| at + 1);
    let mut entries = Vec::new();
    for (line, text) in (1..).zip(bytes[..end].split_inclusive(|byte| *byte == b'\n')) {
        let damaged = |why: String| StudyError::Journal { path: path.to_owned(), line, why };
        let entry: JournalEntry = serde_json::from_slice(text)
            .map_err(|error| damaged(format!("it is not a journal entry ({error}): restore the file from a copy")))?;
        if entry.n != line {
            return Err(damaged(format!("it has number {}: lines are missing or were moved", entry.n)));
        }
        chain = chain.follow(text).ok_or_else(|| {
            damaged(
                "it, or a line before it, was changed after it was written: restore the file from a copy".to_owned(),
            )
        })?;
        entries.push(entry);
    }
    Ok(JournalContents { entries, torn: (bytes.len() - end) as u64, chain, end: end as u64 })
}

impl StudyJournal {
    /// Creates an empty journal.
    pub(crate) fn create(path: &Path) -> Result<Self, StudyError> {
        let file = alone(OpenOptions::new().create_new(true), path)?;
        Ok(Self { path: path.to_owned(), file, entries: 0, end: 0, chain: Chain::BEGIN })
    }

    /// Opens it exclusively. An incomplete last line is cut off and reported by an entry, which the caller finds among
    /// the contents.
    pub(crate) fn open(path: &Path, chain: Chain, at: &str) -> Result<(Self, Vec<JournalEntry>), StudyError> {
        let mut file = alone(&mut OpenOptions::new(), path)?;
        let about = file.metadata().map_err(StudyError::io(path))?;
        if !about.is_file() || about.len() > MAX {
            let why = "it is not a journal: not a regular file, or too large".to_owned();
            return Err(StudyError::Damaged { path: path.to_owned(), why });
        }
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).map_err(StudyError::io(path))?;
        let JournalContents { mut entries, torn, chain, end } = parse(path, &bytes, chain)?;
        let mut journal = Self { path: path.to_owned(), file, entries: entries.len() as u64, end, chain };
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
        let (length, chain) = written.map_err(StudyError::io(&self.path))?;
        self.end += length;
        self.chain = chain;
        self.entries += 1;
        Ok(entry)
    }

    fn write(&mut self, entry: &JournalEntry) -> io::Result<(u64, Chain)> {
        let (line, chain) = self.chain.link(serde_json::to_string(entry)?);
        self.file.seek(SeekFrom::Start(self.end))?;
        self.file.write_all(line.as_bytes())?;
        self.file.sync_data()?;
        Ok((line.len() as u64, chain))
    }

    /// Returns the hash of the last line.
    pub(crate) const fn chain(&self) -> &Chain {
        &self.chain
    }
}

impl Chain {
    pub(crate) const BEGIN: Self = Self(Some(String::new()));
    pub(crate) const NONE: Self = Self(None);

    pub(crate) fn hash(&self) -> Option<&str> {
        self.0.as_deref()
    }

    fn after(before: &str, entry: &str) -> String {
        seal::hash([before, entry].concat().as_bytes())
    }

    /// Returns the line of an entry, and the chain up to it.
    fn link(&self, mut entry: String) -> (String, Self) {
        let Some(before) = &self.0 else { return (entry + "\n", Self::NONE) };
        let hash = Self::after(before, &entry);
        // Insert the chain into the object, before its closing brace.
        entry.pop();
        (format!("{entry}{CHAIN}{hash}\"}}\n"), Self(Some(hash)))
    }

    /// Returns the chain up to this line; `None` if the line does not belong here.
    fn follow(&self, line: &[u8]) -> Option<Self> {
        let Some(before) = &self.0 else { return Some(Self::NONE) };
        let (entry, end) = std::str::from_utf8(line).ok()?.rsplit_once(CHAIN)?;
        let hash = end.strip_suffix("\"}\n")?;
        (Self::after(before, &format!("{entry}}}")) == hash).then(|| Self(Some(hash.to_owned())))
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
