//! The wizard that removes the weight of the tool.

use crate::language::{Text, told};

pub(in crate::console) const STEP_CHECK_HOVER: Text = Text::of(
    "Checks that the sensor sends good data and that nothing touches the tool",
    "Checks that the sensor sends good data and that nothing touches the tool",
);
pub(in crate::console) const STEP_POSES: Text = Text::of("Poses", "Poses");
pub(in crate::console) const STEP_POSES_HOVER: Text = Text::of(
    "Twelve orientations of the tool, so that gravity pulls from all sides",
    "Twelve orientations of the tool, so that gravity pulls from all sides",
);
pub(in crate::console) const STEP_RESULT_HOVER: Text = Text::of(
    "The fitted model, tested on poses that were not used to fit it",
    "The fitted model, tested on poses that were not used to fit it",
);
pub(in crate::console) const STEP_FREE_MOTION: Text = Text::of("Free motion", "Free motion");
pub(in crate::console) const STEP_FREE_MOTION_HOVER: Text = Text::of(
    "The final test: a tool that moves freely through the air must read zero force",
    "The final test: a tool that moves freely through the air must read zero force",
);
pub(in crate::console) const NEEDS_POSES: Text =
    Text::of("At least six poses are needed", "At least six poses are needed");
pub(in crate::console) const NEEDS_MODEL: Text = Text::of(
    "There is no model to test: go back and record more poses",
    "There is no model to test: go back and record more poses",
);
pub(in crate::console) const NEEDS_FREE_MOTION: Text =
    Text::of("Move the tool freely first", "Move the tool freely first");
pub(in crate::console) const CHECKS_TITLE: Text = Text::of("Before the first pose", "Before the first pose");
pub(in crate::console) const CHECKS_HOVER: Text =
    Text::of("All checks must pass before poses are recorded", "All checks must pass before poses are recorded");
pub(in crate::console) const CHECKS_TASK: Text = Text::of(
    "Take the instrument out of the trocar and let go of it: nothing may touch the tool",
    "Take the instrument out of the trocar and let go of it: nothing may touch the tool",
);
pub(in crate::console) const OPTION_BY_ARM: Text = Text::of(
    "Take the orientation from the arm, not from the accelerometer",
    "Take the orientation from the arm, not from the accelerometer",
);
pub(in crate::console) const OPTION_BY_ARM_HOVER: Text = Text::of(
    "For sensors without an accelerometer. The arm must report the orientation of its wrist.",
    "For sensors without an accelerometer. The arm must report the orientation of its wrist.",
);
pub(in crate::console) const OPTION_FLIP_IMU: Text = Text::of(
    "The accelerometer's vector points down at rest, not up",
    "The accelerometer's vector points down at rest, not up",
);
pub(in crate::console) const OPTION_FLIP_IMU_HOVER: Text = Text::of(
    "Some drivers report gravity (down) instead of the force that supports the sensor (up). Poses already \
    recorded are kept.",
    "Some drivers report gravity (down) instead of the force that supports the sensor (up). Poses already \
    recorded are kept.",
);
pub(in crate::console) const POSE_TITLE: Text = Text::of("Take this pose", "Take this pose");
pub(in crate::console) const POSE_HOVER: Text = Text::of(
    "Turn the tool as the outline shows, let go of it, and wait until the bar is full",
    "Turn the tool as the outline shows, let go of it, and wait until the bar is full",
);
pub(in crate::console) const ALL_POSES_RECORDED: Text =
    Text::of("All poses are recorded: go on to the result", "All poses are recorded: go on to the result");
