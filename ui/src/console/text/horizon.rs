//! The panel that compares the prediction errors of the modes.

pub(in crate::console) const LAST_3_MIN: &str = "last 3 min";
pub(in crate::console) const REFERENCE: &str = "reference";
pub(in crate::console) const COMPARE: &str = "Compare all modes";
pub(in crate::console) const COMPARE_HOVER: &str = "Compute every mode on the same samples and show its error. Otherwise only the mode in use is computed, which \
    takes less time. The force in the hand does not change.";
pub(in crate::console) const IN_USE: &str = " (in use)";

/// The prediction horizon, and the meaning of the line in the bars.
pub(in crate::console) fn ahead(delay_ms: f64) -> String {
    format!("Mean error {delay_ms:.0} ms ahead, last seconds; line: delayed DFR")
}

/// Mean errors of the two curves of the trend (N).
pub(in crate::console) fn trend(seconds: usize, mode: &str, error_n: &str, dfr_n: &str) -> String {
    format!("Last {seconds} s: {mode} {error_n} N, delayed DFR {dfr_n} N")
}

/// The name of the trend.
pub(in crate::console) fn trend_name(trend: &str) -> String {
    format!("Error over the last minutes. {trend}")
}

/// The meaning of the trend.
pub(in crate::console) fn trend_meaning(trend: &str) -> String {
    format!("{trend}\nMean prediction error (N) of each second, for up to three minutes")
}

/// Accessible name of a bar.
pub(in crate::console) fn error(words: &str) -> String {
    format!("Error {words}")
}
