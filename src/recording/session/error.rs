//! Why a session file could not be written or read: what, where, and what to do, in one line.

use std::{
    io,
    path::{Path, PathBuf},
};

/// Why a session file could not be written. Everything that was written before stays readable.
#[derive(Debug, thiserror::Error)]
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
    #[error("session {path} has no channel {number}: it is a channel of another file")]
    Channel { path: PathBuf, number: u16 },
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
            Self::Channel { .. } | Self::TooMuch { .. } => None,
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

/// Why a session file could not be read.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// It could not be opened or read.
    #[error("cannot read session {path}: {reason}")]
    Open { path: PathBuf, reason: String },
    #[error("session {path} is empty: nothing was recorded in it")]
    Empty { path: PathBuf },
    #[error("session {path} ends within its first bytes: nothing was recorded in it")]
    Cut { path: PathBuf },
    #[error("{path} is not a session: it is not in the format MCAP; is it the right file?")]
    Foreign { path: PathBuf },
    #[error(
        "session {path} is in version {version} of the format MCAP, only version 0 is read; it needs a newer program"
    )]
    Version { path: PathBuf, version: String },
    /// A part of it does not say what it should.
    #[error("session {path} is damaged at byte {at}: {what}")]
    Damaged { path: PathBuf, at: u64, what: String },
}

impl ReadError {
    pub(super) fn open(path: &Path, error: &io::Error) -> Self {
        Self::Open { path: path.to_owned(), reason: error.to_string() }
    }

    pub(super) fn damaged(path: &Path, at: u64, what: &str) -> Self {
        Self::Damaged { path: path.to_owned(), at, what: what.to_owned() }
    }
}