pub(in crate::console) const POSE_PROGRESS: Text = Text::of("Pose", "Pose");
pub(in crate::console) const DIRECTIONS_PICTURE: Text = Text::of("Directions of gravity", "Directions of gravity");
pub(in crate::console) const DIRECTIONS: Text = Text::of("Directions", "Directions");
pub(in crate::console) const SO_FAR_HOVER: Text = Text::of(
    "The model is updated after each pose, from the sixth pose on",
    "The model is updated after each pose, from the sixth pose on",
);
pub(in crate::console) const POSES_HOVER: Text = Text::of("Poses recorded so far", "Poses recorded so far");
pub(in crate::console) const SO_FAR_EMPTY: Text =
    Text::of("The first result appears after the sixth pose", "The first result appears after the sixth pose");
pub(in crate::console) const REMOVE_LAST: Text = Text::of("Remove the last pose", "Remove the last pose");
pub(in crate::console) const NO_RESULT_HOVER: Text =
    Text::of("No model could be fitted to the poses", "No model could be fitted to the poses");
pub(in crate::console) const NO_POSES: Text =
    Text::of("There are no poses yet: go back and record some", "There are no poses yet: go back and record some");
pub(in crate::console) const FREE_MOTION_TITLE: Text = Text::of("Move the tool freely", "Move the tool freely");
pub(in crate::console) const FREE_MOTION_HOVER: Text = Text::of(
    "Force that remains after gravity is removed. Nothing may touch the tool; it should read near 0 N.",
    "Force that remains after gravity is removed. Nothing may touch the tool; it should read near 0 N.",
);
pub(in crate::console) const FREE_MOTION_TASK: Text = Text::of(
    "Turn the tool slowly in all directions without touching anything. Expected: near 0 N.",
    "Turn the tool slowly in all directions without touching anything. Expected: near 0 N.",
);
pub(in crate::console) const MEAN: Text = Text::of("Mean", "Mean");
pub(in crate::console) const MEAN_HOVER: Text =
    Text::of("Mean size of the remaining force", "Mean size of the remaining force");
pub(in crate::console) const P95_HOVER: Text = Text::of(
    "95 % of all samples, including their noise, are below this",
    "95 % of all samples, including their noise, are below this",
);
pub(in crate::console) const TILT: Text = Text::of("Tilt covered", "Tilt covered");
pub(in crate::console) const TILT_HOVER: Text = Text::of(
    "How far the tool was tilted; at least 45 degrees are needed",
    "How far the tool was tilted; at least 45 degrees are needed",
);
pub(in crate::console) const PASSED: Text = Text::of("Passed", "Passed");
pub(in crate::console) const NOT_PASSED: Text = Text::of("Not passed yet", "Not passed yet");
pub(in crate::console) const MEASURE_AGAIN: Text = Text::of("Measure again", "Measure again");
pub(in crate::console) const PROOF: Text =
    Text::of("Accepted, and passed the test in free motion", "Accepted, and passed the test in free motion");
pub(in crate::console) const PHASE_NO_SAMPLE: Text =
    Text::of("no valid data from the wrist sensor", "no valid data from the wrist sensor");
pub(in crate::console) const PHASE_MOVING: Text =
    Text::of("moving; hold the tool still in this pose", "moving; hold the tool still in this pose");
pub(in crate::console) const PHASE_DISTURBED: Text = Text::of(
    "the force changes although the tool is still: something touches it; let go",
    "the force changes although the tool is still: something touches it; let go",
);
pub(in crate::console) const PHASE_SAME_POSE: Text = Text::of(
    "already recorded here; turn the tool to the pose shown",
    "already recorded here; turn the tool to the pose shown",
);
pub(in crate::console) const PHASE_RECORDING: Text = Text::of("still; recording", "still; recording");
pub(in crate::console) const COVERAGE: Text = Text::of("Coverage", "Coverage");
pub(in crate::console) const COVERAGE_HOVER: Text = Text::of(
    "Share of all directions that have a pose within 45 degrees, 0 to 1",
    "Share of all directions that have a pose within 45 degrees, 0 to 1",
);
pub(in crate::console) const MASS: Text = Text::of("Mass", "Mass");
pub(in crate::console) const MASS_HOVER: Text =
    Text::of("Mass of everything mounted on the sensor", "Mass of everything mounted on the sensor");
