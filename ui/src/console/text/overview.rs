//! The page that lists all calibrations of the rig.

pub(in crate::console) const TITLE: &str = "All calibrations";
pub(in crate::console) const MEANING: &str =
    "Of every arm: when each was made, its verdict, what has changed since then, and a button that makes it";
pub(in crate::console) const OPEN: &str = "All calibrations…";
pub(in crate::console) const CALIBRATION: &str = "Calibration";
pub(in crate::console) const MADE: &str = "Made";
pub(in crate::console) const VERDICT: &str = "Verdict";
pub(in crate::console) const SINCE: &str = "Since then";
pub(in crate::console) const MAKE: &str = "Calibrate";
pub(in crate::console) const REDO: &str = "Redo";
pub(in crate::console) const NEVER: &str = "not calibrated";
pub(in crate::console) const NOT_WATCHED: &str = "not watched";
pub(in crate::console) const FOR_TRAINING_ONLY: &str = "used for training only";
pub(in crate::console) const NOT_USED: &str = "used for less than 10 s since the start";
pub(in crate::console) const IN_FILE: &str = "in the rig file";
pub(in crate::console) const OTHER_IN_FILE: &str = "the rig file has other values now";
pub(in crate::console) const UNCHECKED: &str = "trained but not checked";
pub(in crate::console) const HANDLE: &str = "View, handle";
pub(in crate::console) const FUTURE: &str = "in the future";

/// Accessible name of a button that makes a calibration.
pub(in crate::console) fn button(verb: &str, arm: &str, calibration: &str) -> String {
    format!("{verb} {arm} arm, {calibration}")
}

/// Sensor and tool above an arm's lines.
pub(in crate::console) fn of_arm(arm: &str, sensor: &str, tool: &str) -> String {
    format!("{arm} arm: sensor {sensor}, {tool}")
}

/// An arm whose sensor has not told who it is.
pub(in crate::console) fn of_unknown(arm: &str, why: &str) -> String {
    format!("{arm} arm: {why}")
}

/// When it was made.
pub(in crate::console) fn made(day: &str, age: &str) -> String {
    format!("{day}, {age}")
}

/// Age in days.
pub(in crate::console) fn days(days: u64) -> String {
    match days {
        0 => "less than a day old".to_owned(),
        1 => "1 day old".to_owned(),
        _ => format!("{days} days old"),
    }
}

/// A verdict with the error on held-out data.
pub(in crate::console) fn verdict(verdict: &str, error: &str) -> String {
    if error.is_empty() { verdict.to_owned() } else { format!("{verdict}, held-out error {error}") }
}

/// A verdict that somebody has overridden.
pub(in crate::console) fn overridden(verdict: &str, name: &str) -> String {
    format!("{verdict}, kept by {name}")
}

/// What the last ready check has found.
pub(in crate::console) fn checked(day: &str, found: &str) -> String {
    format!("ready check of {day}: {found}")
}

/// How much of the time with force a network was outside its training data, as shares; what to do if that is much.
pub(in crate::console) fn in_use(outside: f64, without: f64) -> String {
    let shares =
        format!("outside its training {:.0} % of the time, not used {:.0} %", 100.0 * outside, 100.0 * without);
    let much = without >= 0.02 || outside >= 0.3;
    if much { format!("{shares}: record more where you work") } else { shares }
}

/// A force.
pub(in crate::console) fn newton(newton: f64) -> String {
    format!("{newton:.3} N")
}

/// A value with its limit.
pub(in crate::console) fn within(value: f64, limit: f64, unit: &str) -> String {
    format!("{value:.2} {unit}, limit {limit:.2}")
}
