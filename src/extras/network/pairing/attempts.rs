//! Counts the wrong codes of a machine, also of programs that have ended.

use std::{
    path::{Path, PathBuf},
    time::{Duration, SystemTime, UNIX_EPOCH},
};

use super::PairingError;
use crate::keys::{self, KeyError};

/// Number of wrong codes before a pause, and its length.
pub const WRONG_MAX: usize = 3;
/// See [`WRONG_MAX`].
pub const PAUSE: Duration = Duration::from_mins(1);
/// Name of the file in the folder of the keys: one line for each wrong code, with its time, s since 1970.
const FILE: &str = "network.wrong";

/// The wrong codes that were entered at this machine.
#[derive(Debug)]
pub struct Attempts {
    path: PathBuf,
    wrong_s: Vec<u64>,
}

impl Attempts {
    /// Reads the wrong codes in this folder, which also contains the keys.
    ///
    /// # Errors
    /// [`KeyError`] with the file. A file that cannot be read does not count as empty.
    pub fn open(folder: &Path) -> Result<Self, KeyError> {
        let path = folder.join(FILE);
        let text = keys::read(&path)?.unwrap_or_default();
        let malformed = |line| KeyError::Content { path: path.clone(), line, what: "not a time; delete the file" };
        let times = (1..).zip(text.lines()).map(|(line, text)| text.parse().map_err(|_| malformed(line)));
        let wrong_s = times.collect::<Result<_, _>>()?;
        Ok(Self { path, wrong_s })
    }

    /// Checks whether another pairing may begin.
    ///
    /// # Errors
    /// [`PairingError::TooMany`] with the time to wait.
    pub fn may_begin(&mut self) -> Result<(), PairingError> {
        self.may_begin_at(now_s())
    }

    pub(super) fn may_begin_at(&mut self, now_s: u64) -> Result<(), PairingError> {
        let pause_s = PAUSE.as_secs();
        // A clock that was set back must not make the pause longer.
        self.wrong_s.retain(|&at_s| now_s.abs_diff(at_s) < pause_s);
        match self.wrong_s.iter().min() {
            Some(&first_s) if self.wrong_s.len() >= WRONG_MAX => {
                let wait_s = (first_s + pause_s).saturating_sub(now_s).min(pause_s);
                Err(PairingError::TooMany { wait_s: wait_s as f64 })
            }
            _ => Ok(()),
        }
    }

    /// Counts a wrong code; it is in the file when this returns.
    ///
    /// # Errors
    /// [`KeyError`] with the file.
    pub fn count(&mut self) -> Result<(), KeyError> {
        self.wrong_s.push(now_s());
        keys::replace(&self.path, self.wrong_s.iter().map(u64::to_string))
    }
}

fn now_s() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs())
}
