//! The wizard that finds the rotation between the wrist sensor and the tissue sensor.

use crate::language::{Text, told};

pub(in crate::console) const STEP_CHECK_HOVER: Text = Text::of(
    "Checks that all sensors send data and read zero without contact",
    "Checks that all sensors send data and read zero without contact",
);
pub(in crate::console) const STEP_PUSHES: Text = Text::of("Pushes", "Pushes");
pub(in crate::console) const STEP_PUSHES_HOVER: Text = Text::of(
    "Push the tissue with the tool in many directions, so that both sensors measure the same force",
    "Push the tissue with the tool in many directions, so that both sensors measure the same force",
);
pub(in crate::console) const STEP_RESULT_HOVER: Text = Text::of(
    "The rotation between the sensors, tested on pushes that were not used to fit it",
    "The rotation between the sensors, tested on pushes that were not used to fit it",
);
pub(in crate::console) const NEEDS_WRIST_SENSOR: Text =
    Text::of("The wrist sensor sends no data: connect it", "The wrist sensor sends no data: connect it");
pub(in crate::console) const NEEDS_GRAVITY: Text =
    Text::of("Gravity is not calibrated: calibrate it first", "Gravity is not calibrated: calibrate it first");
pub(in crate::console) const NEEDS_REST: Text =
    Text::of("Both sensors must rest without contact first", "Both sensors must rest without contact first");
pub(in crate::console) const NEEDS_PUSHES: Text =
    Text::of("At least six pushes are needed", "At least six pushes are needed");
pub(in crate::console) const NEEDS_ROTATION: Text = Text::of(
    "There is no result to save: go back and record more pushes",
    "There is no result to save: go back and record more pushes",
);
pub(in crate::console) const CHECKS_TITLE: Text = Text::of("Before the first push", "Before the first push");
pub(in crate::console) const CHECKS_HOVER: Text = Text::of(
    "All four checks must pass before pushes are recorded",
    "All four checks must pass before pushes are recorded",
);
pub(in crate::console) const CHECKS_TASK: Text = Text::of(
    "Put the tissue on its sensor, without the body wall. Nothing may touch the tool or the tissue yet.",
    "Put the tissue on its sensor, without the body wall. Nothing may touch the tool or the tissue yet.",
);
pub(in crate::console) const CHECK_WRIST: Text = Text::of("Force at the wrist", "Force at the wrist");
pub(in crate::console) const CHECK_TISSUE: Text = Text::of("Force under the tissue", "Force under the tissue");
pub(in crate::console) const CHECK_TRACKER: Text = Text::of("Arm and tracker", "Arm and tracker");
pub(in crate::console) const CHECK_TRACKER_UNUSED: Text =
    Text::of("Arm and tracker (not used)", "Arm and tracker (not used)");
pub(in crate::console) const CHECK_REST: Text = Text::of("No contact", "No contact");
pub(in crate::console) const OPTION_FLIP: Text = Text::of(
    "The sensor under the tissue reports the force on the tissue, not the force on the tool",
    "The sensor under the tissue reports the force on the tissue, not the force on the tool",
);
pub(in crate::console) const OPTION_FLIP_HOVER: Text = Text::of(
    "A scale does this: the two sensors then report opposite forces. Pushes already recorded are kept.",
    "A scale does this: the two sensors then report opposite forces. Pushes already recorded are kept.",
);
pub(in crate::console) const OPTION_NO_TRACKER: Text = Text::of(
    "No tracker: the wrist keeps its orientation during all pushes",
    "No tracker: the wrist keeps its orientation during all pushes",
);
pub(in crate::console) const OPTION_NO_TRACKER_HOVER: Text = Text::of(
    "The result is then valid for this orientation of the wrist only",
    "The result is then valid for this orientation of the wrist only",
);
pub(in crate::console) const PUSH_TITLE: Text = Text::of("Push in this direction", "Push in this direction");
pub(in crate::console) const PUSH_HOVER: Text = Text::of(
    "Push the tissue, hold for half a second, then let go. The push is recorded when you let go.",
    "Push the tissue, hold for half a second, then let go. The push is recorded when you let go.",
);
pub(in crate::console) const PHASE_WRIST_SILENT: Text =
    Text::of("the wrist sensor sends no data; connect it", "the wrist sensor sends no data; connect it");
