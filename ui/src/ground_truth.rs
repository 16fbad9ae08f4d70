//! Comparison of the loop's tip force with the true force that the emulators report from their process. An extra implements
//! it.

use std::{
    fmt::Debug,
    time::{SystemTime, UNIX_EPOCH},
};

use nima_machine::messages::Tick;

/// Returns the time of day, s since 1970.
pub(crate) fn now_s() -> f64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0.0, |since| since.as_secs_f64())
}

/// Compares ticks with the ground truth of the emulators.
pub trait TruthComparison: Debug {
    /// Adds a tick that was received at this time of day, s.
    fn tick(&mut self, tick: &Tick, seen_s: f64);

    /// Adds the lines that the emulators reported since the last call, and compares all ticks that are now complete.
    fn receive(&mut self, report: &mut dyn Iterator<Item = String>);

    /// Returns the results for JSON output.
    fn figures(&self) -> Vec<serde_json::Value>;

    /// Returns the results as a table that starts with a line break; empty without results.
    fn as_text(&self) -> String;
}
