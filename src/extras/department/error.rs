use std::{io, path::PathBuf};

use nima_session::{monitor_stream::WatchError, remote_copy::CopyError};

/// Errors of a department.
#[derive(Debug, thiserror::Error)]
pub enum DepartmentError {
    /// A name that cannot be used.
    #[error("\"{0}\" cannot be used as a name; use 1 to 40 letters, digits and -")]
    Name(String),
    #[error("{path} does not exist; {cure}")]
    Missing {
        path: PathBuf,
        /// Remedy.
        cure: &'static str,
    },
    /// The file exists already.
    #[error("{0} already exists; delete it first if it is no longer needed")]
    Exists(PathBuf),
    #[error("{path}: {source}")]
    File { path: PathBuf, source: io::Error },
    #[error("{path} is not a certificate of a department: {why}; use the file issued by nima department")]
    NotOne { path: PathBuf, why: String },
    #[error("cannot create a certificate: {0}")]
    Certificate(String),
    /// This machine has the wrong role.
    #[error("this machine joined as a {is}, but a {needed} is required; join with another certificate")]
    Role {
        /// Role.
        is: &'static str,
        /// The required role.
        needed: &'static str,
    },
    /// The rig cannot be shared.
    #[error(
        "cannot share on {address}: {why}; end the program that uses this port, or choose another one with --share"
    )]
    Listen { address: String, why: String },
    /// The rig does not answer.
    #[error(
        "no rig answers at {address}: {why}; share it (--share), and check that both machines belong to the same department"
    )]
    Connect { address: String, why: String },
    /// The rig has stopped answering.
    #[error("rig {rig} does not answer: {why}; check that its console is running")]
    Silent { rig: String, why: String },
    /// The rig is not recording now.
    #[error("rig {0} is not running a loop now; start it there")]
    NoSession(String),
    /// The rig's data cannot be shown.
    #[error(transparent)]
    Watch(#[from] WatchError),
    /// The rig's data cannot be written.
    #[error(transparent)]
    Copy(#[from] CopyError),
}

impl DepartmentError {
    /// Returns a function that converts errors of this file.
    pub(crate) fn of_file(path: &std::path::Path) -> impl FnOnce(io::Error) -> Self {
        let path = path.to_owned();
        move |source| Self::File { path, source }
    }
}
