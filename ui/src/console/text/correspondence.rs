//! Words of the room `correspondence`.

pub(in crate::console) const CHECK: &str = "Check";
pub(in crate::console) const IS_EVERYTHING_THERE_AND: &str =
    "Is everything there, and do both sensors read nothing without contact?";
pub(in crate::console) const PUSHES: &str = "Pushes";
pub(in crate::console) const THE_TOOL_PUSHES_THE: &str =
    "The tool pushes the tissue in many directions; both sensors feel the same force.";
pub(in crate::console) const RESULT: &str = "Result";
pub(in crate::console) const THE_ROTATION_JUDGED_ON: &str = "The rotation, judged on pushes it has not seen.";
pub(in crate::console) const SAVE: &str = "Save";
pub(in crate::console) const KEPT_FOR_THIS_SENSOR: &str = "Kept for this sensor and this tool, with its residuals.";
pub(in crate::console) const THE_WRIST_SENSOR_IS: &str = "The wrist sensor is silent: connect it.";
pub(in crate::console) const GRAVITY_IS_NOT_IN: &str = "Gravity is not in force: calibrate it first.";
pub(in crate::console) const A_CHECK_IS_NOT: &str = "A check is not met yet.";
pub(in crate::console) const BOTH_SENSORS_MUST_REST: &str = "Both sensors must rest without contact first.";
pub(in crate::console) const AT_LEAST_SIX_PUSHES: &str = "At least six pushes are needed.";
pub(in crate::console) const THERE_IS_NO_ROTATION: &str = "There is no rotation to save: go back and push more.";
pub(in crate::console) const THIS_IS_THE_LAST: &str = "This is the last step.";
pub(in crate::console) const BEFORE_THE_FIRST_PUSH: &str = "Before the first push";
pub(in crate::console) const ALL_FOUR_MUST_BE: &str = "All four must be met before pushes are taken.";
pub(in crate::console) const LAY_THE_TISSUE_ON: &str =
    "Lay the tissue on its sensor, without the body wall. Nothing may touch the tool or the tissue yet.";
pub(in crate::console) const FORCE_AT_THE_WRIST: &str = "Force at the wrist";
pub(in crate::console) const FORCE_UNDER_THE_TISSUE: &str = "Force under the tissue";
pub(in crate::console) const ARM_AND_TRACKER: &str = "Arm and tracker";
pub(in crate::console) const ARM_AND_TRACKER_NOT: &str = "Arm and tracker (not used)";
pub(in crate::console) const REST: &str = "Rest";
pub(in crate::console) const HOW_THIS_RIG_IS: &str = "How this rig is built";
pub(in crate::console) const LEAVE_BOTH_OFF_UNLESS: &str = "Leave both off unless you know, or a verdict says so.";
pub(in crate::console) const THE_SENSOR_UNDER_THE: &str =
    "The sensor under the tissue tells what presses on it, not what the tissue does to the tool";
pub(in crate::console) const AS_SCALES_DO_BOTH: &str =
    "As scales do: both sensors then tell opposite forces. Pushes that were taken are kept.";
pub(in crate::console) const NO_TRACKER_THE_WRIST: &str = "No tracker: the wrist is never turned between the pushes";
pub(in crate::console) const THE_ROTATION_THEN_HOLDS: &str =
    "The rotation then holds for this one orientation of the wrist only.";
pub(in crate::console) const PUSH_THIS_WAY: &str = "Push this way";
pub(in crate::console) const PUSH_THE_TISSUE_HOLD: &str =
    "Push the tissue, hold half a second, let go. The push is taken when it ends.";
pub(in crate::console) const THE_WRIST_SENSOR_IS_SILENT: &str = "the wrist sensor is silent; connect it";
pub(in crate::console) const PUSH: &str = "Push";
pub(in crate::console) const DIRECTIONS_OF_PUSHES: &str = "Directions of pushes";
pub(in crate::console) const THE_FIT_IS_MADE: &str = "The fit is made anew after each push, from the sixth on.";
pub(in crate::console) const TAKEN: &str = "Taken";
pub(in crate::console) const PUSHES_TAKEN_AND_KEPT: &str = "Pushes taken and kept.";
pub(in crate::console) const A_FIRST_FIT_IS: &str = "A first fit is shown from the sixth push on.";
pub(in crate::console) const REMOVE_THE_LAST_PUSH: &str = "Remove the last push";
pub(in crate::console) const THE_PUSHES_COULD_NOT: &str = "The pushes could not be fitted.";
pub(in crate::console) const THERE_ARE_TOO_FEW: &str = "There are too few pushes: go back and take some.";
pub(in crate::console) const ACCEPTED_ON_PUSHES_THAT: &str = "Accepted on pushes that were held out.";
pub(in crate::console) const READY_PUSH_NOW: &str = "ready; push now";
pub(in crate::console) const JUDGED_ON_PUSHES_THAT: &str = "Judged on pushes that the rotation has not seen.";
pub(in crate::console) const ALL_THAT_WERE_TAKEN: &str = "All that were taken, and those that were not used.";
pub(in crate::console) const SPREAD: &str = "Spread";
pub(in crate::console) const SECOND_AND_THIRD_AXIS: &str =
    "Second and third axis of the directions against the first; 1 is even.";
