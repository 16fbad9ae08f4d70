//! The wizard that finds the rotation between the wrist sensor and the tissue sensor.

pub(in crate::console) const STEP_CHECK_HOVER: &str = "Checks that all sensors send data and read zero without contact";
pub(in crate::console) const STEP_PUSHES: &str = "Pushes";
pub(in crate::console) const STEP_PUSHES_HOVER: &str =
    "Push the tissue with the tool in many directions, so that both sensors measure the same force";
pub(in crate::console) const STEP_RESULT_HOVER: &str =
    "The rotation between the sensors, tested on pushes that were not used to fit it";
pub(in crate::console) const NEEDS_WRIST_SENSOR: &str = "The wrist sensor sends no data: connect it";
pub(in crate::console) const NEEDS_GRAVITY: &str = "Gravity is not calibrated: calibrate it first";
pub(in crate::console) const NEEDS_REST: &str = "Both sensors must rest without contact first";
pub(in crate::console) const NEEDS_PUSHES: &str = "At least six pushes are needed";
pub(in crate::console) const NEEDS_ROTATION: &str = "There is no result to save: go back and record more pushes";
pub(in crate::console) const CHECKS_TITLE: &str = "Before the first push";
pub(in crate::console) const CHECKS_HOVER: &str = "All four checks must pass before pushes are recorded";
pub(in crate::console) const CHECKS_TASK: &str =
    "Put the tissue on its sensor, without the body wall. Nothing may touch the tool or the tissue yet.";
pub(in crate::console) const CHECK_WRIST: &str = "Force at the wrist";
pub(in crate::console) const CHECK_TISSUE: &str = "Force under the tissue";
pub(in crate::console) const CHECK_TRACKER: &str = "Arm and tracker";
pub(in crate::console) const CHECK_TRACKER_UNUSED: &str = "Arm and tracker (not used)";
pub(in crate::console) const CHECK_REST: &str = "No contact";
pub(in crate::console) const OPTION_FLIP: &str =
    "The sensor under the tissue reports the force on the tissue, not the force on the tool";
pub(in crate::console) const OPTION_FLIP_HOVER: &str =
    "A scale does this: the two sensors then report opposite forces. Pushes already recorded are kept.";
pub(in crate::console) const OPTION_NO_TRACKER: &str = "No tracker: the wrist keeps its orientation during all pushes";
pub(in crate::console) const OPTION_NO_TRACKER_HOVER: &str =
    "The result is then valid for this orientation of the wrist only";
pub(in crate::console) const PUSH_TITLE: &str = "Push in this direction";
pub(in crate::console) const PUSH_HOVER: &str =
    "Push the tissue, hold for half a second, then let go. The push is recorded when you let go.";
pub(in crate::console) const PHASE_WRIST_SILENT: &str = "the wrist sensor sends no data; connect it";
pub(in crate::console) const PUSH_PROGRESS: &str = "Push";
pub(in crate::console) const DIRECTIONS_PICTURE: &str = "Push directions";
pub(in crate::console) const SO_FAR_HOVER: &str = "The result is updated after each push, from the sixth push on";
pub(in crate::console) const RECORDED: &str = "Recorded";
pub(in crate::console) const RECORDED_HOVER: &str = "Pushes recorded so far";
pub(in crate::console) const SO_FAR_EMPTY: &str = "The first result appears after the sixth push";
pub(in crate::console) const REMOVE_LAST: &str = "Remove the last push";
pub(in crate::console) const NO_RESULT_HOVER: &str = "No rotation could be fitted to the pushes";
pub(in crate::console) const TOO_FEW: &str = "There are too few pushes: go back and record more";
pub(in crate::console) const PROOF: &str = "Accepted on pushes that were held out";
pub(in crate::console) const PHASE_READY: &str = "ready; push now";
pub(in crate::console) const VERDICT_HOVER: &str = "Tested on pushes that were not used to fit the rotation";
pub(in crate::console) const PUSHES_HOVER: &str = "Number of pushes recorded, and how many of them were not used";
pub(in crate::console) const SPREAD: &str = "Spread";
pub(in crate::console) const SPREAD_HOVER: &str = "How evenly the pushes point in all directions: second and third axis relative to the first. 1 is \
    even, 0 means that an axis is missing.";
