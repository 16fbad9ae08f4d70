use std::{io, path::PathBuf};

use nima_session::{copied::CopyError, watched::WatchError};

/// What can go wrong.
#[derive(Debug, thiserror::Error)]
pub enum DepartmentError {
    /// A name that cannot be used.
    #[error("\"{0}\" cannot be a name here: use letters, digits and - only, 1 to 40 of them")]
    Name(String),
    /// There is no such file.
    #[error("{path}: there is none; {cure}")]
    Missing {
        /// The file.
        path: PathBuf,
        /// What to do.
        cure: &'static str,
    },
    /// There is one already.
    #[error("{0} exists already; delete it first if it is not needed any more")]
    Exists(PathBuf),
    /// A file cannot be read or written.
    #[error("{path}: {source}")]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// A file is not what it should be.
    #[error("{path} is no certificate of a department: {why}")]
    NotOne {
        /// The file.
        path: PathBuf,
        /// Why.
        why: String,
    },
    /// A certificate cannot be made.
    #[error("cannot make a certificate: {0}")]
    Certificate(String),
    /// This machine has the wrong part.
    #[error("this machine joined as a {is}; what it is to do needs a {needed}: join with another certificate")]
    Role {
        /// What it is.
        is: &'static str,
        /// What it should be.
        needed: &'static str,
    },
    /// The rig cannot be shared.
    #[error("cannot share at {address}: {why}; end the program that uses this port, or name another one with --share")]
    Listen {
        /// The address.
        address: String,
        /// Why.
        why: String,
    },
    /// The rig does not answer.
    #[error(
        "no rig answers at {address}: {why}; is it shared (--share), and are both machines of the same department?"
    )]
    Connect {
        /// The address.
        address: String,
        /// Why.
        why: String,
    },
    /// It answers no longer.
    #[error("rig {rig} does not answer: {why}")]
    Silent {
        /// Its name.
        rig: String,
        /// Why.
        why: String,
    },
    /// The rig records nothing now.
    #[error("rig {0} runs no loop now")]
    NoSession(String),
    /// What it sent cannot be shown.
    #[error(transparent)]
    Watch(#[from] WatchError),
    /// What it sent cannot be written.
    #[error(transparent)]
    Copy(#[from] CopyError),
}

impl DepartmentError {
    /// For errors of this file.
    pub(crate) fn of_file(path: &std::path::Path) -> impl FnOnce(io::Error) -> Self {
        let path = path.to_owned();
        move |source| Self::File { path, source }
    }
}
