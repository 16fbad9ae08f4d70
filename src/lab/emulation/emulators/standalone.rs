//! Settings of an emulator that runs alone (`nima emulate`): without a rig, fed by a simple substitute for the world.

use std::{
    io::{Error, ErrorKind, Result},
    str::FromStr,
};

/// Settings `KEY=VALUE`; devices ignore keys that they do not have.
#[derive(Debug, Default)]
pub struct EmulatorSettings(Vec<(String, String)>);

impl EmulatorSettings {
    /// Parses texts `KEY=VALUE`.
    ///
    /// # Errors
    /// If a text has another form.
    pub fn new(texts: &[String]) -> Result<Self> {
        let pair = |text: &String| match text.split_once('=') {
            Some((key, value)) => Ok((key.to_owned(), value.to_owned())),
            None => Err(Error::new(ErrorKind::InvalidInput, format!("--set {text} is not KEY=VALUE"))),
        };
        texts.iter().map(pair).collect::<Result<_>>().map(Self)
    }

    /// Returns the value of `key`, if given; a value that cannot be parsed is an error.
    pub(super) fn get<T: FromStr>(&self, key: &str) -> Result<Option<T>> {
        let Some((_, value)) = self.0.iter().find(|(known, _)| known == key) else { return Ok(None) };
        value.parse().map(Some).map_err(|_| unusable(key, value, "this value cannot be used"))
    }

    /// Returns the value of `key`, or the default.
    pub(super) fn get_or<T: FromStr>(&self, key: &str, usual: T) -> Result<T> {
        Ok(self.get(key)?.unwrap_or(usual))
    }

    /// Returns one of two models by name; the first by default.
    #[cfg(target_os = "linux")]
    pub(super) fn model<T: Default>(&self, names: [(&str, T); 2]) -> Result<T> {
        let Some(name) = self.get::<String>("model")? else { return Ok(T::default()) };
        let known = names.each_ref().map(|(known, _)| *known).join(" or ");
        let model = names.into_iter().find(|(known, _)| *known == name);
        model.map(|(_, model)| model).ok_or_else(|| unusable("model", &name, &format!("use {known}")))
    }
}

pub(super) fn unusable(key: &str, value: impl std::fmt::Display, why: &str) -> Error {
    Error::new(ErrorKind::InvalidInput, format!("--set {key}={value}: {why}"))
}