pub(in crate::console) const ROLL_PITCH_YAW_RZ: &str = "Roll, pitch, yaw (Rz Ry Rx).";
pub(in crate::console) const UNCERTAINTY: &str = "Uncertainty";
pub(in crate::console) const EXPECTED_ANGLE_OF_ITS: &str = "Expected angle of its error.";
pub(in crate::console) const EULER_CROSS_CHECK: &str = "Euler cross-check";
pub(in crate::console) const ANGLE_TO_WHAT_THE: &str = "Angle to what the paper's search over Euler angles finds.";
pub(in crate::console) const GAIN: &str = "Gain";
pub(in crate::console) const FORCE_OF_THE_WRIST: &str =
    "Force of the wrist sensor over that of the tissue sensor; 1 is right.";
pub(in crate::console) const OFFSET: &str = "Offset";
pub(in crate::console) const CONSTANT_BETWEEN_BOTH: &str = "Constant between both.";
pub(in crate::console) const OF_THE_WRIST_SENSOR: &str = "of the wrist sensor";
pub(in crate::console) const OF_THE_TISSUE_SENSOR: &str = "of the tissue sensor";
pub(in crate::console) const OF_EITHER_SENSOR: &str = "of either sensor";
pub(in crate::console) const ERRORS_IN_N_IN: &str =
    "Errors in N in the axes of the wrist sensor; held out: pushes that the rotation was not fitted on.";
pub(in crate::console) const AGREEMENT_PER_AXIS: &str = "Agreement per axis";
pub(in crate::console) const AXIS: &str = "Axis";
pub(in crate::console) const FITTED_MAE: &str = "fitted: MAE";
pub(in crate::console) const HELD_OUT_MAE: &str = "held out: MAE";
pub(in crate::console) const R2_OF_ALL_AXES: &str = "R2 of all axes";
pub(in crate::console) const THE_PAPER_HAS_0: &str = "The paper has 0.95.";
pub(in crate::console) const SO_FAR: &str = "So far";

/// How many pushes there are.
pub(in crate::console) fn taken_of(count: usize, asked: usize) -> String {
    format!("{count} taken of {asked} or more")
}

/// The same as a figure.
pub(in crate::console) fn pushes(count: usize) -> String {
    format!("{count} pushes")
}

/// What the sensors read at rest.
pub(in crate::console) fn at_rest(wrist_n: f64, tissue_n: f64) -> String {
    format!("wrist {wrist_n:.2} N, tissue {tissue_n:.2} N; touch nothing, and zero what stays above 0.3 N")
}

/// A push that goes on.
pub(in crate::console) fn hold(force_n: f64) -> String {
    format!("{force_n:.1} N; hold it still")
}

/// A push that may end.
pub(in crate::console) fn let_go(force_n: f64) -> String {
    format!("{force_n:.1} N; enough, let go")
}

/// A push that was taken.
pub(in crate::console) fn push_taken(number: usize) -> String {
    format!("push {number} taken")
}

/// A push that was not.
pub(in crate::console) fn not_taken(why: &str) -> String {
    format!("not taken: {why}")
}

/// Pushes of the fit, and those that it leaves out.
pub(in crate::console) fn used(pairs: usize, left_out: usize, weak: usize) -> String {
    format!("{pairs}, {left_out} contradicted, {weak} too weak")
}

/// From which frame to which.
pub(in crate::console) fn rotation(name: &str) -> String {
    format!("Rotation {name}")
}

/// Agreement of all axes.
pub(in crate::console) fn agreement(fitted: f64, held_out: f64) -> String {
    format!("{fitted:.3} fitted, {held_out:.3} held out")
}
