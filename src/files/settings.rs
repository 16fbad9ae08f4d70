//! Parses settings in TOML into a typed value and reports the position of a mistake.

use std::{fmt, ops::Range};

use serde::{Deserialize as _, de::DeserializeOwned};
use toml::{
    Spanned,
    de::{DeTable, DeValue, Deserializer, Error},
};

/// Reason why settings could not be parsed: the mistake and its position.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Misfit {
    message: String,
    span: Option<Range<usize>>,
}

impl Misfit {
    #[must_use]
    pub fn message(&self) -> &str {
        &self.message
    }

    /// Returns the line, from 1, of the mistake in `text`, which must be the text that was parsed.
    #[must_use]
    pub fn line(&self, text: &str) -> usize {
        let start = self.span.as_ref().map_or(0, |span| span.start.min(text.len()));
        text.bytes().take(start).filter(|byte| *byte == b'\n').count() + 1
    }

    #[must_use]
    pub fn new(message: impl fmt::Display, span: Option<Range<usize>>) -> Self {
        Self { message: message.to_string().lines().collect::<Vec<_>>().join(" "), span }
    }
}

impl fmt::Display for Misfit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Misfit {}

impl From<Error> for Misfit {
    fn from(error: Error) -> Self {
        Self::new(error.message(), error.span())
    }
}

/// Parses settings.
///
/// # Errors
/// [`Misfit`] if the text is not TOML, or has an unknown, missing or wrong value.
///
/// ```
/// #[derive(serde::Deserialize)]
/// struct Hand {
///     stiffness_n_m: f64,
/// }
///
/// let hand: Hand = nima_files::from_toml("stiffness_n_m = 300").expect("whole");
/// assert_eq!(hand.stiffness_n_m, 300.0);
/// let text = "\nstiffness_n_m = \"much\"";
/// let wrong = nima_files::from_toml::<Hand>(text).err().expect("no number");
/// assert_eq!((wrong.line(text), wrong.message()), (2, "invalid type: string \"much\", expected f64"));
/// ```
pub fn from_toml<T: DeserializeOwned>(text: &str) -> Result<T, Misfit> {
    from_table(&DeTable::parse(text)?)
}

/// Parses settings from a table that may have been changed after parsing.
///
/// # Errors
/// [`Misfit`], as [`from_toml`].
pub fn from_table<T: DeserializeOwned>(table: &Spanned<DeTable<'_>>) -> Result<T, Misfit> {
    let read = T::deserialize(Deserializer::from(table.clone()))?;
    // `toml` reads only the beginning of an array that is longer than its type. Its plain values refuse such an array,
    // but have no positions and no numbers beyond `i64`, so this is a second check.
    if let Ok(plain) = toml::Table::deserialize(Deserializer::from(table.clone())) {
        T::deserialize(plain).map_err(|error| {
            let text = error.to_string();
            let key = text.lines().find_map(|line| line.strip_prefix("in `")?.strip_suffix('`'));
            Misfit::new(error.message(), key.and_then(|key| place(table.get_ref(), key)))
        })?;
    }
    Ok(read)
}

/// Returns the position of the value with this key, whose parts are joined by dots.
fn place(table: &DeTable<'_>, key: &str) -> Option<Range<usize>> {
    table.iter().find_map(|(first, value)| {
        let rest = key.strip_prefix(first.get_ref().as_ref())?;
        let Some(rest) = rest.strip_prefix('.') else { return rest.is_empty().then(|| value.span()) };
        let inside = if let DeValue::Table(table) = value.get_ref() { place(table, rest) } else { None };
        // Keys omit the names of enum variants.
        inside.or_else(|| Some(value.span()))
    })
}

#[cfg(test)]
#[path = "settings_tests.rs"]
mod tests;
