//! The calibration panel: what is calibrated, how well, and the buttons that open the wizards.

use nima_machine::messages::LoopState;
use nima_recording::store::WristId;

use crate::language::{Text, told, word};

pub(in crate::console) const NOT_OF_A_SENSOR: Text =
    Text::of("these numbers belong into the rig file", "these numbers belong into the rig file");
pub(in crate::console) const SETS_IDLE: Text =
    Text::of("The check and the wizards set the loop to idle", "The check and the wizards set the loop to idle");
pub(in crate::console) const IS_OPEN: Text = Text::of("Already open", "Already open");
pub(in crate::console) const CLOSE_WIZARD: Text = Text::of("Back to the monitor", "Back to the monitor");
pub(in crate::console) const CLOSE_WIZARD_HOVER: Text = Text::of(
    "The data recorded so far are kept until the wizard is opened again",
    "The data recorded so far are kept until the wizard is opened again",
);
pub(in crate::console) const GRAVITY: Text = Text::of("Gravity", "Gravity");
pub(in crate::console) const CORRESPONDENCE: Text = Text::of("Correspondence", "Correspondence");
pub(in crate::console) const TIP_FORCE: Text = Text::of("Tip force", "Tip force");
pub(in crate::console) const NO_FOLDER: Text = Text::of(
    "no folder for calibration files was found; set NIMA_DATA_DIR",
    "no folder for calibration files was found; set NIMA_DATA_DIR",
);
pub(in crate::console) const NOT_NEEDED: Text = Text::of(
    "This scene measures the force at the tip, so it needs no calibration",
    "This scene measures the force at the tip, so it needs no calibration",
);
pub(in crate::console) const GRAVITY_NONE: Text = Text::of("Gravity: not calibrated", "Gravity: not calibrated");
pub(in crate::console) const CORRESPONDENCE_NONE: Text =
    Text::of("Correspondence: not calibrated", "Correspondence: not calibrated");
pub(in crate::console) const TIP_FORCE_NONE: Text = Text::of("Tip force: not calibrated", "Tip force: not calibrated");
pub(in crate::console) const TIP_FORCE_UNCHECKED: Text =
    Text::of("Tip force: trained but not checked", "Tip force: trained but not checked");
pub(in crate::console) const REMARK_FUTURE_DATE: Text = Text::of(
    "; dated in the future, check this computer's clock",
    "; dated in the future, check this computer's clock",
);
pub(in crate::console) const SENSOR_NOT_CONNECTED: Text = Text::of(
    "The wrist sensor is not connected: its serial number decides which calibrations are in force",
    "The wrist sensor is not connected: its serial number decides which calibrations are in force",
);
pub(in crate::console) const SENSOR_WITHOUT_SERIAL: Text = Text::of(
    "The wrist sensor gave no serial number, so no calibration can belong to it: connect it again",
    "The wrist sensor gave no serial number, so no calibration can belong to it: connect it again",
);
pub(in crate::console) const RIG_WITHOUT_SENSOR: Text = Text::of(
    "The rig file names no wrist sensor for this arm: add serial_number and tool to its [simulated] part",
    "The rig file names no wrist sensor for this arm: add serial_number and tool to its [simulated] part",
);
pub(in crate::console) const NO_SENSOR_TO_SAVE_FOR: Text = Text::of(
    "the serial number of the wrist sensor is not known; save again once the sensor is connected",
    "the serial number of the wrist sensor is not known; save again once the sensor is connected",
);
pub(in crate::console) const ARM_TO_CALIBRATE: Text = Text::of(
    "The wizards calibrate the wrist sensor of this arm",
    "The wizards calibrate the wrist sensor of this arm",
);

/// Why nothing that sets the loop to idle can be opened in this state, and what to do; `None` where it can.
pub(in crate::console) fn closed(state: LoopState) -> Option<&'static str> {
    match state {
        LoopState::Idle | LoopState::Engaged => None,
        LoopState::Stopped | LoopState::Faulted(_) => {
            Some(word("The loop is stopped: press Release stop", "The loop is stopped: press Release stop"))
        }
        LoopState::Disconnected => {
            Some(word("A device is missing: see the panel Devices", "A device is missing: see the panel Devices"))
        }
        LoopState::Ready => {
            Some(word("About to engage: align hand and tip, or Stop", "About to engage: align hand and tip, or Stop"))
        }
        LoopState::Clutched => {
            Some(word("The clutch is pressed: let the pedal go", "The clutch is pressed: let the pedal go"))
        }
    }
}

/// Button that opens a wizard; the wizard's name is in lower case.
pub(in crate::console) fn calibrate(wizard: &str) -> String {
    told!("Calibrate {wizard}…", "Calibrate {wizard}…")
}

/// Hover text of that button.
pub(in crate::console) fn opens(meaning: &str) -> String {
    told!("{meaning}\nThe loop is set to idle", "{meaning}\nThe loop is set to idle")
}

/// Source of the force at the tip.
pub(in crate::console) fn source(words: &str) -> String {
    told!("Tip force: {words}", "Tip force: {words}")
}

