//! Words of the room `calibrations`.

pub(in crate::console) const ALREADY_OPEN_OR_THE: &str = "Already open, or the loop has stopped: release it first.";
pub(in crate::console) const BACK_TO_THE_MONITOR: &str = "Back to the monitor";
pub(in crate::console) const WHAT_THE_WIZARD_HAS: &str =
    "What the wizard has taken is kept for when it is opened again.";
pub(in crate::console) const GRAVITY: &str = "Gravity";
pub(in crate::console) const CORRESPONDENCE: &str = "Correspondence";
pub(in crate::console) const TIP_FORCE: &str = "Tip force";
pub(in crate::console) const NO_FOLDER_FOR_CALIBRATIONS: &str =
    "no folder for calibrations is known; set NIMA_DATA_DIR";
pub(in crate::console) const THIS_SCENE_MEASURES_AT: &str =
    "This scene measures at the tip; a wrist sensor needs calibrations.";
pub(in crate::console) const GRAVITY_NONE: &str = "Gravity: none";
pub(in crate::console) const CORRESPONDENCE_NONE: &str = "Correspondence: none";
pub(in crate::console) const TIP_FORCE_NONE: &str = "Tip force: none";
pub(in crate::console) const TIP_FORCE_NEVER_CHECKED: &str = "Tip force: never checked";
pub(in crate::console) const MADE_IN_THE_FUTURE: &str = "; made in the future, check the clock";
pub(in crate::console) const LOOP_HAS_STOPPED: &str = "the loop has stopped; release it first";

/// The way to a wizard, whose name begins small.
pub(in crate::console) fn calibrate(wizard: &str) -> String {
    format!("Calibrate {wizard}...")
}

/// What the way to a wizard does.
pub(in crate::console) fn opens(meaning: &str) -> String {
    format!("{meaning} The loop is set to idle.")
}

/// Where the force at the tip comes from.
pub(in crate::console) fn source(words: &str) -> String {
    format!("Tip force: {words}")
}

/// What the calibrations belong to.
pub(in crate::console) fn bound_to(sensor: &str, tool: &str) -> String {
    format!("Sensor {sensor}, {tool}")
}

/// A file cannot be used.
pub(in crate::console) fn not_in_force(what: &str, why: &str) -> String {
    format!("{what} is not in force: {why}")
}

/// A record was kept in this file.
pub(in crate::console) fn saved(path: &std::path::Path) -> String {
    format!("Saved and in force: {}.", path.display())
}

/// Gravity, in one line.
pub(in crate::console) fn gravity(day: &str, poses: usize, error_n: f64, remarks: &str) -> String {
    format!("Gravity: {day}, {poses} poses, held-out error {error_n:.3} N{remarks}")
}

/// The bias, once it was looked at.
pub(in crate::console) fn bias_checked(found_at: &str, words: &str) -> String {
    format!("Bias, checked {found_at} UTC: {words}")
}

/// The bias before that.
pub(in crate::console) fn bias(words: &str) -> String {
    format!("Bias: {words}")
}

/// Correspondence, in one line.
pub(in crate::console) fn correspondence(
    day: &str,
    pairs: usize,
    error_n: f64,
    known_to_deg: f64,
    remarks: &str,
) -> String {
    format!(
        "Correspondence: {day}, {pairs} pushes, held-out error {error_n:.3} N, known to {known_to_deg:.2} deg{remarks}"
    )
}

/// Tip force, in one line.
pub(in crate::console) fn tip_force(day: &str, rows: usize, error_n: f64, remarks: &str) -> String {
    format!("Tip force: {day}, {rows} rows, error on new data {error_n:.3} N{remarks}")
}

/// A remark: it is old.
pub(in crate::console) fn days_old(days: u64) -> String {
    format!("; {days} days old, repeat it")
}

/// A remark: somebody kept it in spite of the verdict.
pub(in crate::console) fn not_proven(name: &str) -> String {
    format!("; NOT PROVEN, kept by {name}")
}

/// A wizard was not opened.
pub(in crate::console) fn not_opened(reason: &str) -> String {
    format!("Not opened: {reason}.")
}

/// There was no way back from a wizard.
pub(in crate::console) fn still_in_the_experiment(reason: &str) -> String {
    format!("Still in the experiment: {reason}.")
}

/// Kept, but the loop goes on without it.
pub(in crate::console) fn in_force_with_next_start(saved: &str, reason: &str) -> String {
    format!("{saved} It comes into force with the next start: {reason}.")
}

/// Not kept.
pub(in crate::console) fn not_saved(reason: &str) -> String {
    format!("Not saved: {reason}")
}

/// The loop has ended and does not begin again.
pub(in crate::console) fn not_started_again(error: &impl std::fmt::Display) -> String {
    format!("the loop could not be started again: {error}")
}
