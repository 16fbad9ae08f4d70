//! The panel that compares the prediction errors of the modes.

use crate::language::{Text, told};

pub(in crate::console) const LAST_3_MIN: Text = Text::of("last 3 min", "last 3 min");
pub(in crate::console) const REFERENCE: Text = Text::of("reference", "reference");
pub(in crate::console) const COMPARE: Text = Text::of("Compare all modes", "Compare all modes");
pub(in crate::console) const COMPARE_HOVER: Text = Text::of(
    "Compute every mode on the same samples and show its error. Otherwise only the mode in use is computed, which \
    takes less time. The force in the hand does not change.",
    "Compute every mode on the same samples and show its error. Otherwise only the mode in use is computed, which \
    takes less time. The force in the hand does not change.",
);
pub(in crate::console) const IN_USE: Text = Text::of(" (in use)", " (in use)");

/// The prediction horizon, and the meaning of the line in the bars.
pub(in crate::console) fn ahead(delay_ms: f64) -> String {
    told!(
        "Mean error {delay_ms:.0} ms ahead, last seconds; line: delayed DFR",
        "Mean error {delay_ms:.0} ms ahead, last seconds; line: delayed DFR"
    )
}

/// Mean errors of the two curves of the trend (N).
pub(in crate::console) fn trend(seconds: usize, mode: &str, error_n: &str, dfr_n: &str) -> String {
    told!(
        "Last {seconds} s: {mode} {error_n} N, delayed DFR {dfr_n} N",
        "Last {seconds} s: {mode} {error_n} N, delayed DFR {dfr_n} N"
    )
}

/// The name of the trend.
pub(in crate::console) fn trend_name(trend: &str) -> String {
    told!("Error over the last minutes. {trend}", "Error over the last minutes. {trend}")
}

/// The meaning of the trend.
pub(in crate::console) fn trend_meaning(trend: &str) -> String {
    told!(
        "{trend}\nMean prediction error (N) of each second, for up to three minutes",
        "{trend}\nMean prediction error (N) of each second, for up to three minutes"
    )
}

/// Accessible name of a bar.
pub(in crate::console) fn error(words: &str) -> String {
    told!("Error {words}", "Error {words}")
}
