//! Texts that all calibration wizards share.

pub(in crate::console) const LAST_STEP: &str = "This is the last step";
pub(in crate::console) const NEEDS_CHECKS: &str = "A check has not passed yet";
pub(in crate::console) const OPTIONS_HOVER: &str =
    "Leave both off unless you know that your rig needs them, or the result says so";
pub(in crate::console) const OPTIONS_TITLE: &str = "How this rig is built";
pub(in crate::console) const SO_FAR: &str = "So far";
pub(in crate::console) const STEP_CHECK: &str = "Check";
pub(in crate::console) const STEP_RESULT: &str = "Result";
pub(in crate::console) const STEP_SAVE: &str = "Save";
pub(in crate::console) const STEP_SAVE_HOVER: &str = "Saves the result for this sensor and this tool, with its errors";
pub(in crate::console) const GRAVITY: &str = "Gravity";
pub(in crate::console) const CORRESPONDENCE: &str = "Correspondence";
pub(in crate::console) const TIP_FORCE: &str = "Tip force";
pub(in crate::console) const GRAVITY_MEANING: &str =
    "Removes the tool's weight and the sensor's bias from the wrist force";
pub(in crate::console) const CORRESPONDENCE_MEANING: &str =
    "Finds the rotation between the sensor under the tissue and the sensor at the wrist";
pub(in crate::console) const TIP_FORCE_MEANING: &str =
    "Trains a network to remove the trocar's friction from the wrist force";
pub(in crate::console) const BACK: &str = "Back";
pub(in crate::console) const NEXT: &str = "Next";
pub(in crate::console) const START_OVER: &str = "Start over";
pub(in crate::console) const START_OVER_HOVER: &str = "Deletes all data recorded in this wizard";
pub(in crate::console) const SAVE_HOVER: &str =
    "The file is valid for this sensor and this tool only, and holds the measured errors";
pub(in crate::console) const SENSOR: &str = "Sensor";
pub(in crate::console) const SENSOR_HOVER: &str = "Serial number of the wrist sensor";
pub(in crate::console) const TOOL: &str = "Tool";
pub(in crate::console) const TOOL_HOVER: &str = "Tool mounted on the sensor";
pub(in crate::console) const SAVE_AND_USE: &str = "Save and use";
pub(in crate::console) const NOT_PROVEN: &str =
    "This calibration is not proven. You can keep it only under your name, which is written into the file.";
pub(in crate::console) const YOUR_NAME: &str = "Your name";
pub(in crate::console) const REASON: &str = "Reason";
pub(in crate::console) const SAVE_ANYWAY: &str = "Save in spite of the verdict";
pub(in crate::console) const SAVE_ANYWAY_DISABLED_HOVER: &str = "Enter a name and a reason first";
pub(in crate::console) const POSE_PICTURE: &str = "Picture of the pose to take";
pub(in crate::console) const POSE_HELD: &str = "solid: the tool now";
pub(in crate::console) const POSE_UNKNOWN: &str = "the arm does not report the tool's orientation";
pub(in crate::console) const SWITCH_DISABLED_HOVER: &str =
    "To change this, press Start over: the recorded data depend on it";
pub(in crate::console) const MET: &str = "met";
pub(in crate::console) const FINE: &str = "fine";
pub(in crate::console) const WAITING: &str = "waiting";
pub(in crate::console) const NO_RESULT: &str = "No result";
pub(in crate::console) const FOLLOWING_CHECK: &str = "Next: ready check";
pub(in crate::console) const DONE: &str = "(done)";

/// Caption of the picture of a pose.
pub(in crate::console) fn tilt_off(tilt_deg: f64) -> String {
    format!("outline: target   solid: tool now   tilt error {tilt_deg:.0} deg")
}

/// Caption of the picture of directions.
pub(in crate::console) fn rings_and_discs(name: &str) -> String {
    format!("{name} (rings: to do, discs: recorded)")
}

/// A map in one sentence.
pub(in crate::console) fn fields_filled(title: &str, filled: usize, fields: usize) -> String {
    format!("{title}: {filled} of {fields} fields filled")
}

/// A check that has passed, with the measured value.
pub(in crate::console) fn met(measured: &str) -> String {
    format!("{measured}, fine")
}

/// Button that goes on with the calibration that is to be made after a saved one.
pub(in crate::console) fn following(arm: &str, calibration: &str) -> String {
    format!("Next: {arm} arm, {}", calibration.to_lowercase())
}

/// Title of a wizard.
pub(in crate::console) fn title(wizard: &str) -> String {
    format!("{wizard} calibration")
}

/// A picture of directions in one sentence.
pub(in crate::console) fn recorded(name: &str, count: usize) -> String {
    format!("{name}: {count} recorded")
}