/// Name of an arm.
pub(in crate::console) fn arm(side: &str) -> String {
    told!("{side} arm", "{side} arm")
}

/// Sensor and tool of the calibrations.
pub(in crate::console) fn bound_to(sensor: &str, tool: &str) -> String {
    told!("Sensor {sensor}, {tool}", "Sensor {sensor}, {tool}")
}

/// This sensor has no gravity calibration, but others have one with the same tool.
pub(in crate::console) fn other_sensors_are_calibrated(sensor: &str, tool: &str, others: &str) -> String {
    told!(
        "Sensor {sensor} has no gravity calibration with {tool}; sensor {others} has one: connect that sensor, or \
         calibrate this one.",
        "Sensor {sensor} has no gravity calibration with {tool}; sensor {others} has one: connect that sensor, or \
         calibrate this one."
    )
}

/// Each sensor is calibrated with the tool of the other arm.
pub(in crate::console) fn sensors_are_exchanged(right: &WristId, left: &WristId) -> String {
    told!(
        "The right and the left sensor, or their tools in the rig file, are exchanged: {} is calibrated with {}, and \
         {} with {}: exchange the cables, or press Exchange Sensors in the panel Devices.",
        "The right and the left sensor, or their tools in the rig file, are exchanged: {} is calibrated with {}, and \
         {} with {}: exchange the cables, or press Exchange Sensors in the panel Devices.",
        right.serial_number,
        left.tool,
        left.serial_number,
        right.tool
    )
}

/// A file that cannot be used.
pub(in crate::console) fn not_in_force(what: &str, why: &str) -> String {
    told!("{what}: the saved calibration is not used: {why}", "{what}: the saved calibration is not used: {why}")
}

/// A calibration was saved to this file.
pub(in crate::console) fn saved(path: &std::path::Path) -> String {
    told!("Saved and in use: {}", "Saved and in use: {}", path.display())
}

/// The gravity calibration in one line.
pub(in crate::console) fn gravity(day: &str, poses: usize, error_n: f64, remarks: &str) -> String {
    told!(
        "Gravity: {day}, {poses} poses, held-out error {error_n:.3} N{remarks}",
        "Gravity: {day}, {poses} poses, held-out error {error_n:.3} N{remarks}"
    )
}

/// Result of the check of the bias.
pub(in crate::console) fn bias_checked(found_at: &str, words: &str) -> String {
    told!("Bias, checked at {found_at} UTC: {words}", "Bias, checked at {found_at} UTC: {words}")
}

/// State of the bias before its check has finished.
pub(in crate::console) fn bias(words: &str) -> String {
    told!("Bias: {words}", "Bias: {words}")
}

/// The correspondence in one line.
pub(in crate::console) fn correspondence(
    day: &str,
    pairs: usize,
    error_n: f64,
    known_to_deg: f64,
    remarks: &str,
) -> String {
    told!(
        "Correspondence: {day}, {pairs} pushes, held-out error {error_n:.3} N, uncertainty {known_to_deg:.2} \
         deg{remarks}",
        "Correspondence: {day}, {pairs} pushes, held-out error {error_n:.3} N, uncertainty {known_to_deg:.2} \
         deg{remarks}"
    )
}

/// The tip-force network in one line.
pub(in crate::console) fn tip_force(day: &str, rows: usize, error_n: f64, remarks: &str) -> String {
    told!(
        "Tip force: {day}, {rows} rows, error on new data {error_n:.3} N{remarks}",
        "Tip force: {day}, {rows} rows, error on new data {error_n:.3} N{remarks}"
    )
}

/// Remark: the calibration is old.
pub(in crate::console) fn days_old(days: u64) -> String {
    told!("; {days} days old, calibrate again", "; {days} days old, calibrate again")
}

/// Remark: its verdict was overridden by this person.
pub(in crate::console) fn not_proven(name: &str) -> String {
    told!("; NOT PROVEN, kept by {name}", "; NOT PROVEN, kept by {name}")
}

/// A wizard could not be opened.
pub(in crate::console) fn not_opened(reason: &str) -> String {
    told!("Not opened: {reason}", "Not opened: {reason}")
}

/// The previous scene could not be restored after a wizard.
pub(in crate::console) fn still_in_the_experiment(reason: &str) -> String {
    told!("Could not return to the monitor: {reason}", "Could not return to the monitor: {reason}")
}

/// Saved, but the running loop does not use it yet.
pub(in crate::console) fn in_force_with_next_start(saved: &str, reason: &str) -> String {
    told!(
        "{saved}. It is used from the next start on: {reason}",
        "{saved}. It is used from the next start on: {reason}"
    )
}

/// Could not be saved.
pub(in crate::console) fn not_saved(reason: &str) -> String {
    told!("Not saved: {reason}", "Not saved: {reason}")
}

/// The loop has ended and could not be restarted.
pub(in crate::console) fn not_started_again(error: &impl std::fmt::Display) -> String {
    told!("the control loop could not be restarted: {error}", "the control loop could not be restarted: {error}")
}