pub(in crate::console) const PUSH_PROGRESS: Text = Text::of("Push", "Push");
pub(in crate::console) const DIRECTIONS_PICTURE: Text = Text::of("Push directions", "Push directions");
pub(in crate::console) const SO_FAR_HOVER: Text = Text::of(
    "The result is updated after each push, from the sixth push on",
    "The result is updated after each push, from the sixth push on",
);
pub(in crate::console) const RECORDED: Text = Text::of("Recorded", "Recorded");
pub(in crate::console) const RECORDED_HOVER: Text = Text::of("Pushes recorded so far", "Pushes recorded so far");
pub(in crate::console) const SO_FAR_EMPTY: Text =
    Text::of("The first result appears after the sixth push", "The first result appears after the sixth push");
pub(in crate::console) const REMOVE_LAST: Text = Text::of("Remove the last push", "Remove the last push");
pub(in crate::console) const NO_RESULT_HOVER: Text =
    Text::of("No rotation could be fitted to the pushes", "No rotation could be fitted to the pushes");
pub(in crate::console) const TOO_FEW: Text =
    Text::of("There are too few pushes: go back and record more", "There are too few pushes: go back and record more");
pub(in crate::console) const PROOF: Text =
    Text::of("Accepted on pushes that were held out", "Accepted on pushes that were held out");
pub(in crate::console) const PHASE_READY: Text = Text::of("ready; push now", "ready; push now");
pub(in crate::console) const VERDICT_HOVER: Text = Text::of(
    "Tested on pushes that were not used to fit the rotation",
    "Tested on pushes that were not used to fit the rotation",
);
pub(in crate::console) const PUSHES_HOVER: Text = Text::of(
    "Number of pushes recorded, and how many of them were not used",
    "Number of pushes recorded, and how many of them were not used",
);
pub(in crate::console) const SPREAD: Text = Text::of("Spread", "Spread");
pub(in crate::console) const SPREAD_HOVER: Text = Text::of(
    "How evenly the pushes point in all directions: second and third axis relative to the first. 1 is \
    even, 0 means that an axis is missing.",
    "How evenly the pushes point in all directions: second and third axis relative to the first. 1 is \
    even, 0 means that an axis is missing.",
);
pub(in crate::console) const ROTATION_HOVER: Text =
    Text::of("Roll, pitch and yaw in degrees (Rz Ry Rx)", "Roll, pitch and yaw in degrees (Rz Ry Rx)");
pub(in crate::console) const UNCERTAINTY: Text = Text::of("Uncertainty", "Uncertainty");
pub(in crate::console) const UNCERTAINTY_HOVER: Text =
    Text::of("Expected error of the rotation, as an angle", "Expected error of the rotation, as an angle");