pub(in crate::console) const ROTATION_HOVER: &str = "Roll, pitch and yaw in degrees (Rz Ry Rx)";
pub(in crate::console) const UNCERTAINTY: &str = "Uncertainty";
pub(in crate::console) const UNCERTAINTY_HOVER: &str = "Expected error of the rotation, as an angle";
pub(in crate::console) const CROSS_CHECK: &str = "Euler cross-check";
pub(in crate::console) const CROSS_CHECK_HOVER: &str =
    "Angle between this rotation and the one that the paper's search over Euler angles finds";
pub(in crate::console) const GAIN: &str = "Gain";
pub(in crate::console) const GAIN_HOVER: &str =
    "Ratio of the wrist sensor's force to the tissue sensor's force; it should be 1";
pub(in crate::console) const OFFSET: &str = "Offset";
pub(in crate::console) const OFFSET_HOVER: &str = "Constant difference between the two sensors' forces";
pub(in crate::console) const OFFSET_OF_WRIST: &str = "of the wrist sensor";
pub(in crate::console) const OFFSET_OF_TISSUE: &str = "of the tissue sensor";
pub(in crate::console) const OFFSET_OF_EITHER: &str = "of either sensor";
pub(in crate::console) const AGREEMENT_HOVER: &str = "Errors in N along the axes of the wrist sensor. Held out: on pushes that were not used for the fit. \
    MAE: mean absolute error. SD: standard deviation.";
pub(in crate::console) const AGREEMENT_TITLE: &str = "Agreement per axis";
pub(in crate::console) const AXIS: &str = "Axis";
pub(in crate::console) const FITTED_MAE: &str = "fitted: MAE";
pub(in crate::console) const HELD_OUT_MAE: &str = "held out: MAE";
pub(in crate::console) const R2_OVERALL: &str = "R2 of all axes";
pub(in crate::console) const R2_OVERALL_HOVER: &str =
    "Share of the variance that the fit explains; the paper reports 0.95";

/// Number of recorded pushes.
pub(in crate::console) fn taken_of(count: usize, asked: usize) -> String {
    format!("{count} recorded of {asked} or more")
}

/// Number of recorded pushes, as a figure.
pub(in crate::console) fn pushes(count: usize) -> String {
    format!("{count} pushes")
}

/// Readings of the sensors at rest.
pub(in crate::console) fn at_rest(wrist_n: f64, tissue_n: f64) -> String {
    format!(
        "wrist {wrist_n:.2} N, tissue {tissue_n:.2} N; touch nothing; if a sensor stays above 0.3 N, set it to zero"
    )
}

/// During a push: keep holding.
pub(in crate::console) fn hold(force_n: f64) -> String {
    format!("{force_n:.1} N; hold still")
}

/// During a push: it may end now.
pub(in crate::console) fn let_go(force_n: f64) -> String {
    format!("{force_n:.1} N; enough, let go")
}

/// A push was recorded.
pub(in crate::console) fn push_taken(number: usize) -> String {
    format!("push {number} recorded")
}

/// A push was not recorded.
pub(in crate::console) fn not_taken(why: &str) -> String {
    format!("not recorded: {why}")
}

/// Number of pushes used in the fit, and of those left out.
pub(in crate::console) fn used(pairs: usize, left_out: usize, weak: usize) -> String {
    format!("{pairs}; not used: {left_out} contradictory, {weak} too weak")
}

/// Names of the two frames.
pub(in crate::console) fn rotation(name: &str) -> String {
    format!("Rotation {name}")
}

/// Coefficient of determination over all axes.
pub(in crate::console) fn agreement(fitted: f64, held_out: f64) -> String {
    format!("{fitted:.3} fitted, {held_out:.3} held out")
}
