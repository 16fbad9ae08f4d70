//! What every kept calibration tells of itself.

use serde::{Deserialize, Serialize, de::DeserializeOwned};

use super::Verdict;

/// What a calibration belongs to and where it comes from: the first lines of its file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct RecordHead {
    /// Serial number of the wrist sensor.
    pub sensor: String,
    /// Name of the tool on it.
    pub tool: String,
    /// When it was made, UTC, ISO 8601 (`2026-08-21T10:20:30Z`).
    pub date: String,
    /// Version of the program that made it.
    pub software: String,
}

impl RecordHead {
    /// Made by this version of the program. `date` in ISO 8601, UTC.
    pub fn new(sensor: &str, tool: &str, date: &str) -> Self {
        let software = env!("CARGO_PKG_VERSION").to_owned();
        Self { sensor: sensor.to_owned(), tool: tool.to_owned(), date: date.to_owned(), software }
    }
}

/// Whether something may be used, and who decided otherwise.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Judgement {
    /// Its verdict.
    pub verdict: Verdict,
    /// Why, in one sentence.
    pub reason: String,
    /// Who chose to keep it in spite of its verdict.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub override_by: Option<String>,
    /// And why.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub override_reason: Option<String>,
}

impl Judgement {
    /// As it was found; nobody has overridden it.
    pub fn new(verdict: Verdict, reason: impl Into<String>) -> Self {
        Self { verdict, reason: reason.into(), override_by: None, override_reason: None }
    }

    /// It may be used: accepted, or kept under somebody's name.
    pub fn allows(&self) -> bool {
        self.verdict == Verdict::Accepted || self.override_by.as_deref().is_some_and(|name| !name.trim().is_empty())
    }

    /// Keeps it under this person's name.
    pub fn override_by(&mut self, name: &str, reason: Option<&str>) {
        self.override_by = Some(name.trim().to_owned());
        self.override_reason = reason.map(|reason| reason.trim().to_owned());
    }
}

/// What a calibration file holds. A record has a field `kind` with the text of [`KIND`](Self::KIND), and denies unknown keys.
pub trait Record: Serialize + DeserializeOwned {
    /// Its kind: in the file, and the beginning of the file's name.
    const KIND: &'static str;
    /// What it belongs to.
    fn head(&self) -> &RecordHead;
    /// Whether it may be used.
    fn judgement(&self) -> &Judgement;
    /// What makes its numbers unusable, if anything.
    fn fault(&self) -> Option<&'static str> {
        None
    }
}
