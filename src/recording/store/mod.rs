//! Calibration files: TOML, one per kind and sensor, in the user's data folder.
//!
//! A file is bound to its sensor and tool and refused for any other. A calibration rejected by its verdict is saved
//! only with the name of the person who overrides it. Writing is atomic, and the previous file is kept as `.previous`.
//! Dates are UTC, ISO 8601.

mod date;
mod ready;

use std::{
    fs, io,
    path::{Path, PathBuf},
    time::{SystemTime, UNIX_EPOCH},
};

use nima_core::calibration::CalibrationRecord;
use nima_files::{PASSAGE, copy_atomically, quoted, shortened, write_atomically};
use serde::{Deserialize, Serialize};

pub use ready::{CheckedDevice, CheckedItem, KIND as READY_CHECK, PointOutcome, ReadyRecord, VALID_S};

/// Device to which a calibration is bound: one wrist sensor with one tool.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WristId {
    /// As reported by the sensor.
    pub serial_number: String,
    /// Name of the tool in the rig file; another tool needs its own calibration.
    pub tool: String,
}

#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    #[error("no folder for calibrations was found; set NIMA_DATA_DIR")]
    NoFolder,
    #[error(
        "\"{name}\" cannot be part of a file name; use at most 64 letters, digits, '-', '_' and '.', not beginning with '.'"
    )]
    Name { name: String },
    #[error("cannot read calibration {path}")]
    Read { path: PathBuf, source: io::Error },
    #[error("cannot write calibration {path}")]
    Write { path: PathBuf, source: io::Error },
    #[error("calibration {path} is damaged: {message}; repair it or calibrate again")]
    Damaged {
        path: PathBuf,
        /// Line, column and key.
        message: String,
    },
    #[error("calibration {path} is for {what} \"{found}\", not \"{wanted}\"; calibrate this {what}")]
    Other {
        path: PathBuf,
        /// `kind`, `sensor` or `tool`.
        what: &'static str,
        found: String,
        wanted: String,
    },
    #[error(
        "cannot write {path}: it is a calibration of kind \"{found}\", and one of kind \"{wanted}\" would replace it; name another file"
    )]
    Replaces { path: PathBuf, found: String, wanted: &'static str },
    /// The verdict forbids its use, and no person has overridden it.
    #[error("the {kind} calibration was refused: {reason}; repeat it, or name the person who overrides the verdict")]
    Refused { kind: &'static str, reason: String },
    #[error("the {kind} calibration cannot be written: {message}; calibrate again")]
    Unwritable { kind: &'static str, message: String },
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CalibrationAge {
    Fresh,
    Old {
        days: u64,
    },
    /// The date is in the future, so a clock is wrong.
    Future,
}

#[derive(Clone, Debug, PartialEq)]
pub struct LoadedRecord<R> {
    pub record: R,
    /// Warn if it is not `Fresh`.
    pub age: CalibrationAge,
    pub path: PathBuf,
}

/// Age in days from which a calibration is old.
pub const DEFAULT_MAX_AGE_DAYS: u64 = 30;
const DAY_S: u64 = 86_400;

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Store {
    folder: PathBuf,
    max_age_days: u64,
}

impl Store {
    /// Opens the store in this folder, which is created when the first record is saved.
    pub fn open(folder: impl Into<PathBuf>) -> Self {
        Self { folder: folder.into(), max_age_days: DEFAULT_MAX_AGE_DAYS }
    }

    /// Opens the user's store: `$NIMA_DATA_DIR/calibrations`, else `nima-console/calibrations` in the platform's data
    /// folder.
    ///
    /// # Errors
    /// [`StoreError`] if the variable is not set and the platform has no data folder.
    pub fn of_user() -> Result<Self, StoreError> {
        let get = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
        user_folder(&get).map(Self::open).ok_or(StoreError::NoFolder)
    }

    /// Sets the age in days from which a calibration is old.
    #[must_use]
    pub const fn with_max_age_days(mut self, days: u64) -> Self {
        self.max_age_days = days;
        self
    }

    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Returns the path of this kind of record for this sensor.
    ///
    /// # Errors
    /// [`StoreError`] if the sensor's name cannot be part of a file name.
    pub fn path<R: CalibrationRecord>(&self, sensor: &str) -> Result<PathBuf, StoreError> {
        Ok(self.folder.join(format!("{}-{}.toml", R::KIND, checked(sensor)?)))
    }

    /// Returns the other sensors with a record of this kind for the same tool. Unreadable files are skipped.
    pub fn other_sensors<R: CalibrationRecord>(&self, wrist: &WristId) -> Vec<String> {
        let of_kind = format!("{}-", R::KIND);
        let entries = fs::read_dir(&self.folder).into_iter().flatten().flatten();
        let files = entries.filter(|entry| {
            entry.file_name().to_str().is_some_and(|name| {
                name.starts_with(&of_kind) && name.rsplit_once('.').is_some_and(|(_, ending)| ending == "toml")
            })
        });
        let records = files.filter_map(|entry| read::<R>(&entry.path()).ok().flatten());
        let others = records.filter(|record| {
            let head = record.head();
            head.tool == wrist.tool && head.sensor != wrist.serial_number
        });
        let mut sensors: Vec<_> = others.map(|record| record.head().sensor.clone()).collect();
        sensors.sort();
        sensors
    }

    /// Returns the path of another file of this kind for this sensor, `KIND-SENSOR.ENDING`: for networks and their data
    /// sets.
    ///
    /// # Errors
    /// [`StoreError`] if kind or sensor cannot be part of a file name.
    ///
    /// ```
    /// use nima_recording::store::Store;
    ///
    /// let store = Store::open("calibrations");
    /// assert!(store.path_of("tip_force", "SN-0042", "safetensors")?.ends_with("tip_force-SN-0042.safetensors"));
    /// assert!(store.path_of("tip_force", "../../etc", "safetensors").is_err(), "no name leads out of the folder");
    /// # Ok::<(), nima_recording::store::StoreError>(())
    /// ```
    pub fn path_of(&self, kind: &str, sensor: &str, ending: &str) -> Result<PathBuf, StoreError> {
        Ok(self.folder.join(format!("{}-{}.{ending}", checked(kind)?, checked(sensor)?)))
    }

    /// Returns the age at `now` of a date (UTC, ISO 8601); `None` if the date is invalid.
    pub fn age_of(&self, date: &str, now: SystemTime) -> Option<CalibrationAge> {
        date::parse(date).map(|made_s| self.age(made_s, seconds(now)))
    }

    /// Saves a record under its sensor's name and returns the path; the previous record is kept as `.previous`.
    ///
    /// # Errors
    /// [`StoreError`] for a record that was rejected without an override, or a folder or file that cannot be written.
    pub fn save<R: CalibrationRecord>(&self, record: &R) -> Result<PathBuf, StoreError> {
        let path = self.path::<R>(&record.head().sensor)?;
        fs::create_dir_all(&self.folder).map_err(|source| StoreError::Write { path: path.clone(), source })?;
        write(&path, record)?;
        Ok(path)
    }

    /// Loads the record of this sensor and tool; `None` if there is none.
    ///
    /// # Errors
    /// [`StoreError`] for a file that cannot be read, is not a record of this kind, belongs to another sensor or tool,
    /// or was rejected.
    pub fn load<R: CalibrationRecord>(
        &self,
        sensor: &str,
        tool: &str,
        now: SystemTime,
    ) -> Result<Option<LoadedRecord<R>>, StoreError> {
        let path = self.path::<R>(sensor)?;
        let Some(record) = read::<R>(&path)? else { return Ok(None) };
        for (what, found, wanted) in [("sensor", &record.head().sensor, sensor), ("tool", &record.head().tool, tool)] {
            if found != wanted {
                let found = quoted(found);
                let wanted = quoted(wanted);
                return Err(StoreError::Other { path, what, found, wanted });
            }
        }
        let Some(age) = self.age_of(&record.head().date, now) else {
            let message =
                format!("date = \"{}\" is invalid; write it like 2026-08-21T10:20:30Z", quoted(&record.head().date));
            return Err(StoreError::Damaged { path, message });
        };
        Ok(Some(LoadedRecord { record, age, path }))
    }

    const fn age(&self, made_s: u64, now_s: u64) -> CalibrationAge {
        // Two computers' clocks may differ by minutes, but a difference of more than a day is an error.
        if made_s > now_s + DAY_S {
            return CalibrationAge::Future;
        }
        let days = now_s.saturating_sub(made_s) / DAY_S;
        if days > self.max_age_days { CalibrationAge::Old { days } } else { CalibrationAge::Fresh }
    }
}

/// Writes one record to any path by the rules of the store: verdict or override, atomic, the previous file kept as
/// `.previous` (same name with that ending).
///
/// # Errors
/// As [`Store::save`].
pub fn write<R: CalibrationRecord>(path: &Path, record: &R) -> Result<(), StoreError> {
    if !record.judgement().allows() {
        return Err(StoreError::Refused { kind: R::KIND, reason: record.judgement().reason.clone() });
    }
    let unwritable = |message: String| StoreError::Unwritable { kind: R::KIND, message };
    if let Some(fault) = record.fault() {
        return Err(unwritable(fault.to_owned()));
    }
    check_kind::<R>(path)?;
    let text = toml::to_string(record).map_err(|error| unwritable(error.to_string()))?;
    let failed = |source| StoreError::Write { path: path.to_owned(), source };
    // Copy first, then rename the new file over it, so that a calibration exists at every moment.
    keep_previous(path).map_err(failed)?;
    write_atomically(path, |file| file.write_all(text.as_bytes())).map_err(failed)
}

/// Checks that a record of this kind would not replace a calibration of another kind.
///
/// # Errors
/// [`StoreError::Replaces`] if it would.
pub fn check_kind<R: CalibrationRecord>(path: &Path) -> Result<(), StoreError> {
    // A file that cannot be read, or is not a calibration, is replaced like any other output.
    let text = nima_files::read_text(path, nima_files::CONFIG_MAX).unwrap_or_default();
    let head: toml::Table = text.parse().unwrap_or_default();
    match kind_of(&head) {
        Some(found) if found != R::KIND => {
            Err(StoreError::Replaces { path: path.to_owned(), found: quoted(found), wanted: R::KIND })
        }
        _ => Ok(()),
    }
}

fn kind_of(head: &toml::Table) -> Option<&str> {
    head.get("kind").and_then(toml::Value::as_str)
}

/// Copies the file at `path`, if it exists, to the same name with the ending `.previous`.
///
/// # Errors
/// I/O errors.
pub fn keep_previous(path: &Path) -> io::Result<()> {
    match copy_atomically(path, &previous(path)) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
        done => done,
    }
}

/// Reads one record; `None` if there is no file. Checks kind and verdict, but not sensor and tool.
///
/// # Errors
/// [`StoreError`] for a file that cannot be read, is not a record of this kind, or was rejected.
pub fn read<R: CalibrationRecord>(path: &Path) -> Result<Option<R>, StoreError> {
    let text = match nima_files::read_text(path, nima_files::CONFIG_MAX) {
        Ok(text) => text,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        Err(source) => return Err(StoreError::Read { path: path.to_owned(), source }),
    };
    let damaged = |message: String| StoreError::Damaged { path: path.to_owned(), message };
    let as_text = |misfit: nima_files::Misfit| {
        damaged(shortened(&format!("line {}: {}", misfit.line(&text), misfit.message()), PASSAGE))
    };
    // Check the kind first: keys of another kind would only be reported as unknown.
    let head: toml::Table = text.parse().map_err(|error: toml::de::Error| as_text(error.into()))?;
    if let Some(found) = kind_of(&head)
        && found != R::KIND
    {
        let found = quoted(found);
        let wanted = R::KIND.to_owned();
        return Err(StoreError::Other { path: path.to_owned(), what: "kind", found, wanted });
    }
    let record: R = nima_files::from_toml(&text).map_err(as_text)?;
    if let Some(fault) = record.fault() {
        return Err(damaged(fault.to_owned()));
    }
    if !record.judgement().allows() {
        return Err(StoreError::Refused { kind: R::KIND, reason: shortened(&record.judgement().reason, PASSAGE) });
    }
    Ok(Some(record))
}

/// Returns the current time, UTC, ISO 8601 to the second: the date of a record.
pub fn utc_now() -> String {
    utc_of(SystemTime::now())
}

/// Formats a time as UTC, ISO 8601, for example `2026-08-21T10:20:30Z`.
pub fn utc_of(time: SystemTime) -> String {
    date::format(seconds(time))
}

/// Returns the whole days from a date (UTC, ISO 8601) to `now`: zero for a future date, `None` for an invalid one.
pub fn days_since(date: &str, now: SystemTime) -> Option<u64> {
    date::parse(date).map(|made_s| seconds(now).saturating_sub(made_s) / DAY_S)
}

/// Returns the seconds since 1970; zero for earlier times.
fn seconds(time: SystemTime) -> u64 {
    time.duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs())
}

/// Returns the path of the previous version of the file at `path`.
pub fn previous(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(".previous");
    name.into()
}

/// Returns whether a name can be part of a file name: only letters, digits and a few symbols, so that it cannot contain
/// a path.
///
/// ```
/// use nima_recording::store::can_name_a_file;
///
/// assert!(can_name_a_file("SN-0042") && !can_name_a_file("../other") && !can_name_a_file(""));
/// ```
pub fn can_name_a_file(name: &str) -> bool {
    let plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.');
    !name.is_empty() && name.len() <= 64 && !name.starts_with('.') && name.chars().all(plain)
}

fn checked(name: &str) -> Result<&str, StoreError> {
    if can_name_a_file(name) { Ok(name) } else { Err(StoreError::Name { name: quoted(name) }) }
}

/// Reads environment variables with `get`; an empty variable counts as unset.
fn user_folder(get: &dyn Fn(&str) -> Option<PathBuf>) -> Option<PathBuf> {
    if let Some(folder) = get("NIMA_DATA_DIR") {
        return Some(folder.join("calibrations"));
    }
    let data = if cfg!(windows) {
        get("APPDATA")
    } else if cfg!(target_os = "macos") {
        get("HOME").map(|home| home.join("Library/Application Support"))
    } else {
        // XDG base directory specification: a relative path is invalid and ignored.
        get("XDG_DATA_HOME")
            .filter(|path| path.is_absolute())
            .or_else(|| get("HOME").map(|home| home.join(".local/share")))
    };
    data.map(|data| data.join("nima-console").join("calibrations"))
}

#[cfg(test)]
mod tests;
