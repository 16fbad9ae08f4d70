//! Why a session file could not be written or read: what, where, and what to do, in one line.

use std::{
    io,
    path::{Path, PathBuf},
};

/// Why a session file could not be written. Everything that was written before stays readable.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say it")]
pub enum WriteError {
    /// The file could not be created.
    #[error("cannot create session {path}: {reason}; {cure}")]
    Create { path: PathBuf, reason: String, kind: io::ErrorKind, cure: &'static str },
    /// A chunk or its index could not be written.
    #[error("cannot go on writing session {path}: {reason}; {cure}; what was written before stays readable")]
    Write { path: PathBuf, reason: String, kind: io::ErrorKind, cure: &'static str },
    /// Somebody deleted the file, or its folder.
    #[error("session {path} has been deleted while it was written; record to another file")]
    Deleted { path: PathBuf },
    /// More than the format can hold.
    #[error("session {path} cannot take this: {what}, at most {most} are possible")]
    TooMuch { path: PathBuf, what: &'static str, most: u64 },
}

impl WriteError {
    pub(super) fn create(path: &Path, error: &io::Error) -> Self {
        let cure = match error.kind() {
            io::ErrorKind::AlreadyExists => "choose another name, a session is never overwritten",
            io::ErrorKind::NotFound | io::ErrorKind::NotADirectory => "make its folder first or choose another one",
            _ => cure(error.kind()),
        };
        Self::Create { path: path.to_owned(), reason: error.to_string(), kind: error.kind(), cure }
    }

    pub(super) fn write(path: &Path, error: &io::Error) -> Self {
        Self::Write { path: path.to_owned(), reason: error.to_string(), kind: error.kind(), cure: cure(error.kind()) }
    }

    /// What the system said, where it was the system.
    pub fn kind(&self) -> Option<io::ErrorKind> {
        match self {
            Self::Create { kind, .. } | Self::Write { kind, .. } => Some(*kind),
            Self::Deleted { .. } => Some(io::ErrorKind::NotFound),
            Self::TooMuch { .. } => None,
        }
    }
}

fn cure(kind: io::ErrorKind) -> &'static str {
    match kind {
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => "free some space or record to another disk",
        io::ErrorKind::ReadOnlyFilesystem | io::ErrorKind::PermissionDenied => "choose a folder that you may write to",
        io::ErrorKind::FileTooLarge => "record to a disk that takes larger files",
        _ => "check the disk or record to another one",
    }
}
