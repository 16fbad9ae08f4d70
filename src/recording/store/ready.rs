//! Records of ready checks: TOML, one file per check, in the folder `checks` next to the calibrations. All are kept.

use std::{
    fs, io,
    path::{Path, PathBuf},
    time::SystemTime,
};

use nima_files::write_atomically;
use serde::{Deserialize, Serialize};

use super::{Store, StoreError, date, seconds};

/// A check is valid for engagements in the next twelve hours: a working day, whatever the time zone.
pub const VALID_S: u64 = 12 * 3600;

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CheckedDevice {
    /// Name in the rig, such as `right sensor`.
    pub name: String,
    pub driver: String,
    /// Empty if the device does not report one.
    pub serial: String,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PointOutcome {
    Passed,
    Failed,
    /// The rig has no such part.
    LeftOut,
    /// The check was ended before this item.
    NotReached,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CheckedItem {
    /// Name of the check.
    pub check: String,
    pub outcome: PointOutcome,
    /// Measured value; its limit and unit follow.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub value: Option<f64>,
    /// In `unit`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limit: Option<f64>,
    /// Unit of `value` and `limit`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// Reason for the failure, or the part that the rig lacks.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cause: Option<String>,
    /// Remedy.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cure: Option<String>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ReadyRecord {
    /// Always [`KIND`].
    pub kind: String,
    /// End of the check, UTC, ISO 8601.
    pub date: String,
    /// Version of the program.
    pub software: String,
    pub rig: String,
    /// Built-in name or path of its file.
    pub rig_file: String,
    /// Person who carried out the requested actions.
    pub by: String,
    /// No item failed, and every item was reached.
    pub passed: bool,
    /// Duration, s.
    pub took_s: f64,
    /// The devices, in the order of the rig's roster.
    #[serde(default)]
    pub devices: Vec<CheckedDevice>,
    #[serde(default)]
    pub items: Vec<CheckedItem>,
}

/// Prefix of the file names.
pub const KIND: &str = "ready_check";

impl ReadyRecord {
    /// Returns the age at `now`, s; `None` if the date is invalid or more than a minute after `now`.
    pub fn age_s(&self, now: SystemTime) -> Option<u64> {
        let made_s = date::parse(&self.date)?;
        let now_s = seconds(now);
        (made_s <= now_s + 60).then(|| now_s.saturating_sub(made_s))
    }

    /// Returns whether the check passed, is recent enough, and was made with these devices.
    pub fn is_valid(&self, devices: &[CheckedDevice], now: SystemTime) -> bool {
        self.passed && self.devices == devices && self.age_s(now).is_some_and(|age_s| age_s <= VALID_S)
    }
}

impl Store {
    /// Returns the folder of the checks.
    fn checks(&self) -> PathBuf {
        self.folder().parent().unwrap_or(Path::new("")).join("checks")
    }

    /// Saves a ready check as a new file; returns its path.
    ///
    /// # Errors
    /// [`StoreError`] if the folder or the file cannot be written.
    pub fn save_check(&self, record: &ReadyRecord) -> Result<PathBuf, StoreError> {
        let folder = self.checks();
        let text = toml::to_string(record)
            .map_err(|error| StoreError::Unwritable { kind: KIND, message: error.to_string() })?;
        let stem = format!("{}{}", prefix(&record.rig), record.date.replace(':', ""));
        let failed = |path: &Path, source| StoreError::Write { path: path.to_owned(), source };
        fs::create_dir_all(&folder).map_err(|source| failed(&folder, source))?;
        // Two checks within a second need two file names.
        let path = (0..100)
            .map(|again| folder.join(if again == 0 { format!("{stem}.toml") } else { format!("{stem}-{again}.toml") }))
            .find(|path| !path.exists())
            .ok_or_else(|| failed(&folder, io::ErrorKind::AlreadyExists.into()))?;
        write_atomically(&path, |file| file.write_all(text.as_bytes())).map_err(|source| failed(&path, source))?;
        Ok(path)
    }

    /// Returns the last check of the rig with this name; unreadable files are skipped.
    pub fn last_check(&self, rig: &str) -> Option<ReadyRecord> {
        self.last_check_that(rig, |_| true)
    }

    /// Returns the last check that passed, however old: it records which device belongs to which part.
    pub fn last_passed_check(&self, rig: &str) -> Option<ReadyRecord> {
        self.last_check_that(rig, |record| record.passed)
    }

    fn last_check_that(&self, rig: &str, fits: impl Fn(&ReadyRecord) -> bool) -> Option<ReadyRecord> {
        let prefix = prefix(rig);
        let entries = fs::read_dir(self.checks()).ok()?.flatten();
        let mut names: Vec<_> = entries.filter_map(|entry| entry.file_name().into_string().ok()).collect();
        names.retain(|name| {
            name.starts_with(&prefix) && name.rsplit_once('.').is_some_and(|(_, ending)| ending == "toml")
        });
        // The name contains the date; if two names have the same second, the longer one is later.
        names.sort_by(|one, other| stem(one).cmp(stem(other)));
        names.iter().rev().find_map(|name| {
            let text = nima_files::read_text(&self.checks().join(name), nima_files::CONFIG_MAX).ok()?;
            let record: ReadyRecord = nima_files::from_toml(&text).ok()?;
            (record.kind == KIND && record.rig == rig && fits(&record)).then_some(record)
        })
    }
}

fn stem(name: &str) -> &str {
    name.strip_suffix(".toml").unwrap_or(name)
}

/// Returns the prefix of the names of a rig's checks: `ready_check-Emulated_rig-`.
fn prefix(rig: &str) -> String {
    let plain = |letter: char| if letter.is_ascii_alphanumeric() { letter } else { '_' };
    format!("{KIND}-{}-", rig.chars().take(48).map(plain).collect::<String>())
}

#[cfg(test)]
mod tests {
    use std::time::{Duration, UNIX_EPOCH};

    use super::*;

    fn record(rig: &str, date: &str, passed: bool) -> ReadyRecord {
        let device = CheckedDevice { name: "right sensor".into(), driver: "Bota".into(), serial: "SN000901".into() };
        let item = |outcome| CheckedItem {
            check: "Stop".into(),
            outcome,
            value: Some(0.001),
            limit: Some(0.1),
            unit: Some("s".into()),
            cause: None,
            cure: None,
        };
        ReadyRecord {
            kind: KIND.into(),
            date: date.into(),
            software: "0.2.0".into(),
            rig: rig.into(),
            rig_file: "emulated".into(),
            by: "Ada".into(),
            passed,
            took_s: 41.5,
            devices: vec![device],
            items: vec![item(PointOutcome::Passed), item(PointOutcome::LeftOut)],
        }
    }

    #[test]
    fn every_check_is_kept_and_the_last_one_of_the_rig_is_found() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(folder.path().join("calibrations"));
        assert_eq!(store.last_check("Emulated rig"), None);
        let dates = ["2026-08-21T10:20:30Z", "2026-08-22T07:00:00Z", "2026-08-22T07:00:00Z"];
        for (date, passed) in dates.into_iter().zip([true, false, true]) {
            store.save_check(&record("Emulated rig", date, passed)).unwrap();
        }
        store.save_check(&record("Another rig", "2026-08-23T07:00:00Z", true)).unwrap();
        assert_eq!(fs::read_dir(folder.path().join("checks")).unwrap().count(), 4);
        assert_eq!(store.last_check("Emulated rig"), Some(record("Emulated rig", dates[2], true)), "digit by digit");
        store.save_check(&record("Emulated rig", "2026-08-24T07:00:00Z", false)).unwrap();
        assert_eq!(store.last_passed_check("Emulated rig"), Some(record("Emulated rig", dates[2], true)));
        fs::remove_file(folder.path().join("checks/ready_check-Emulated_rig-2026-08-24T070000Z.toml")).unwrap();
        fs::write(folder.path().join("checks/ready_check-Emulated_rig-2027.toml"), "kind = 3").unwrap();
        assert!(store.last_check("Emulated rig").is_some(), "a damaged file is skipped");
    }

    #[test]
    fn a_check_counts_for_twelve_hours_with_the_same_devices_if_it_passed() {
        let made = record("Emulated rig", "2026-08-21T10:20:30Z", true);
        let at = |hours: f64| {
            UNIX_EPOCH + Duration::from_secs(date::parse(&made.date).unwrap()) + Duration::from_secs_f64(hours * 3600.0)
        };
        assert!(made.is_valid(&made.devices, at(0.0)) && made.is_valid(&made.devices, at(11.9)));
        assert!(!made.is_valid(&made.devices, at(12.1)));
        let other = CheckedDevice { serial: "SN000902".into(), ..made.devices[0].clone() };
        assert!(!made.is_valid(&[other], at(1.0)), "another sensor");
        assert!(!ReadyRecord { passed: false, ..made.clone() }.is_valid(&made.devices, at(1.0)));
        let before = UNIX_EPOCH + Duration::from_secs(date::parse(&made.date).unwrap() - 7200);
        assert!(!made.is_valid(&made.devices, before), "dated in the future");
    }
}
