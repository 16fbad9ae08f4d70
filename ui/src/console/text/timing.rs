//! Words of the room `timing`.

pub(in crate::console) const WAKE_UP: &str = "Wake-up";
pub(in crate::console) const FROM_THE_MOMENT_THE: &str = "From the moment the loop should wake to when it does (us).";
pub(in crate::console) const WORK: &str = "Work";
pub(in crate::console) const ONE_TICK_GRAVITY_IDENTIFICATION: &str =
    "One tick: gravity, identification, selection, rendering, gates (us).";
pub(in crate::console) const SAMPLE_TO_FORCE: &str = "Sample to force";
pub(in crate::console) const FROM_THE_ARRIVAL_OF: &str =
    "From the arrival of the oldest measurement to when the force made from it was given to the handle (us).";
pub(in crate::console) const TICKS: &str = "Ticks";
pub(in crate::console) const TICKS_EXECUTED_SINCE_THE: &str =
    "Ticks executed since the loop began, and ticks that reached this screen in the last moment.";
pub(in crate::console) const MISSED: &str = "Missed";
pub(in crate::console) const PERIODS_IN_WHICH_THE: &str =
    "Periods in which the loop was not run in time. They are counted and skipped, never caught up.";
pub(in crate::console) const DROPPED: &str = "Dropped";
pub(in crate::console) const TICKS_THAT_DID_NOT: &str =
    "Ticks that did not reach this screen because it was busy. The loop never waits for it.";
pub(in crate::console) const CONSOLE_FRAME: &str = "Console frame";
pub(in crate::console) const REAL_TIME_PRIORITY_KEEPS: &str =
    "Real-time priority keeps other programs from delaying the loop; locked memory keeps page faults away.";
pub(in crate::console) const REAL_TIME_PRIORITY: &str = "Real-time priority";
pub(in crate::console) const LOCKED_MEMORY: &str = "Locked memory";
pub(in crate::console) const FRAME: &str = "Time from one picture of this window to the next since it opened (31 ms asked; at rest not counted), and the work in it now.";
pub(in crate::console) const FRAME_ROUGH: &str = "Time from one picture of this window to the next since it opened (31 ms asked; at rest not counted), and the work in it now. Edges in 3-D are not smoothed, \
                                                 because this computer draws too slowly with it.";

/// The last bar of a histogram.
pub(in crate::console) fn and_more(from_us: f64) -> String {
    format!("{from_us:.0} us and more")
}

/// Any other bar.
pub(in crate::console) fn from_to(from_us: f64, to_us: f64) -> String {
    format!("{from_us:.0} to {to_us:.0} us")
}

/// What a bar holds.
pub(in crate::console) fn bar(name: &str, range: &str, ticks: &str, share: &str) -> String {
    format!("{name}: {range}\n{ticks} ticks, {share}")
}

/// A histogram in one sentence.
pub(in crate::console) fn histogram(name: &str, late: &str, total: &str, deadline_us: f64) -> String {
    format!("{name} histogram: {late} of {total} ticks later than the deadline of {deadline_us:.0} us")
}

/// Under the line of the deadline.
pub(in crate::console) fn deadline(deadline_us: f64) -> String {
    format!("deadline {deadline_us:.0} us")
}

/// What the height of a histogram means.
pub(in crate::console) fn log_scale(top: &str) -> String {
    format!("log scale, top {top}")
}

/// Missed periods, over the strip.
pub(in crate::console) fn missed(minutes: usize, count: &str) -> String {
    format!("Missed in the last {minutes} min: {count}")
}

/// The name of the strip.
pub(in crate::console) fn missed_periods(words: &str) -> String {
    format!("{words} periods")
}

/// A bar of the strip.
pub(in crate::console) fn missed_at(age_s: usize, count: &str) -> String {
    format!("{age_s} s ago: {count} periods missed")
}