pub(in crate::console) const CROSS_CHECK: Text = Text::of("Euler cross-check", "Euler cross-check");
pub(in crate::console) const CROSS_CHECK_HOVER: Text = Text::of(
    "Angle between this rotation and the one that the paper's search over Euler angles finds",
    "Angle between this rotation and the one that the paper's search over Euler angles finds",
);
pub(in crate::console) const GAIN: Text = Text::of("Gain", "Gain");
pub(in crate::console) const GAIN_HOVER: Text = Text::of(
    "Ratio of the wrist sensor's force to the tissue sensor's force; it should be 1",
    "Ratio of the wrist sensor's force to the tissue sensor's force; it should be 1",
);
pub(in crate::console) const OFFSET: Text = Text::of("Offset", "Offset");
pub(in crate::console) const OFFSET_HOVER: Text = Text::of(
    "Constant difference between the two sensors' forces",
    "Constant difference between the two sensors' forces",
);
pub(in crate::console) const OFFSET_OF_WRIST: Text = Text::of("of the wrist sensor", "of the wrist sensor");
pub(in crate::console) const OFFSET_OF_TISSUE: Text = Text::of("of the tissue sensor", "of the tissue sensor");
pub(in crate::console) const OFFSET_OF_EITHER: Text = Text::of("of either sensor", "of either sensor");
pub(in crate::console) const AGREEMENT_HOVER: Text = Text::of(
    "Errors in N along the axes of the wrist sensor. Held out: on pushes that were not used for the fit. \
    MAE: mean absolute error. SD: standard deviation.",
    "Errors in N along the axes of the wrist sensor. Held out: on pushes that were not used for the fit. \
    MAE: mean absolute error. SD: standard deviation.",
);
pub(in crate::console) const AGREEMENT_TITLE: Text = Text::of("Agreement per axis", "Agreement per axis");
pub(in crate::console) const AXIS: Text = Text::of("Axis", "Axis");
pub(in crate::console) const FITTED_MAE: Text = Text::of("fitted: MAE", "fitted: MAE");
pub(in crate::console) const HELD_OUT_MAE: Text = Text::of("held out: MAE", "held out: MAE");
pub(in crate::console) const R2_OVERALL: Text = Text::of("R2 of all axes", "R2 of all axes");
pub(in crate::console) const R2_OVERALL_HOVER: Text = Text::of(
    "Share of the variance that the fit explains; the paper reports 0.95",
    "Share of the variance that the fit explains; the paper reports 0.95",
);

/// Number of recorded pushes.
pub(in crate::console) fn taken_of(count: usize, asked: usize) -> String {
    told!("{count} recorded of {asked} or more", "{count} recorded of {asked} or more")
}

/// Number of recorded pushes, as a figure.
pub(in crate::console) fn pushes(count: usize) -> String {
    told!("{count} pushes", "{count} pushes")
}

/// Readings of the sensors at rest.
pub(in crate::console) fn at_rest(wrist_n: f64, tissue_n: f64) -> String {
    told!(
        "wrist {wrist_n:.2} N, tissue {tissue_n:.2} N; touch nothing; if a sensor stays above 0.3 N, set it to zero",
        "wrist {wrist_n:.2} N, tissue {tissue_n:.2} N; touch nothing; if a sensor stays above 0.3 N, set it to zero"
    )
}

/// During a push: keep holding.
pub(in crate::console) fn hold(force_n: f64) -> String {
    told!("{force_n:.1} N; hold still", "{force_n:.1} N; hold still")
}

/// During a push: it may end now.
pub(in crate::console) fn let_go(force_n: f64) -> String {
    told!("{force_n:.1} N; enough, let go", "{force_n:.1} N; enough, let go")
}

/// A push was recorded.
pub(in crate::console) fn push_taken(number: usize) -> String {
    told!("push {number} recorded", "push {number} recorded")
}

/// A push was not recorded.
pub(in crate::console) fn not_taken(why: &str) -> String {
    told!("not recorded: {why}", "not recorded: {why}")
}

/// Number of pushes used in the fit, and of those left out.
pub(in crate::console) fn used(pairs: usize, left_out: usize, weak: usize) -> String {
    told!(
        "{pairs}; not used: {left_out} contradictory, {weak} too weak",
        "{pairs}; not used: {left_out} contradictory, {weak} too weak"
    )
}

/// Names of the two frames.
pub(in crate::console) fn rotation(name: &str) -> String {
    told!("Rotation {name}", "Rotation {name}")
}

/// Coefficient of determination over all axes.
pub(in crate::console) fn agreement(fitted: f64, held_out: f64) -> String {
    told!("{fitted:.3} fitted, {held_out:.3} held out", "{fitted:.3} fitted, {held_out:.3} held out")
}
