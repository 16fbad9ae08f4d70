//! How files of settings are read: by name, with the line of what is wrong, and with checks of ranges.

use std::{
    ops::Range,
    path::{Path, PathBuf},
};

use nalgebra::Vector3;
use nima_devices::Trouble;
use nima_files::{PASSAGE, shortened};
use serde::Deserialize;
use toml::de::DeTable;

use crate::rig::Misread;

/// A file that could not be used: what, where, what to do.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say it")]
pub enum ConfigError {
    /// The name is neither an embedded one nor a file.
    #[error("there is no {kind} \"{name}\": give one of {known} or the path of a TOML file")]
    Unknown {
        /// `rig` or `scene`.
        kind: &'static str,
        name: String,
        known: String,
    },
    /// The file could not be read.
    #[error("cannot read {kind} file {path}")]
    Read {
        /// `rig` or `scene`.
        kind: &'static str,
        path: PathBuf,
        source: std::io::Error,
    },
    /// The file is not valid TOML for its kind.
    #[error("{kind} file {path}: {message}")]
    Parse {
        /// `rig` or `scene`.
        kind: &'static str,
        /// Its path or embedded name.
        path: PathBuf,
        /// Line, column and key.
        message: String,
    },
    /// A device of the rig has a setting that it cannot have.
    #[error("rig \"{name}\"")]
    Device { name: String, source: Trouble },
    /// A value is outside its range.
    #[error("{kind} \"{name}\": {key} is {value}, must be {range}")]
    Range {
        /// `rig` or `scene`.
        kind: &'static str,
        name: String,
        key: &'static str,
        value: f64,
        range: &'static str,
    },
}

/// The text of a file or an embedded name, and where it came from.
///
/// # Errors
/// [`ConfigError::Unknown`], [`ConfigError::Read`].
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

/// Reads one file of settings.
///
/// # Errors
/// [`ConfigError::Parse`] with its line.
pub fn parse<T: for<'de> Deserialize<'de>>(kind: &'static str, path: &Path, text: &str) -> Result<T, ConfigError> {
    parse_with(kind, path, text, |_| Ok(()))
}

/// The same of a file whose tables are brought into another form first; each value keeps its place.
pub(crate) fn parse_with<T: for<'de> Deserialize<'de>>(
    kind: &'static str,
    path: &Path,
    text: &str,
    transform: impl FnOnce(&mut DeTable<'_>) -> Result<(), Misread>,
) -> Result<T, ConfigError> {
    let refused = |message: String| ConfigError::Parse { kind, path: path.to_owned(), message };
    let at = |place: Option<Range<usize>>, message: &str| {
        let line = place.map_or(1, |span| text[..span.start.min(text.len())].matches('\n').count() + 1);
        let words = message.lines().collect::<Vec<_>>().join(" ");
        refused(format!("line {line}: {}", shortened(&words, PASSAGE)))
    };
    let wrong = |error: toml::de::Error| at(error.span(), error.message());
    let mut root = DeTable::parse(text).map_err(wrong)?;
    transform(root.get_mut()).map_err(|(place, message)| at(Some(place), &message))?;
    let parsed = T::deserialize(toml::Deserializer::from(root)).map_err(wrong)?;
    match crate::texts::fault(&toml::from_str(text).map_err(wrong)?) {
        None => Ok(parsed),
        Some(fault) => Err(refused(fault)),
    }
}

/// Collects range checks so that each reads as one line.
pub struct Ranges<'a> {
    /// `rig` or `scene`.
    pub kind: &'static str,
    /// The file, as the user named it.
    pub name: &'a str,
}

impl Ranges<'_> {
    /// Refuses a value that is not good, by its key.
    pub fn check(&self, key: &'static str, value: f64, good: bool, range: &'static str) -> Result<(), ConfigError> {
        if good && value.is_finite() {
            return Ok(());
        }
        Err(ConfigError::Range { kind: self.kind, name: self.name.to_owned(), key, value, range })
    }

    /// Every entry on its own: a sum would hide infinities that cancel.
    pub fn finite(&self, key: &'static str, vector: &Vector3<f64>) -> Result<(), ConfigError> {
        vector.iter().try_for_each(|entry| self.check(key, *entry, true, "finite numbers"))
    }

    /// A number above 0.
    pub fn positive(&self, key: &'static str, value: f64) -> Result<(), ConfigError> {
        self.check(key, value, value > 0.0, "a number above 0")
    }

    /// 0 or above.
    pub fn not_negative(&self, key: &'static str, value: f64) -> Result<(), ConfigError> {
        self.check(key, value, value >= 0.0, "0 or above")
    }
}
