//! The calibration panel: what is calibrated, how well, and the ways into the wizards.

pub(in crate::console) const OPEN_DISABLED_HOVER: &str =
    "Already open, or the loop is stopped: press Release stop first";
pub(in crate::console) const CLOSE_WIZARD: &str = "Back to the monitor";
pub(in crate::console) const CLOSE_WIZARD_HOVER: &str =
    "The data recorded so far are kept until the wizard is opened again";
pub(in crate::console) const GRAVITY: &str = "Gravity";
pub(in crate::console) const CORRESPONDENCE: &str = "Correspondence";
pub(in crate::console) const TIP_FORCE: &str = "Tip force";
pub(in crate::console) const NO_FOLDER: &str = "no folder for calibration files was found; set NIMA_DATA_DIR";
pub(in crate::console) const NOT_NEEDED: &str = "This scene measures the force at the tip, so it needs no calibration";
pub(in crate::console) const GRAVITY_NONE: &str = "Gravity: not calibrated";
pub(in crate::console) const CORRESPONDENCE_NONE: &str = "Correspondence: not calibrated";
pub(in crate::console) const TIP_FORCE_NONE: &str = "Tip force: not calibrated";
pub(in crate::console) const TIP_FORCE_UNCHECKED: &str = "Tip force: trained but not checked";
pub(in crate::console) const REMARK_FUTURE_DATE: &str = "; dated in the future, check this computer's clock";
pub(in crate::console) const LOOP_STOPPED: &str = "the loop is stopped; press Release stop first";
pub(in crate::console) const SENSOR_NOT_CONNECTED: &str =
    "The wrist sensor is not connected: its serial number decides which calibrations are in force";
pub(in crate::console) const SENSOR_WITHOUT_SERIAL: &str =
    "The wrist sensor gave no serial number, so no calibration can belong to it: connect it again";
pub(in crate::console) const RIG_WITHOUT_SENSOR: &str =
    "The rig file names no wrist sensor for this arm: add serial_number and tool to its [simulated] part";
pub(in crate::console) const NO_SENSOR_TO_SAVE_FOR: &str =
    "the serial number of the wrist sensor is not known; see the devices";
pub(in crate::console) const ARM_TO_CALIBRATE: &str = "The wizards calibrate the wrist sensor of this arm";

/// The way to a wizard, whose name begins small.
pub(in crate::console) fn calibrate(wizard: &str) -> String {
    format!("Calibrate {wizard}…")
}

/// What the way to a wizard does.
pub(in crate::console) fn opens(meaning: &str) -> String {
    format!("{meaning}\nThe loop is set to idle")
}

/// Where the force at the tip comes from.
pub(in crate::console) fn source(words: &str) -> String {
    format!("Tip force: {words}")
}

/// An arm, by its side.
pub(in crate::console) fn arm(side: &str) -> String {
    format!("{side} arm")
}

/// What the calibrations belong to.
pub(in crate::console) fn bound_to(sensor: &str, tool: &str) -> String {
    format!("Sensor {sensor}, {tool}")
}

/// This sensor has no gravity calibration, and others have one with the same tool.
pub(in crate::console) fn other_sensors_are_calibrated(sensor: &str, tool: &str, others: &str) -> String {
    format!(
        "Sensor {sensor} has no gravity calibration with {tool}; sensor {others} has one: connect that sensor, or calibrate this one."
    )
}

/// A file cannot be used.
pub(in crate::console) fn not_in_force(what: &str, why: &str) -> String {
    format!("{what}: the saved calibration is not used: {why}")
}

/// A record was kept in this file.
pub(in crate::console) fn saved(path: &std::path::Path) -> String {
    format!("Saved and in use: {}", path.display())
}

/// Gravity, in one line.
pub(in crate::console) fn gravity(day: &str, poses: usize, error_n: f64, remarks: &str) -> String {
    format!("Gravity: {day}, {poses} poses, held-out error {error_n:.3} N{remarks}")
}

/// The bias, once it was looked at.
pub(in crate::console) fn bias_checked(found_at: &str, words: &str) -> String {
    format!("Bias, checked at {found_at} UTC: {words}")
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
        "Correspondence: {day}, {pairs} pushes, held-out error {error_n:.3} N, uncertainty {known_to_deg:.2} deg{remarks}"
    )
}

/// Tip force, in one line.
pub(in crate::console) fn tip_force(day: &str, rows: usize, error_n: f64, remarks: &str) -> String {
    format!("Tip force: {day}, {rows} rows, error on new data {error_n:.3} N{remarks}")
}

/// A remark: it is old.
pub(in crate::console) fn days_old(days: u64) -> String {
    format!("; {days} days old, calibrate again")
}

/// A remark: somebody kept it in spite of the verdict.
pub(in crate::console) fn not_proven(name: &str) -> String {
    format!("; NOT PROVEN, kept by {name}")
}

/// A wizard was not opened.
pub(in crate::console) fn not_opened(reason: &str) -> String {
    format!("Not opened: {reason}")
}

/// There was no way back from a wizard.
pub(in crate::console) fn still_in_the_experiment(reason: &str) -> String {
    format!("Could not return to the monitor: {reason}")
}

/// Kept, but the loop goes on without it.
pub(in crate::console) fn in_force_with_next_start(saved: &str, reason: &str) -> String {
    format!("{saved}. It is used from the next start on: {reason}")
}

/// Not kept.
pub(in crate::console) fn not_saved(reason: &str) -> String {
    format!("Not saved: {reason}")
}

/// The loop has ended and does not begin again.
pub(in crate::console) fn not_started_again(error: &impl std::fmt::Display) -> String {
    format!("the control loop could not be restarted: {error}")
}
