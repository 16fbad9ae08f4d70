//! The timing of the loop, once a second: missed periods and percentiles of all times, both since the start.

use nima_core::statistics::{Percentiles, Quantiles};
use nima_machine::teleop::Timing;
use nima_recording::session::WriteError;

use super::plot::Plot;
use crate::sinks::SessionSinks;

/// Interval, s.
const EVERY_S: f64 = 1.0;
pub(crate) const TIMING_TOPIC: &str = "timing";
/// The times, each with `p50_us`, `p99_us`, `p999_us` and `max_us`.
pub(crate) const TIMES: [&str; 3] = ["wake", "work", "sample_to_force"];

pub(super) fn names() -> Vec<String> {
    let of = |time: &str| ["p50_us", "p99_us", "p999_us", "max_us"].map(|what| format!("{time}.{what}"));
    std::iter::once("missed".to_owned()).chain(TIMES.iter().flat_map(|time| of(time))).collect()
}

#[derive(Debug)]
pub(super) struct TimingChannel {
    plot: Plot,
    due_s: f64,
    missed: u64,
    durations: [Percentiles; TIMES.len()],
}

impl TimingChannel {
    pub(super) fn new(out: &mut SessionSinks) -> Result<Self, WriteError> {
        let names = names();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let plot = Plot::new(out, TIMING_TOPIC, &names)?;
        Ok(Self { plot, due_s: EVERY_S, missed: 0, durations: Default::default() })
    }

    /// Adds a tick, and writes a message if one is due.
    pub(super) fn tick(&mut self, out: &mut SessionSinks, time_ns: u64, timing: &Timing) -> Result<(), WriteError> {
        let Timing { now_s, wake_s, work_s, sample_to_force_s, missed_now } = *timing;
        self.missed += missed_now;
        for (percentiles, time_s) in self.durations.iter_mut().zip([Some(wake_s), Some(work_s), sample_to_force_s]) {
            if let Some(time_s) = time_s {
                percentiles.record(time_s);
            }
        }
        // If the clock was set back, start again.
        if now_s < self.due_s && now_s > self.due_s - 2.0 * EVERY_S {
            return Ok(());
        }
        self.due_s = now_s + EVERY_S;
        self.plot.values.push(self.missed as f64);
        for percentiles in &self.durations {
            self.plot.values.extend(values(percentiles));
        }
        self.plot.write(out, time_ns, false)
    }
}

/// NaN where nothing was timed.
fn values(percentiles: &Percentiles) -> [f64; 4] {
    percentiles.known_quantiles().map_or([f64::NAN; 4], |Quantiles { p50, p99, p999, max }| [p50, p99, p999, max])
}
