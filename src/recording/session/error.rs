//! Errors of writing and reading a session file: what failed, where, and what to do, in one line.

use std::{
    io,
    path::{Path, PathBuf},
};

/// Reason why a session file could not be written. Everything written earlier remains readable.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    #[error("cannot create session {path}: {reason}; {cure}")]
    Create { path: PathBuf, reason: String, kind: io::ErrorKind, cure: &'static str },
    #[error("cannot continue writing session {path}: {reason}; {cure} (the part already written stays readable)")]
    Write { path: PathBuf, reason: String, kind: io::ErrorKind, cure: &'static str },
    #[error("session {path} was deleted while it was being written; record to another file")]
    Deleted { path: PathBuf },
    #[error("session {path} has no channel {number}: the channel belongs to another file; use one of this file")]
    Channel { path: PathBuf, number: u16 },
    #[error("session {path} cannot hold {what}: the limit is {max}; record to another file")]
    TooMuch { path: PathBuf, what: &'static str, max: u64 },
}

impl WriteError {
    pub(super) fn create(path: &Path, error: &io::Error) -> Self {
        let cure = match error.kind() {
            io::ErrorKind::AlreadyExists => "choose another name: sessions are never overwritten",
            io::ErrorKind::NotFound | io::ErrorKind::NotADirectory => {
                "create its folder first, or choose another folder"
            }
            _ => cure(error.kind()),
        };
        Self::Create { path: path.to_owned(), reason: error.to_string(), kind: error.kind(), cure }
    }

    pub(super) fn write(path: &Path, error: &io::Error) -> Self {
        Self::Write { path: path.to_owned(), reason: error.to_string(), kind: error.kind(), cure: cure(error.kind()) }
    }

    /// Returns the kind of I/O error, if the system caused this one.
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
        io::ErrorKind::FileTooLarge => "record to a disk that supports larger files",
        _ => "check the disk or record to another one",
    }
}

#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    #[error("cannot read session {path}: {reason}")]
    Open { path: PathBuf, reason: String },
    #[error("session {path} is empty: nothing was recorded; choose another file")]
    Empty { path: PathBuf },
    #[error("session {path} ends within its first bytes: nothing was recorded; choose another file")]
    Cut { path: PathBuf },
    #[error("{path} is not a session: it is not in MCAP format; choose another file")]
    Foreign { path: PathBuf },
    #[error(
        "session {path} uses version {version} of the MCAP format, but only version 0 can be read; use a newer program"
    )]
    Version { path: PathBuf, version: String },
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
