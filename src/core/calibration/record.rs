//! Data that every stored calibration contains.

use serde::{Deserialize, Serialize, de::DeserializeOwned};

use super::Verdict;

/// Sensor, tool, date and program version of a calibration: the first lines of its file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct RecordHead {
    pub sensor: String,
    pub tool: String,
    /// Date of the calibration, UTC, ISO 8601 (`2026-08-21T10:20:30Z`).
    pub date: String,
    pub software: String,
}

impl RecordHead {
    /// Creates the head of a record by this version of the program. `date` in ISO 8601, UTC.
    pub fn new(sensor: &str, tool: &str, date: &str) -> Self {
        let software = env!("CARGO_PKG_VERSION").to_owned();
        Self { sensor: sensor.to_owned(), tool: tool.to_owned(), date: date.to_owned(), software }
    }
}

/// Whether a calibration may be used, and the person who has overridden its verdict.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Judgement {
    pub verdict: Verdict,
    pub reason: String,
    /// Name of the person who uses the calibration despite its verdict.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub override_by: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub override_reason: Option<String>,
}

impl Judgement {
    pub fn new(verdict: Verdict, reason: impl Into<String>) -> Self {
        Self { verdict, reason: reason.into(), override_by: None, override_reason: None }
    }

    /// Returns whether the calibration may be used: accepted, or overridden by a named person.
    pub fn allows(&self) -> bool {
        self.verdict == Verdict::Accepted || self.override_by.as_deref().is_some_and(|name| !name.trim().is_empty())
    }

    /// Overrides the verdict in this person's name.
    pub fn override_by(&mut self, name: &str, reason: Option<&str>) {
        self.override_by = Some(name.trim().to_owned());
        self.override_reason = reason.map(|reason| reason.trim().to_owned());
    }
}

/// The content of a calibration file. A record has a field `kind` with the value [`KIND`](Self::KIND), and denies
/// unknown keys.
pub trait CalibrationRecord: Serialize + DeserializeOwned {
    /// Kind of the record, also the first part of the file's name.
    const KIND: &'static str;
    fn head(&self) -> &RecordHead;
    fn judgement(&self) -> &Judgement;
    /// Returns the fault that makes the numbers unusable; `None` if they are usable.
    fn fault(&self) -> Option<&'static str> {
        None
    }
}
