//! Reading of settings files: by name, with the line of an error, and with range checks.

use std::{
    borrow::Cow,
    path::{Path, PathBuf},
};

use nalgebra::Vector3;
use nima_core::limits::Limits;
use nima_devices::DeviceError;
use nima_files::{Misfit, PASSAGE, from_table, shortened};
use serde::de::DeserializeOwned;
use toml::de::DeTable;

use crate::rig::Misread;

#[derive(Debug, thiserror::Error)]
pub enum ConfigError {
    #[error("unknown {kind} \"{name}\": use one of {known} or the path of a TOML file")]
    Unknown {
        /// `rig` or `scene`.
        kind: &'static str,
        name: String,
        known: String,
    },
    #[error("cannot read {kind} file {path}")]
    Read {
        /// `rig` or `scene`.
        kind: &'static str,
        path: PathBuf,
        source: std::io::Error,
    },
    #[error("{kind} file {path}: {message}")]
    Parse {
        /// `rig` or `scene`.
        kind: &'static str,
        /// Path or embedded name.
        path: PathBuf,
        /// Line, column and key.
        message: String,
    },
    #[error("rig \"{name}\"")]
    Device { name: String, source: DeviceError },
    #[error("{kind} \"{name}\": {key} is {value}, but it must be {range}")]
    Range {
        /// `rig` or `scene`.
        kind: &'static str,
        name: String,
        key: &'static str,
        value: f64,
        range: Cow<'static, str>,
    },
}

/// Returns the text of a file or of an embedded file with this name, and its path.
///
/// # Errors
/// [`ConfigError::Unknown`] if neither exists; [`ConfigError::Read`] if the file cannot be read.
pub fn text(kind: &'static str, name: &str, embedded: &[(&str, &str)]) -> Result<(PathBuf, String), ConfigError> {
    if let Some((known, text)) = embedded.iter().find(|(known, _)| *known == name) {
        return Ok((PathBuf::from(known), (*text).to_owned()));
    }
    let path = Path::new(name);
    if !path.exists() {
        let known = embedded.iter().map(|(known, _)| *known).collect::<Vec<_>>().join(", ");
        return Err(ConfigError::Unknown { kind, name: name.to_owned(), known });
    }
    match nima_files::read_text(path, nima_files::CONFIG_MAX) {
        Ok(text) => Ok((path.to_owned(), text)),
        Err(source) => Err(ConfigError::Read { kind, path: path.to_owned(), source }),
    }
}

/// Parses one settings file.
///
/// # Errors
/// [`ConfigError::Parse`] with the line of the error.
///
/// ```
/// use std::path::Path;
///
/// use nima_machine::config::{RigConfig, parse};
///
/// let error = parse::<RigConfig>("rig", Path::new("mine.toml"), "rate = 1000").expect_err("no such key");
/// assert!(error.to_string().contains("mine.toml") && error.to_string().contains("rate"), "{error}");
/// ```
pub fn parse<T: DeserializeOwned>(kind: &'static str, path: &Path, text: &str) -> Result<T, ConfigError> {
    parse_with(kind, path, text, |_| Ok(()))
}

/// Parses a file whose tables are transformed first; every value keeps its position in the text.
pub(crate) fn parse_with<T: DeserializeOwned>(
    kind: &'static str,
    path: &Path,
    text: &str,
    transform: impl FnOnce(&mut DeTable<'_>) -> Result<(), Misread>,
) -> Result<T, ConfigError> {
    let refused = |message: String| ConfigError::Parse { kind, path: path.to_owned(), message };
    let wrong =
        |misfit: Misfit| refused(format!("line {}: {}", misfit.line(text), shortened(misfit.message(), PASSAGE)));
    let mut root = DeTable::parse(text).map_err(|error| wrong(error.into()))?;
    let fault = crate::texts::fault(root.get_ref());
    transform(root.get_mut()).map_err(|(place, message)| wrong(Misfit::new(message, Some(place))))?;
    let parsed = from_table(&root).map_err(wrong)?;
    match fault {
        None => Ok(parsed),
        Some(fault) => Err(refused(fault)),
    }
}

/// Range checks with a message of one line each.
pub struct Ranges<'a> {
    /// `rig` or `scene`.
    pub kind: &'static str,
    /// The file, as named by the user.
    pub name: &'a str,
}

impl Ranges<'_> {
    /// Refuses the value of `key` unless `good`.
    ///
    /// # Errors
    /// [`ConfigError::Range`].
    pub fn check(
        &self,
        key: &'static str,
        value: f64,
        good: bool,
        range: impl Into<Cow<'static, str>>,
    ) -> Result<(), ConfigError> {
        if good && value.is_finite() {
            return Ok(());
        }
        Err(ConfigError::Range { kind: self.kind, name: self.name.to_owned(), key, value, range: range.into() })
    }

    /// Refuses a value outside these limits.
    ///
    /// # Errors
    /// [`ConfigError::Range`].
    pub fn within(&self, key: &'static str, value: f64, limits: &Limits) -> Result<(), ConfigError> {
        self.check(key, value, limits.contains(value), limits.to_string())
    }

    /// Refuses a vector that is not finite. Each entry is checked separately, because infinities can cancel in a sum.
    ///
    /// # Errors
    /// [`ConfigError::Range`].
    pub fn finite(&self, key: &'static str, vector: &Vector3<f64>) -> Result<(), ConfigError> {
        vector.iter().try_for_each(|entry| self.check(key, *entry, true, "finite numbers"))
    }

    /// Refuses a value that is not above 0.
    ///
    /// # Errors
    /// [`ConfigError::Range`].
    pub fn positive(&self, key: &'static str, value: f64) -> Result<(), ConfigError> {
        self.check(key, value, value > 0.0, "a number above 0")
    }

    /// Refuses a value below 0.
    ///
    /// # Errors
    /// [`ConfigError::Range`].
    pub fn not_negative(&self, key: &'static str, value: f64) -> Result<(), ConfigError> {
        self.check(key, value, value >= 0.0, "0 or above")
    }
}
