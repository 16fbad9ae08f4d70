//! Words of the room `wizards`.

pub(in crate::console) const GRAVITY: &str = "Gravity";
pub(in crate::console) const CORRESPONDENCE: &str = "Correspondence";
pub(in crate::console) const TIP_FORCE: &str = "Tip force";
pub(in crate::console) const TAKES_THE_TOOL_S: &str =
    "Takes the tool's weight and the sensor's bias out of the wrist's force.";
pub(in crate::console) const FINDS_HOW_THE_SENSOR: &str =
    "Finds how the sensor under the tissue is turned against the one at the wrist.";
pub(in crate::console) const TEACHES_A_NETWORK_TO: &str =
    "Teaches a network to take the trocar's friction out of the wrist's force.";
pub(in crate::console) const BACK: &str = "Back";
pub(in crate::console) const NEXT: &str = "Next";
pub(in crate::console) const START_OVER: &str = "Start over";
pub(in crate::console) const THROWS_AWAY_THE_DATA: &str = "Throws away the data of this wizard.";
pub(in crate::console) const SAVE: &str = "Save";
pub(in crate::console) const BOUND_TO_THIS_SENSOR: &str =
    "Bound to this sensor and this tool; the file says how good it was.";
pub(in crate::console) const SENSOR: &str = "Sensor";
pub(in crate::console) const SERIAL_NUMBER_OF_THE: &str = "Serial number of the wrist sensor.";
pub(in crate::console) const TOOL: &str = "Tool";
pub(in crate::console) const WHAT_HANGS_ON_IT: &str = "What hangs on it.";
pub(in crate::console) const SAVE_AND_USE: &str = "Save and use";
pub(in crate::console) const THIS_CALIBRATION_IS_NOT: &str =
    "This calibration is not proven. It can be kept only under somebody's name, which is written into the file.";
pub(in crate::console) const YOUR_NAME: &str = "Your name";
pub(in crate::console) const REASON: &str = "Reason";
pub(in crate::console) const SAVE_IN_SPITE_OF: &str = "Save in spite of the verdict";
pub(in crate::console) const GIVE_A_NAME_AND: &str = "Give a name and a reason first.";
pub(in crate::console) const PICTURE_OF_THE_ORIENTATION: &str = "Picture of the orientation to take";
pub(in crate::console) const SOLID_THE_TOOL_AS: &str = "solid: the tool as it is held";
pub(in crate::console) const THE_ARM_DOES_NOT: &str = "the arm does not tell how the tool is held";
pub(in crate::console) const START_OVER_TO_CHANGE: &str = "Start over to change this: it is in what was taken.";

/// Under the picture of a pose.
pub(in crate::console) fn tilt_off(tilt_deg: f64) -> String {
    format!("outline: asked   solid: held   tilt {tilt_deg:.0} deg off")
}

/// Under the picture of directions.
pub(in crate::console) fn rings_and_discs(name: &str) -> String {
    format!("{name} (rings: wanted, discs: taken)")
}

/// A map in one sentence.
pub(in crate::console) fn fields_filled(title: &str, filled: usize, fields: usize) -> String {
    format!("{title}: {filled} of {fields} fields filled")
}
