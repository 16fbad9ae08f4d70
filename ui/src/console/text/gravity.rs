//! The wizard that removes the weight of the tool.

pub(in crate::console) const STEP_CHECK_HOVER: &str =
    "Checks that the sensor sends good data and that nothing touches the tool";
pub(in crate::console) const STEP_POSES: &str = "Poses";
pub(in crate::console) const STEP_POSES_HOVER: &str =
    "Twelve orientations of the tool, so that gravity pulls from all sides";
pub(in crate::console) const STEP_RESULT_HOVER: &str = "The fitted model, tested on poses that were not used to fit it";
pub(in crate::console) const STEP_FREE_MOTION: &str = "Free motion";
pub(in crate::console) const STEP_FREE_MOTION_HOVER: &str =
    "The final test: a tool that moves freely through the air must read zero force";
pub(in crate::console) const NEEDS_POSES: &str = "At least six poses are needed";
pub(in crate::console) const NEEDS_MODEL: &str = "There is no model to test: go back and record more poses";
pub(in crate::console) const NEEDS_FREE_MOTION: &str = "Move the tool freely first";
pub(in crate::console) const CHECKS_TITLE: &str = "Before the first pose";
pub(in crate::console) const CHECKS_HOVER: &str = "All checks must pass before poses are recorded";
pub(in crate::console) const CHECKS_TASK: &str =
    "Take the instrument out of the trocar and let go of it: nothing may touch the tool";
pub(in crate::console) const OPTION_BY_ARM: &str = "Take the orientation from the arm, not from the accelerometer";
pub(in crate::console) const OPTION_BY_ARM_HOVER: &str =
    "For sensors without an accelerometer. The arm must report the orientation of its wrist.";
pub(in crate::console) const OPTION_FLIP_IMU: &str = "The accelerometer's vector points down at rest, not up";
pub(in crate::console) const OPTION_FLIP_IMU_HOVER: &str = "Some drivers report gravity (down) instead of the force that supports the sensor (up). Poses already \
    recorded are kept.";
pub(in crate::console) const POSE_TITLE: &str = "Take this pose";
pub(in crate::console) const POSE_HOVER: &str =
    "Turn the tool as the outline shows, let go of it, and wait until the bar is full";
pub(in crate::console) const ALL_POSES_RECORDED: &str = "All poses are recorded: go on to the result";
pub(in crate::console) const POSE_PROGRESS: &str = "Pose";
pub(in crate::console) const DIRECTIONS_PICTURE: &str = "Directions of gravity";
pub(in crate::console) const DIRECTIONS: &str = "Directions";
pub(in crate::console) const SO_FAR_HOVER: &str = "The model is updated after each pose, from the sixth pose on";
pub(in crate::console) const POSES_HOVER: &str = "Poses recorded so far";
pub(in crate::console) const SO_FAR_EMPTY: &str = "The first result appears after the sixth pose";
pub(in crate::console) const REMOVE_LAST: &str = "Remove the last pose";
pub(in crate::console) const NO_RESULT_HOVER: &str = "No model could be fitted to the poses";
pub(in crate::console) const NO_POSES: &str = "There are no poses yet: go back and record some";
pub(in crate::console) const FREE_MOTION_TITLE: &str = "Move the tool freely";
pub(in crate::console) const FREE_MOTION_HOVER: &str =
    "Force that remains after gravity is removed. Nothing may touch the tool; it should read near 0 N.";
pub(in crate::console) const FREE_MOTION_TASK: &str =
    "Turn the tool slowly in all directions without touching anything. Expected: near 0 N.";
