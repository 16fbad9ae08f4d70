//! The panel that measures computing time against accuracy.

use crate::language::{Text, told};

pub(in crate::console) const CANCELLED: Text =
    Text::of("Cancelled. The earlier results were kept.", "Cancelled. The earlier results were kept.");
pub(in crate::console) const FAILED: Text =
    Text::of("The measurement failed. Try again.", "The measurement failed. Try again.");
pub(in crate::console) const NOT_MEASURED: Text = Text::of(
    "Not measured yet. It takes a few seconds while the loop keeps running.",
    "Not measured yet. It takes a few seconds while the loop keeps running.",
);
pub(in crate::console) const MEASURE_HOVER: Text = Text::of(
    "Runs every combination of mode, degree and window on six seconds of this scene, in a background \
    thread without real-time priority. Other work on this computer makes the times longer and their p99 \
    uncertain.",
    "Runs every combination of mode, degree and window on six seconds of this scene, in a background \
    thread without real-time priority. Other work on this computer makes the times longer and their p99 \
    uncertain.",
);
pub(in crate::console) const MEASURE: Text = Text::of("Measure on this machine…", "Measure on this machine…");
pub(in crate::console) const CANCEL: Text = Text::of("Cancel", "Cancel");
pub(in crate::console) const CANCEL_HOVER: Text =
    Text::of("Stops measuring at once; earlier results are kept", "Stops measuring at once; earlier results are kept");
pub(in crate::console) const FRONT: Text = Text::of("Best choices, cheapest first:", "Best choices, cheapest first:");
pub(in crate::console) const FRONT_HOVER: Text = Text::of(
    "The Pareto front: every other choice takes more time or has a larger error. Only NIMA and \
    literal have a degree, and these two and linear a window.",
    "The Pareto front: every other choice takes more time or has a larger error. Only NIMA and \
    literal have a degree, and these two and linear a window.",
);
pub(in crate::console) const APPLY: Text = Text::of("Apply", "Apply");
pub(in crate::console) const APPLY_BY_RESTART: Text = Text::of(
    "Degree or window differ from those in use: the loop restarts and is then idle, without force. Press \
    Engage when you are ready.",
    "Degree or window differ from those in use: the loop restarts and is then idle, without force. Press \
    Engage when you are ready.",
);
pub(in crate::console) const APPLY_AT_ONCE: Text =
    Text::of("Applied to the running loop at once", "Applied to the running loop at once");
pub(in crate::console) const ON_FRONT: Text = Text::of(
    "\nNo other choice is both faster and more accurate",
    "\nNo other choice is both faster and more accurate",
);
pub(in crate::console) const TIME_AXIS: Text = Text::of("One tick (µs)", "One tick (µs)");
pub(in crate::console) const APPLIED_BY_RESTART: Text = Text::of(
    "Applied. The loop was restarted and is idle: press Engage when you are ready.",
    "Applied. The loop was restarted and is idle: press Engage when you are ready.",
);

/// The background thread could not be started.
pub(in crate::console) fn not_started(error: &impl std::fmt::Display) -> String {
    told!("The measurement could not be started: {error}", "The measurement could not be started: {error}")
}

/// Progress of the measurement.
pub(in crate::console) fn measured(percent: f32) -> String {
    told!("Trade-off measured: {percent:.0} %", "Trade-off measured: {percent:.0} %")
}

/// The loop now uses this choice.
pub(in crate::console) fn applied(choice: &str) -> String {
    told!("Applied: {choice}", "Applied: {choice}")
}

/// The loop could not be restarted with the choice.
pub(in crate::console) fn not_applied(reason: &str) -> String {
    told!("Not applied: {reason}", "Not applied: {reason}")
}

/// All figures of a point.
pub(in crate::console) fn point(
    name: &str,
    [median_us, p99_us]: [&str; 2],
    delay_ms: f64,
    [error_n, ratio]: [&str; 2],
) -> String {
    told!(
        "{name}\none tick: median {median_us} µs, p99 {p99_us} µs\nmean error at {delay_ms:.0} ms: {error_n} N, \
         {ratio} x delayed DFR",
        "{name}\none tick: median {median_us} µs, p99 {p99_us} µs\nmean error at {delay_ms:.0} ms: {error_n} N, \
         {ratio} x delayed DFR"
    )
}

/// Title of the error axis.
pub(in crate::console) fn error_axis(unit: &str) -> String {
    told!("Mean error ({unit})", "Mean error ({unit})")
}

/// The plot in one sentence.
pub(in crate::console) fn plot(points: usize) -> String {
    told!(
        "Trade-off plot: {points} points, time of a tick against prediction error",
        "Trade-off plot: {points} points, time of a tick against prediction error"
    )
}
