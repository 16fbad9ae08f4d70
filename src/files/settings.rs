//! Settings in TOML, read into a type of its own, with the place of a mistake.

use std::{fmt, ops::Range};

use serde::{Deserialize as _, de::DeserializeOwned};
use toml::{
    Spanned,
    de::{DeTable, DeValue, Deserializer, Error},
};

/// Why a text is not what it should be: what, and where in it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Misfit {
    message: String,
    span: Option<Range<usize>>,
}

impl Misfit {
    /// What is wrong, in one line.
    #[must_use]
    pub fn message(&self) -> &str {
        &self.message
    }

    /// Which line of `text`, which was read, it is about, from 1.
    #[must_use]
    pub fn line(&self, text: &str) -> usize {
        let start = self.span.as_ref().map_or(0, |span| span.start.min(text.len()));
        text.bytes().take(start).filter(|byte| *byte == b'\n').count() + 1
    }

    /// What is wrong, and where in the text.
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

/// Reads a text of settings.
///
/// # Errors
/// [`Misfit`]: the text is no TOML, or has an unknown, missing or wrong value.
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

/// Reads a parsed text, of which something may have been changed.
///
/// # Errors
/// [`Misfit`], as [`from_toml`].
pub fn from_table<T: DeserializeOwned>(table: &Spanned<DeTable<'_>>) -> Result<T, Misfit> {
    let read = T::deserialize(Deserializer::from(table.clone()))?;
    // Of an array that is longer than its type, `toml` reads the beginning. Its plain values refuse it, but have no place in the text,
    // and no numbers beyond `i64`.
    if let Ok(plain) = toml::Table::deserialize(Deserializer::from(table.clone())) {
        T::deserialize(plain).map_err(|error| {
            let text = error.to_string();
            let key = text.lines().find_map(|line| line.strip_prefix("in `")?.strip_suffix('`'));
            Misfit::new(error.message(), key.and_then(|key| place(table.get_ref(), key)))
        })?;
    }
    Ok(read)
}

/// Place of the value with this key, whose parts are joined by dots.
fn place(table: &DeTable<'_>, key: &str) -> Option<Range<usize>> {
    table.iter().find_map(|(first, value)| {
        let rest = key.strip_prefix(first.get_ref().as_ref())?;
        let Some(rest) = rest.strip_prefix('.') else { return rest.is_empty().then(|| value.span()) };
        let inside = if let DeValue::Table(table) = value.get_ref() { place(table, rest) } else { None };
        // The names of choices are left out of the key.
        inside.or_else(|| Some(value.span()))
    })
}

#[cfg(test)]
#[path = "settings_tests.rs"]
mod tests;