pub(in crate::console) const VERDICT_HOVER: Text = Text::of(
    "Tested on poses that were not used to fit the model",
    "Tested on poses that were not used to fit the model",
);
pub(in crate::console) const POSES_USED_HOVER: Text =
    Text::of("Poses used for the fit and the test", "Poses used for the fit and the test");
pub(in crate::console) const CONDITION: Text = Text::of("Condition", "Condition");
pub(in crate::console) const CONDITION_HOVER: Text = Text::of(
    "Condition number of the fit: how well the poses determine the model, no unit; 1 is best",
    "Condition number of the fit: how well the poses determine the model, no unit; 1 is best",
);
pub(in crate::console) const CENTRE_OF_MASS: Text = Text::of("Centre of mass", "Centre of mass");
pub(in crate::console) const CENTRE_OF_MASS_HOVER: Text =
    Text::of("In the sensor's frame (s1)", "In the sensor's frame (s1)");
pub(in crate::console) const LEFT_OUT: Text = Text::of("Left out", "Left out");
pub(in crate::console) const LEFT_OUT_HOVER: Text = Text::of(
    "These poses contradict the others: something may have touched the tool",
    "These poses contradict the others: something may have touched the tool",
);
pub(in crate::console) const MODELS_TITLE: Text = Text::of("Models compared", "Models compared");
pub(in crate::console) const MODELS_HOVER: Text = Text::of(
    "Force errors in N. Held out: on poses that were not used to fit the model.",
    "Force errors in N. Held out: on poses that were not used to fit the model.",
);
pub(in crate::console) const MODEL: Text = Text::of("Model", "Model");
pub(in crate::console) const FITTED_MEAN: Text = Text::of("fitted: mean", "fitted: mean");
pub(in crate::console) const HELD_OUT_MEAN: Text = Text::of("held out: mean", "held out: mean");
pub(in crate::console) const NO_READING: Text = Text::of("no reading", "no reading");
pub(in crate::console) const P95: Text = Text::of("95 % below", "95 % below");
pub(in crate::console) const UNDETERMINED: Text = Text::of("undetermined", "undetermined");
pub(in crate::console) const LARGEST: Text = Text::of("largest", "largest");

/// A pose was recorded.
pub(in crate::console) fn pose_taken(number: usize) -> String {
    told!("pose {number} recorded", "pose {number} recorded")
}

/// A pose was refused because the tool was touched.
pub(in crate::console) fn touched(by_n: f64) -> String {
    told!(
        "{by_n:.1} N too much: something touches the tool; let go",
        "{by_n:.1} N too much: something touches the tool; let go"
    )
}

/// The tool was touched while poses were recorded.
pub(in crate::console) fn was_touched(seconds: f64) -> String {
    told!(
        "Something touched the tool for {seconds:.0} s while it was still",
        "Something touched the tool for {seconds:.0} s while it was still"
    )
}

pub(in crate::console) const WAS_TOUCHED_HOVER: Text = Text::of(
    "The force changed although the tool did not turn. If the verdict is bad, let go of the tool and press Start over",
    "The force changed although the tool did not turn. If the verdict is bad, let go of the tool and press Start over",
);

/// Poses left out of the fit.
pub(in crate::console) fn left_out(numbers: &str) -> String {
    told!("poses {numbers}", "poses {numbers}")
}

/// Number of recorded directions.
pub(in crate::console) fn recorded_of(recorded: usize, asked: usize) -> String {
    told!("{recorded} of {asked} recorded", "{recorded} of {asked} recorded")
}

/// A force and its limit.
pub(in crate::console) fn of_allowed(force_n: f64, limit_n: f64) -> String {
    told!("{force_n:.2} N of {limit_n} N allowed", "{force_n:.2} N of {limit_n} N allowed")
}

/// The chosen model.
pub(in crate::console) fn chosen(model: &str) -> String {
    told!("{model} (chosen)", "{model} (chosen)")
}
