//! The ready check.

use crate::language::{Text, told};

pub(in crate::console) const TITLE: Text = Text::of("Ready check", "Ready check");
pub(in crate::console) const MEANING: Text = Text::of(
    "Before the first engagement of the day: devices, calibrations, stop and watchdogs, in less than a minute",
    "Before the first engagement of the day: devices, calibrations, stop and watchdogs, in less than a minute",
);
pub(in crate::console) const OPEN: Text = Text::of("Ready check…", "Ready check…");
pub(in crate::console) const WAITS: Text = Text::of(
    "Waiting for the force sensors to tell who they are",
    "Waiting for the force sensors to tell who they are",
);
pub(in crate::console) const NOW: Text = Text::of("Now", "Now");
pub(in crate::console) const BY_ITSELF: Text = Text::of("This goes by itself: wait", "This goes by itself: wait");
pub(in crate::console) const PASSED: Text =
    Text::of("Ready: every point is in order", "Ready: every point is in order");
pub(in crate::console) const FAILED: Text =
    Text::of("Not ready: see the points that failed", "Not ready: see the points that failed");
pub(in crate::console) const CLOSE: Text = Text::of("To the monitor", "To the monitor");
pub(in crate::console) const CLOSE_HOVER: Text = Text::of("Where the rig is engaged", "Where the rig is engaged");
pub(in crate::console) const AGAIN: Text = Text::of("Check again what failed", "Check again what failed");
pub(in crate::console) const AGAIN_HOVER: Text =
    Text::of("The points that passed keep their results", "The points that passed keep their results");
pub(in crate::console) const WHOLE: Text = Text::of("Check everything again", "Check everything again");
pub(in crate::console) const WHOLE_HOVER: Text = Text::of("Starts with the first point", "Starts with the first point");
pub(in crate::console) const BY: Text = Text::of("Who checks", "Who checks");
pub(in crate::console) const BY_HOVER: Text =
    Text::of("This name is written into the record", "This name is written into the record");

/// A point with its figure or cause.
pub(in crate::console) fn line(check: &str, words: &str) -> String {
    format!("{check}: {words}")
}

/// A point that the rig cannot have.
pub(in crate::console) fn left_out(check: &str, why: &str) -> String {
    told!("{check}: left out, {why}", "{check}: left out, {why}")
}

/// Where the record is.
pub(in crate::console) fn saved(path: &std::path::Path) -> String {
    told!("Kept in {}", "Kept in {}", path.display())
}

/// It could not be kept.
pub(in crate::console) fn not_saved(reason: &str) -> String {
    told!("The record is not kept: {reason}", "The record is not kept: {reason}")
}

/// Since when it goes on, s.
pub(in crate::console) fn took(seconds: f64) -> String {
    format!("{seconds:.0} s")
}
