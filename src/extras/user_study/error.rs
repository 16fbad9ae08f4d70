//! Why an operation on a study is impossible.

use std::{io, path::PathBuf};

use crate::file::Mistakes;

/// Cause, position and remedy.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    #[error(transparent)]
    Mistakes(#[from] Mistakes),
    #[error("{} already exists: choose a new folder for the study", .folder.display())]
    Exists { folder: PathBuf },
    #[error("{}: {source}", .path.display())]
    Io { path: PathBuf, source: io::Error },
    #[error("{}: {why}", .path.display())]
    Damaged { path: PathBuf, why: String },
    #[error("{}: line {line}: {why}", .path.display())]
    Journal { path: PathBuf, line: u64, why: String },
    #[error("the study in {} is open in another program; close it there first", .folder.display())]
    InUse { folder: PathBuf },
    #[error("the study was opened for reading only; open it for writing")]
    ReadOnly,
    #[error("there is no participant \"{name}\"; choose one of {known}")]
    Participant { name: String, known: String },
    #[error("{participant}: {asked} is not the next step; do {next} first")]
    NotNow { participant: String, asked: String, next: String },
    #[error("{participant}: {why}")]
    Answers { participant: String, why: String },
    #[error("{0}")]
    Refused(String),
}

impl StudyError {
    pub(crate) fn io(path: impl Into<PathBuf>) -> impl FnOnce(io::Error) -> Self {
        let path = path.into();
        move |source| Self::Io { path, source }
    }
}
