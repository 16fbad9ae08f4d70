//! Words of the room `gravity`.

pub(in crate::console) const CHECK: &str = "Check";
pub(in crate::console) const DOES_THE_SENSOR_DELIVER: &str =
    "Does the sensor deliver well, and is nothing touching the tool?";
pub(in crate::console) const POSES: &str = "Poses";
pub(in crate::console) const TWELVE_ORIENTATIONS_THAT_SHOW: &str =
    "Twelve orientations that show gravity from all sides.";
pub(in crate::console) const RESULT: &str = "Result";
pub(in crate::console) const THE_FIT_JUDGED_ON: &str = "The fit, judged on poses it has not seen.";
pub(in crate::console) const FREE_MOTION: &str = "Free motion";
pub(in crate::console) const THE_PROOF_A_TOOL: &str = "The proof: a tool moved through the air must weigh nothing.";
pub(in crate::console) const SAVE: &str = "Save";
pub(in crate::console) const KEPT_FOR_THIS_SENSOR: &str = "Kept for this sensor and this tool, with its residuals.";
pub(in crate::console) const A_CHECK_IS_NOT: &str = "A check is not met yet.";
pub(in crate::console) const AT_LEAST_SIX_POSES: &str = "At least six poses are needed.";
pub(in crate::console) const THERE_IS_NO_MODEL: &str = "There is no model to prove: go back and take more poses.";
pub(in crate::console) const NOTHING_WAS_MEASURED_IN: &str = "Nothing was measured in free motion yet.";
pub(in crate::console) const THIS_IS_THE_LAST: &str = "This is the last step.";
pub(in crate::console) const BEFORE_THE_FIRST_POSE: &str = "Before the first pose";
pub(in crate::console) const ALL_MUST_BE_MET: &str = "All must be met before poses are taken.";
pub(in crate::console) const TAKE_THE_INSTRUMENT_OUT: &str =
    "Take the instrument out of the trocar. Let go of it: nothing may touch the tool.";
pub(in crate::console) const HOW_THIS_RIG_IS: &str = "How this rig is built";
pub(in crate::console) const LEAVE_BOTH_OFF_UNLESS: &str = "Leave both off unless you know, or a verdict says so.";
pub(in crate::console) const TAKE_THE_ORIENTATION_FROM: &str =
    "Take the orientation from the arm, not from the accelerometer";
pub(in crate::console) const FOR_SENSORS_WITHOUT_AN: &str =
    "For sensors without an accelerometer. The arm must tell how the sensor is turned.";
pub(in crate::console) const THE_ACCELEROMETER_POINTS_TO: &str =
    "The accelerometer points to the ground at rest, not away from it";
pub(in crate::console) const SOME_DRIVERS_TELL_GRAVITY: &str =
    "Some drivers tell gravity and not the support. Poses that were taken are kept.";
pub(in crate::console) const TAKE_THIS_POSE: &str = "Take this pose";
pub(in crate::console) const TURN_THE_TOOL_AS: &str =
    "Turn the tool as the outline shows, let go, wait until the bar is full.";
pub(in crate::console) const ALL_DIRECTIONS_ARE_TAKEN: &str = "All directions are taken: go on to the result";
pub(in crate::console) const POSE: &str = "Pose";
pub(in crate::console) const DIRECTIONS_OF_GRAVITY: &str = "Directions of gravity";
pub(in crate::console) const DIRECTIONS: &str = "Directions";
pub(in crate::console) const THE_FIT_IS_MADE: &str = "The fit is made anew after each pose, from the sixth on.";
pub(in crate::console) const POSES_TAKEN_AND_KEPT: &str = "Poses taken and kept.";
pub(in crate::console) const A_FIRST_FIT_IS: &str = "A first fit is shown from the sixth pose on.";
pub(in crate::console) const REMOVE_THE_LAST_POSE: &str = "Remove the last pose";
pub(in crate::console) const THE_POSES_COULD_NOT: &str = "The poses could not be fitted.";
pub(in crate::console) const THERE_ARE_NO_POSES: &str = "There are no poses yet: go back and take some.";
pub(in crate::console) const MOVE_THE_TOOL_FREELY: &str = "Move the tool freely";
pub(in crate::console) const NOTHING_MAY_TOUCH_IT: &str =
    "Nothing may touch it. What is left of the force should be near 0 N.";
