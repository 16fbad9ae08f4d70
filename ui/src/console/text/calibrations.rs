//! The calibration panel: what is calibrated, how well, and the buttons that open the wizards.

use nima_machine::messages::LoopState;
use nima_recording::store::WristId;

pub(in crate::console) const NOT_OF_A_SENSOR: &str = "these numbers belong into the rig file";
pub(in crate::console) const SETS_IDLE: &str = "The check and the wizards set the loop to idle";
pub(in crate::console) const IS_OPEN: &str = "Already open";
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
pub(in crate::console) const SENSOR_NOT_CONNECTED: &str =
    "The wrist sensor is not connected: its serial number decides which calibrations are in force";
pub(in crate::console) const SENSOR_WITHOUT_SERIAL: &str =
    "The wrist sensor gave no serial number, so no calibration can belong to it: connect it again";
pub(in crate::console) const RIG_WITHOUT_SENSOR: &str =
    "The rig file names no wrist sensor for this arm: add serial_number and tool to its [simulated] part";
pub(in crate::console) const NO_SENSOR_TO_SAVE_FOR: &str =
    "the serial number of the wrist sensor is not known; save again once the sensor is connected";
pub(in crate::console) const ARM_TO_CALIBRATE: &str = "The wizards calibrate the wrist sensor of this arm";

/// Why nothing that sets the loop to idle can be opened in this state, and what to do; `None` where it can.
pub(in crate::console) const fn closed(state: LoopState) -> Option<&'static str> {
    match state {
        LoopState::Idle | LoopState::Engaged => None,
        LoopState::Stopped | LoopState::Faulted(_) => Some("The loop is stopped: press Release stop"),
        LoopState::Disconnected => Some("A device is missing: see the panel Devices"),
        LoopState::Ready => Some("About to engage: align hand and tip, or Stop"),
        LoopState::Clutched => Some("The clutch is pressed: let the pedal go"),
    }
}

/// Button that opens a wizard; the wizard's name is in lower case.
pub(in crate::console) fn calibrate(wizard: &str) -> String {
    format!("Calibrate {wizard}…")
}

/// Hover text of that button.
pub(in crate::console) fn opens(meaning: &str) -> String {
    format!("{meaning}\nThe loop is set to idle")
}

/// Source of the force at the tip.
pub(in crate::console) fn source(words: &str) -> String {
    format!("Tip force: {words}")
}

/// Name of an arm.
pub(in crate::console) fn arm(side: &str) -> String {
    format!("{side} arm")
}

/// Sensor and tool of the calibrations.
pub(in crate::console) fn bound_to(sensor: &str, tool: &str) -> String {
    format!("Sensor {sensor}, {tool}")
}

/// This sensor has no gravity calibration, but others have one with the same tool.
pub(in crate::console) fn other_sensors_are_calibrated(sensor: &str, tool: &str, others: &str) -> String {
    format!(
        "Sensor {sensor} has no gravity calibration with {tool}; sensor {others} has one: connect that sensor, or calibrate this one."
    )
}

/// Each sensor is calibrated with the tool of the other arm.
pub(in crate::console) fn sensors_are_exchanged(right: &WristId, left: &WristId) -> String {
    format!(
        "The right and the left sensor, or their tools in the rig file, are exchanged: {} is calibrated with {}, and {} with {}: exchange the cables, or press Exchange Sensors in the panel Devices.",
        right.serial_number, left.tool, left.serial_number, right.tool
    )
}

/// A file that cannot be used.
pub(in crate::console) fn not_in_force(what: &str, why: &str) -> String {
    format!("{what}: the saved calibration is not used: {why}")
}

/// A calibration was saved to this file.
pub(in crate::console) fn saved(path: &std::path::Path) -> String {
    format!("Saved and in use: {}", path.display())
}

/// The gravity calibration in one line.
pub(in crate::console) fn gravity(day: &str, poses: usize, error_n: f64, remarks: &str) -> String {
    format!("Gravity: {day}, {poses} poses, held-out error {error_n:.3} N{remarks}")
}

/// Result of the check of the bias.
pub(in crate::console) fn bias_checked(found_at: &str, words: &str) -> String {
    format!("Bias, checked at {found_at} UTC: {words}")
}

/// State of the bias before its check has finished.
pub(in crate::console) fn bias(words: &str) -> String {
    format!("Bias: {words}")
}

/// The correspondence in one line.
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

/// The tip-force network in one line.
pub(in crate::console) fn tip_force(day: &str, rows: usize, error_n: f64, remarks: &str) -> String {
    format!("Tip force: {day}, {rows} rows, error on new data {error_n:.3} N{remarks}")
}

/// Remark: the calibration is old.
pub(in crate::console) fn days_old(days: u64) -> String {
    format!("; {days} days old, calibrate again")
}

/// Remark: its verdict was overridden by this person.
pub(in crate::console) fn not_proven(name: &str) -> String {
    format!("; NOT PROVEN, kept by {name}")
}

/// A wizard could not be opened.
pub(in crate::console) fn not_opened(reason: &str) -> String {
    format!("Not opened: {reason}")
}

/// The previous scene could not be restored after a wizard.
pub(in crate::console) fn still_in_the_experiment(reason: &str) -> String {
    format!("Could not return to the monitor: {reason}")
}

/// Saved, but the running loop does not use it yet.
pub(in crate::console) fn in_force_with_next_start(saved: &str, reason: &str) -> String {
    format!("{saved}. It is used from the next start on: {reason}")
}

/// Could not be saved.
pub(in crate::console) fn not_saved(reason: &str) -> String {
    format!("Not saved: {reason}")
}

/// The loop has ended and could not be restarted.
pub(in crate::console) fn not_started_again(error: &impl std::fmt::Display) -> String {
    format!("the control loop could not be restarted: {error}")
}
