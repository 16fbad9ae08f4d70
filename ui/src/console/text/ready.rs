//! The ready check.

pub(in crate::console) const TITLE: &str = "Ready check";
pub(in crate::console) const MEANING: &str =
    "Before the first engagement of the day: devices, calibrations, stop and watchdogs, in less than a minute";
pub(in crate::console) const OPEN: &str = "Ready check…";
pub(in crate::console) const WAITS: &str = "Waiting for the force sensors to tell who they are";
pub(in crate::console) const NOW: &str = "Now";
pub(in crate::console) const BY_ITSELF: &str = "This goes by itself: wait";
pub(in crate::console) const PASSED: &str = "Ready: every point is in order";
pub(in crate::console) const FAILED: &str = "Not ready: see the points that failed";
pub(in crate::console) const CLOSE: &str = "To the monitor";
pub(in crate::console) const CLOSE_HOVER: &str = "Where the rig is engaged";
pub(in crate::console) const AGAIN: &str = "Check again what failed";
pub(in crate::console) const AGAIN_HOVER: &str = "The points that passed keep their results";
pub(in crate::console) const WHOLE: &str = "Check everything again";
pub(in crate::console) const WHOLE_HOVER: &str = "Starts with the first point";
pub(in crate::console) const BY: &str = "Who checks";
pub(in crate::console) const BY_HOVER: &str = "This name is written into the record";

/// A point with its figure or cause.
pub(in crate::console) fn line(check: &str, words: &str) -> String {
    format!("{check}: {words}")
}

/// A point that the rig cannot have.
pub(in crate::console) fn left_out(check: &str, why: &str) -> String {
    format!("{check}: left out, {why}")
}

/// Where the record is.
pub(in crate::console) fn saved(path: &std::path::Path) -> String {
    format!("Kept in {}", path.display())
}

/// It could not be kept.
pub(in crate::console) fn not_saved(reason: &str) -> String {
    format!("The record is not kept: {reason}")
}

/// Since when it goes on, s.
pub(in crate::console) fn took(seconds: f64) -> String {
    format!("{seconds:.0} s")
}