pub(in crate::console) const TURN_THE_TOOL_SLOWLY: &str =
    "Turn the tool slowly this way and that, touching nothing. Expected: near 0 N.";
pub(in crate::console) const MEAN: &str = "Mean";
pub(in crate::console) const MEAN_SIZE_OF_WHAT: &str = "Mean size of what is left of the force.";
pub(in crate::console) const THE_NOISE_OF_SINGLE: &str = "The noise of single samples is in it.";
pub(in crate::console) const TILT_COVERED: &str = "Tilt covered";
pub(in crate::console) const AT_LEAST_45_DEGREES: &str = "At least 45 degrees.";
pub(in crate::console) const PASSED: &str = "Passed";
pub(in crate::console) const NOT_PASSED_YET: &str = "Not passed yet";
pub(in crate::console) const MEASURE_AGAIN: &str = "Measure again";
pub(in crate::console) const ACCEPTED_AND_PROVEN_IN: &str = "Accepted, and proven in free motion.";
pub(in crate::console) const NO_VALID_SAMPLE_FROM: &str = "no valid sample from the wrist sensor";
pub(in crate::console) const MOVING_HOLD_THE_TOOL: &str = "moving; hold the tool still in the pose";
pub(in crate::console) const THE_FORCE_IS_NOT: &str =
    "the force is not still though the tool is: something touches it; let go";
pub(in crate::console) const TAKEN_HERE_ALREADY_TURN: &str = "taken here already; turn the tool to the pose shown";
pub(in crate::console) const STILL_BEING_TAKEN: &str = "still; being taken";
pub(in crate::console) const COVERAGE: &str = "Coverage";
pub(in crate::console) const SHARE_OF_ALL_DIRECTIONS: &str = "Share of all directions with a pose within 45 degrees.";
pub(in crate::console) const MASS: &str = "Mass";
pub(in crate::console) const OF_WHAT_HANGS_ON: &str = "Of what hangs on the sensor.";
pub(in crate::console) const JUDGED_ON_POSES_THAT: &str = "Judged on poses that the model has not seen.";
pub(in crate::console) const POSES_THAT_WERE_FITTED: &str = "Poses that were fitted and judged.";
pub(in crate::console) const CONDITION: &str = "Condition";
pub(in crate::console) const HOW_EVENLY_THE_POSES: &str = "How evenly the poses determine the model; 1 is best.";
pub(in crate::console) const CENTRE_OF_MASS: &str = "Centre of mass";
pub(in crate::console) const IN_THE_SENSOR_S: &str = "In the sensor's frame (s1).";
pub(in crate::console) const LEFT_OUT: &str = "Left out";
pub(in crate::console) const FAR_FROM_WHAT_THE: &str = "Far from what the other poses say: perhaps touched.";
pub(in crate::console) const MODELS_SIDE_BY_SIDE: &str = "Models side by side";
pub(in crate::console) const FORCE_ERRORS_IN_N: &str =
    "Force errors in N; held out: on poses that a model was not fitted on.";
pub(in crate::console) const MODEL: &str = "Model";
pub(in crate::console) const FITTED_MEAN: &str = "fitted: mean";
pub(in crate::console) const HELD_OUT_MEAN: &str = "held out: mean";

/// A pose that was taken.
pub(in crate::console) fn pose_taken(number: usize) -> String {
    format!("pose {number} taken")
}

/// A pose that is disturbed.
pub(in crate::console) fn touched(by_n: f64) -> String {
    format!("{by_n:.1} N too much: something touches the tool; let go")
}

/// Poses that were left out.
pub(in crate::console) fn left_out(numbers: &str) -> String {
    format!("pose {numbers}")
}