pub(in crate::console) const MEAN: &str = "Mean";
pub(in crate::console) const MEAN_HOVER: &str = "Mean size of the remaining force";
pub(in crate::console) const P95_HOVER: &str = "95 % of all samples, including their noise, are below this";
pub(in crate::console) const TILT: &str = "Tilt covered";
pub(in crate::console) const TILT_HOVER: &str = "How far the tool was tilted; at least 45 degrees are needed";
pub(in crate::console) const PASSED: &str = "Passed";
pub(in crate::console) const NOT_PASSED: &str = "Not passed yet";
pub(in crate::console) const MEASURE_AGAIN: &str = "Measure again";
pub(in crate::console) const PROOF: &str = "Accepted, and passed the test in free motion";
pub(in crate::console) const PHASE_NO_SAMPLE: &str = "no valid data from the wrist sensor";
pub(in crate::console) const PHASE_MOVING: &str = "moving; hold the tool still in this pose";
pub(in crate::console) const PHASE_DISTURBED: &str =
    "the force changes although the tool is still: something touches it; let go";
pub(in crate::console) const PHASE_SAME_POSE: &str = "already recorded here; turn the tool to the pose shown";
pub(in crate::console) const PHASE_RECORDING: &str = "still; recording";
pub(in crate::console) const COVERAGE: &str = "Coverage";
pub(in crate::console) const COVERAGE_HOVER: &str =
    "Share of all directions that have a pose within 45 degrees, 0 to 1";
pub(in crate::console) const MASS: &str = "Mass";
pub(in crate::console) const MASS_HOVER: &str = "Mass of everything mounted on the sensor";
pub(in crate::console) const VERDICT_HOVER: &str = "Tested on poses that were not used to fit the model";
pub(in crate::console) const POSES_USED_HOVER: &str = "Poses used for the fit and the test";
pub(in crate::console) const CONDITION: &str = "Condition";
pub(in crate::console) const CONDITION_HOVER: &str =
    "Condition number of the fit: how well the poses determine the model, no unit; 1 is best";
pub(in crate::console) const CENTRE_OF_MASS: &str = "Centre of mass";
pub(in crate::console) const CENTRE_OF_MASS_HOVER: &str = "In the sensor's frame (s1)";
pub(in crate::console) const LEFT_OUT: &str = "Left out";
pub(in crate::console) const LEFT_OUT_HOVER: &str =
    "These poses contradict the others: something may have touched the tool";
pub(in crate::console) const MODELS_TITLE: &str = "Models compared";
pub(in crate::console) const MODELS_HOVER: &str =
    "Force errors in N. Held out: on poses that were not used to fit the model.";
pub(in crate::console) const MODEL: &str = "Model";
pub(in crate::console) const FITTED_MEAN: &str = "fitted: mean";
pub(in crate::console) const HELD_OUT_MEAN: &str = "held out: mean";
pub(in crate::console) const NO_READING: &str = "no reading";
pub(in crate::console) const P95: &str = "95 % below";
pub(in crate::console) const UNDETERMINED: &str = "undetermined";
pub(in crate::console) const LARGEST: &str = "largest";

/// A pose was recorded.
pub(in crate::console) fn pose_taken(number: usize) -> String {
    format!("pose {number} recorded")
}

/// A pose was refused because the tool was touched.
pub(in crate::console) fn touched(by_n: f64) -> String {
    format!("{by_n:.1} N too much: something touches the tool; let go")
}

/// The tool was touched while poses were recorded.
pub(in crate::console) fn was_touched(seconds: f64) -> String {
    format!("Something touched the tool for {seconds:.0} s while it was still")
}

pub(in crate::console) const WAS_TOUCHED_HOVER: &str =
    "The force changed although the tool did not turn. If the verdict is bad, let go of the tool and press Start over";

/// Poses left out of the fit.
pub(in crate::console) fn left_out(numbers: &str) -> String {
    format!("poses {numbers}")
}

/// Number of recorded directions.
pub(in crate::console) fn recorded_of(recorded: usize, asked: usize) -> String {
    format!("{recorded} of {asked} recorded")
}

/// A force and its limit.
pub(in crate::console) fn of_allowed(force_n: f64, limit_n: f64) -> String {
    format!("{force_n:.2} N of {limit_n} N allowed")
}

/// The chosen model.
pub(in crate::console) fn chosen(model: &str) -> String {
    format!("{model} (chosen)")
}
