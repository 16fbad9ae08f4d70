//! The timing panel.

use crate::language::{Text, told};

pub(in crate::console) const WAKE_UP: Text = Text::of("Wake-up", "Wake-up");
pub(in crate::console) const WAKE_UP_HOVER: Text = Text::of(
    "How late the loop wakes up after the start of its period (µs)",
    "How late the loop wakes up after the start of its period (µs)",
);
pub(in crate::console) const WORK: Text = Text::of("Work", "Work");
pub(in crate::console) const WORK_HOVER: Text = Text::of(
    "Computing time of one tick: gravity, identification, selection, rendering and gates (µs)",
    "Computing time of one tick: gravity, identification, selection, rendering and gates (µs)",
);
pub(in crate::console) const SAMPLE_TO_FORCE: Text = Text::of("Sample to force", "Sample to force");
pub(in crate::console) const SAMPLE_TO_FORCE_HOVER: Text = Text::of(
    "Time from the arrival of the oldest measurement until the force computed from it is sent to the handle (µs)",
    "Time from the arrival of the oldest measurement until the force computed from it is sent to the handle (µs)",
);
pub(in crate::console) const TICKS: Text = Text::of("Ticks", "Ticks");
pub(in crate::console) const TICKS_HOVER: Text = Text::of(
    "Ticks since the loop started, and how many per second reach this screen",
    "Ticks since the loop started, and how many per second reach this screen",
);
pub(in crate::console) const MISSED: Text = Text::of("Missed", "Missed");
pub(in crate::console) const MISSED_HOVER: Text = Text::of(
    "Periods that the loop missed because it was late. They are counted and skipped, never caught up.",
    "Periods that the loop missed because it was late. They are counted and skipped, never caught up.",
);
pub(in crate::console) const DROPPED: Text = Text::of("Dropped", "Dropped");
pub(in crate::console) const DROPPED_HOVER: Text = Text::of(
    "Ticks that this screen did not receive because it was busy. The loop never waits for the screen.",
    "Ticks that this screen did not receive because it was busy. The loop never waits for the screen.",
);
pub(in crate::console) const CONSOLE_FRAME: Text = Text::of("Console frame", "Console frame");
pub(in crate::console) const SCHEDULING_HOVER: Text = Text::of(
    "Real-time priority prevents other programs from delaying the loop; locked memory prevents page faults",
    "Real-time priority prevents other programs from delaying the loop; locked memory prevents page faults",
);
pub(in crate::console) const REAL_TIME_PRIORITY: Text = Text::of("Real-time priority", "Real-time priority");
pub(in crate::console) const LOCKED_MEMORY: Text = Text::of("Locked memory", "Locked memory");
pub(in crate::console) const FRAME_HOVER: Text = Text::of(
    "Time between two frames of this window since it opened (ms; target 31 ms, idle time not counted), \
    and the work in the present frame",
    "Time between two frames of this window since it opened (ms; target 31 ms, idle time not counted), \
    and the work in the present frame",
);
pub(in crate::console) const FRAME_HOVER_ROUGH: Text = Text::of(
    "Time between two frames of this window since it opened (ms; target 31 ms, idle time not counted), \
    and the work in the present frame. Edges in 3-D are not smoothed, because this computer would draw \
    too slowly.",
    "Time between two frames of this window since it opened (ms; target 31 ms, idle time not counted), \
    and the work in the present frame. Edges in 3-D are not smoothed, because this computer would draw \
    too slowly.",
);
pub(in crate::console) const GRANTED: Text = Text::of("granted", "granted");
pub(in crate::console) const REFUSED: Text = Text::of("refused", "refused");

/// Range of the last bar of a histogram.
pub(in crate::console) fn and_more(from_us: f64) -> String {
    told!("{from_us:.0} µs or more", "{from_us:.0} µs or more")
}

/// Range of any other bar.
pub(in crate::console) fn from_to(from_us: f64, to_us: f64) -> String {
    told!("{from_us:.0} to {to_us:.0} µs", "{from_us:.0} to {to_us:.0} µs")
}

/// Hover text of a bar.
pub(in crate::console) fn bar(name: &str, range: &str, ticks: &str, share: &str) -> String {
    told!("{name}: {range}\n{ticks} ticks, {share}", "{name}: {range}\n{ticks} ticks, {share}")
}

/// A histogram in one sentence.
pub(in crate::console) fn histogram(name: &str, late: &str, total: &str, deadline_us: f64) -> String {
    told!(
        "{name} histogram: {late} of {total} ticks exceeded the deadline of {deadline_us:.0} µs",
        "{name} histogram: {late} of {total} ticks exceeded the deadline of {deadline_us:.0} µs"
    )
}

/// Label of the deadline.
pub(in crate::console) fn deadline(deadline_us: f64) -> String {
    told!("deadline {deadline_us:.0} µs", "deadline {deadline_us:.0} µs")
}

/// Explanation of the height scale of a histogram.
pub(in crate::console) fn log_scale(top: &str) -> String {
    told!("log scale, maximum {top}", "log scale, maximum {top}")
}

/// Title of the strip of missed periods.
pub(in crate::console) fn missed(minutes: usize, count: &str) -> String {
    told!("Missed in the last {minutes} min: {count}", "Missed in the last {minutes} min: {count}")
}

/// Accessible name of the strip.
pub(in crate::console) fn missed_periods(words: &str) -> String {
    told!("{words} periods", "{words} periods")
}

/// Hover text of a bar of the strip.
pub(in crate::console) fn missed_at(age_s: usize, count: &str) -> String {
    told!("{age_s} s ago: {count} periods missed", "{age_s} s ago: {count} periods missed")
}

/// Number of ticks, and their rate.
pub(in crate::console) fn ticks_at(ticks: &str, rate_hz: f64) -> String {
    told!("{ticks} at {rate_hz:.0} Hz", "{ticks} at {rate_hz:.0} Hz")
}

/// Time between two frames (median and 99th percentile) and work per frame, ms.
pub(in crate::console) fn frame([p50_ms, p99_ms]: [f64; 2], work_ms: f64) -> String {
    told!(
        "p50 {p50_ms:.0}, p99 {p99_ms:.0}, work {work_ms:.0} ms",
        "p50 {p50_ms:.0}, p99 {p99_ms:.0}, work {work_ms:.0} ms"
    )
}
