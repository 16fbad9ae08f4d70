//! Texts that all calibration wizards share.

use crate::language::{Text, told};

pub(in crate::console) const LAST_STEP: Text = Text::of("This is the last step", "This is the last step");
pub(in crate::console) const NEEDS_CHECKS: Text = Text::of("A check has not passed yet", "A check has not passed yet");
pub(in crate::console) const OPTIONS_HOVER: Text = Text::of(
    "Leave both off unless you know that your rig needs them, or the result says so",
    "Leave both off unless you know that your rig needs them, or the result says so",
);
pub(in crate::console) const OPTIONS_TITLE: Text = Text::of("How this rig is built", "How this rig is built");
pub(in crate::console) const SO_FAR: Text = Text::of("So far", "So far");
pub(in crate::console) const STEP_CHECK: Text = Text::of("Check", "Check");
pub(in crate::console) const STEP_RESULT: Text = Text::of("Result", "Result");
pub(in crate::console) const STEP_SAVE: Text = Text::of("Save", "Save");
pub(in crate::console) const STEP_SAVE_HOVER: Text = Text::of(
    "Saves the result for this sensor and this tool, with its errors",
    "Saves the result for this sensor and this tool, with its errors",
);
pub(in crate::console) const GRAVITY: Text = Text::of("Gravity", "Gravity");
pub(in crate::console) const CORRESPONDENCE: Text = Text::of("Correspondence", "Correspondence");
pub(in crate::console) const TIP_FORCE: Text = Text::of("Tip force", "Tip force");
pub(in crate::console) const GRAVITY_MEANING: Text = Text::of(
    "Removes the tool's weight and the sensor's bias from the wrist force",
    "Removes the tool's weight and the sensor's bias from the wrist force",
);
pub(in crate::console) const CORRESPONDENCE_MEANING: Text = Text::of(
    "Finds the rotation between the sensor under the tissue and the sensor at the wrist",
    "Finds the rotation between the sensor under the tissue and the sensor at the wrist",
);
pub(in crate::console) const TIP_FORCE_MEANING: Text = Text::of(
    "Trains a network to remove the trocar's friction from the wrist force",
    "Trains a network to remove the trocar's friction from the wrist force",
);
pub(in crate::console) const BACK: Text = Text::of("Back", "Back");
pub(in crate::console) const NEXT: Text = Text::of("Next", "Next");
pub(in crate::console) const START_OVER: Text = Text::of("Start over", "Start over");
pub(in crate::console) const START_OVER_HOVER: Text =
    Text::of("Deletes all data recorded in this wizard", "Deletes all data recorded in this wizard");
pub(in crate::console) const SAVE_HOVER: Text = Text::of(
    "The file is valid for this sensor and this tool only, and holds the measured errors",
    "The file is valid for this sensor and this tool only, and holds the measured errors",
);
pub(in crate::console) const SENSOR: Text = Text::of("Sensor", "Sensor");
pub(in crate::console) const SENSOR_HOVER: Text =
    Text::of("Serial number of the wrist sensor", "Serial number of the wrist sensor");
pub(in crate::console) const TOOL: Text = Text::of("Tool", "Tool");
pub(in crate::console) const TOOL_HOVER: Text = Text::of("Tool mounted on the sensor", "Tool mounted on the sensor");
pub(in crate::console) const SAVE_AND_USE: Text = Text::of("Save and use", "Save and use");
pub(in crate::console) const NOT_PROVEN: Text = Text::of(
    "This calibration is not proven. You can keep it only under your name, which is written into the file.",
    "This calibration is not proven. You can keep it only under your name, which is written into the file.",
);
pub(in crate::console) const YOUR_NAME: Text = Text::of("Your name", "Your name");
pub(in crate::console) const REASON: Text = Text::of("Reason", "Reason");
pub(in crate::console) const SAVE_ANYWAY: Text =
    Text::of("Save in spite of the verdict", "Save in spite of the verdict");
pub(in crate::console) const SAVE_ANYWAY_DISABLED_HOVER: Text =
    Text::of("Enter a name and a reason first", "Enter a name and a reason first");
pub(in crate::console) const POSE_PICTURE: Text =
    Text::of("Picture of the pose to take", "Picture of the pose to take");
pub(in crate::console) const POSE_HELD: Text = Text::of("solid: the tool now", "solid: the tool now");
pub(in crate::console) const POSE_UNKNOWN: Text =
    Text::of("the arm does not report the tool's orientation", "the arm does not report the tool's orientation");
pub(in crate::console) const SWITCH_DISABLED_HOVER: Text = Text::of(
    "To change this, press Start over: the recorded data depend on it",
    "To change this, press Start over: the recorded data depend on it",
);
pub(in crate::console) const MET: Text = Text::of("met", "met");
pub(in crate::console) const FINE: Text = Text::of("fine", "fine");
pub(in crate::console) const WAITING: Text = Text::of("waiting", "waiting");
pub(in crate::console) const NO_RESULT: Text = Text::of("No result", "No result");
pub(in crate::console) const FOLLOWING_CHECK: Text = Text::of("Next: ready check", "Next: ready check");
pub(in crate::console) const DONE: Text = Text::of("(done)", "(done)");

/// Caption of the picture of a pose.
pub(in crate::console) fn tilt_off(tilt_deg: f64) -> String {
    told!(
        "outline: target   solid: tool now   tilt error {tilt_deg:.0} deg",
        "outline: target   solid: tool now   tilt error {tilt_deg:.0} deg"
    )
}

/// Caption of the picture of directions.
pub(in crate::console) fn rings_and_discs(name: &str) -> String {
    told!("{name} (rings: to do, discs: recorded)", "{name} (rings: to do, discs: recorded)")
}

/// A map in one sentence.
pub(in crate::console) fn fields_filled(title: &str, filled: usize, fields: usize) -> String {
    told!("{title}: {filled} of {fields} fields filled", "{title}: {filled} of {fields} fields filled")
}

/// A check that has passed, with the measured value.
pub(in crate::console) fn met(measured: &str) -> String {
    told!("{measured}, fine", "{measured}, fine")
}

/// Button that goes on with the calibration that is to be made after a saved one.
pub(in crate::console) fn following(arm: &str, calibration: &str) -> String {
    told!("Next: {arm} arm, {}", "Next: {arm} arm, {}", calibration.to_lowercase())
}

/// Title of a wizard.
pub(in crate::console) fn title(wizard: &str) -> String {
    told!("{wizard} calibration", "{wizard} calibration")
}

/// A picture of directions in one sentence.
pub(in crate::console) fn recorded(name: &str, count: usize) -> String {
    told!("{name}: {count} recorded", "{name}: {count} recorded")
}
