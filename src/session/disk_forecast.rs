//! Predicts how long the disk has room for a running recording.

use std::{
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

use crate::session_store::free_bytes;

/// Warn if the disk will be full within this time: a day, so that space can be freed before the next working day.
pub const WARN_BEFORE: Duration = Duration::from_hours(24);
/// The rate of a session is meaningful only after it has grown for this long.
const GROWN: Duration = Duration::from_mins(1);

#[derive(Debug)]
pub struct DiskForecast {
    file: PathBuf,
    since: Instant,
    /// Bytes at that time.
    bytes: u64,
}

impl DiskForecast {
    /// Starts with the current size of the file.
    pub fn new(file: &Path, bytes: u64, now: Instant) -> Self {
        Self { file: file.to_owned(), since: now, bytes }
    }

    /// Returns the time until the disk is full if the file, whose size is now `bytes`, continues to grow at its average
    /// rate; `others` are bytes that will be freed for it. `None` in its first minute, and if the system does not
    /// report the free space.
    pub fn full_in(&self, bytes: u64, others: u64, now: Instant) -> Option<Duration> {
        let grown = now.saturating_duration_since(self.since);
        if grown < GROWN {
            return None;
        }
        // A name without a folder is in the current folder.
        let folder =
            self.file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or_else(|| Path::new("."));
        let left = free_bytes(folder)?.saturating_add(others) as f64;
        let per_s = bytes.saturating_sub(self.bytes) as f64 / grown.as_secs_f64();
        // For a file that does not grow, the quotient is infinite: `None`, because the disk never fills.
        Duration::try_from_secs_f64(left / per_s).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_disk_lasts_as_long_as_its_free_bytes_and_those_of_sessions_that_make_room() {
        let folder = tempfile::tempdir().unwrap();
        let free = free_bytes(folder.path()).unwrap();
        let begin = Instant::now();
        let minute = Duration::from_mins(1);
        let outlook = DiskForecast::new(&folder.path().join("a.mcap"), 0, begin);
        // In two minutes the file has used a fraction of the disk that leaves room for ten hours.
        let bytes = free / 300;
        assert_eq!(outlook.full_in(bytes / 4, 0, begin + minute / 2), None, "too early to predict");
        let hours = |lasts: Option<Duration>| lasts.unwrap().as_secs_f64() / 3600.0;
        // Other programs also use this disk.
        let near = |hours: f64, expected: f64| (hours / expected - 1.0).abs() < 0.2;
        let lasts = hours(outlook.full_in(bytes, 0, begin + 2 * minute));
        assert!(near(lasts, 10.0), "{lasts} h");
        let lasts = hours(outlook.full_in(bytes, 2 * free, begin + 2 * minute));
        assert!(near(lasts, 30.0), "{lasts} h with what makes room: no warning");
        assert_eq!(outlook.full_in(0, 0, begin + 2 * minute), None, "it does not grow");
    }
}
