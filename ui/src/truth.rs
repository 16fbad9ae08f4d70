//! The loop's force at the tip beside the true one, which emulators tell from their own process. What compares the two is an extra.

use std::{
    fmt::Debug,
    time::{SystemTime, UNIX_EPOCH},
};

use nima_machine::messages::Tick;

/// The time of day, s since 1970.
pub(crate) fn now_s() -> f64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0.0, |since| since.as_secs_f64())
}

/// Compares ticks with what emulators tell about them.
pub(crate) trait Comparison: Debug {
    /// Adds a tick that is seen at this time of day, s.
    fn tick(&mut self, tick: &Tick, seen_s: f64);

    /// Adds what the emulators told since the last call, line by line, and compares what can be compared by now.
    fn hear(&mut self, told: &mut dyn Iterator<Item = String>);

    /// The figures, as they are printed.
    fn figures(&self) -> Vec<serde_json::Value>;

    /// The figures as a table, which begins with a line break; empty without figures.
    fn in_words(&self) -> String;
}
