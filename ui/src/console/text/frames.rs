//! The wizards of the frame calibrations: sensor mount, tip, hand-eye, table, view, trocar.

pub(in crate::console) const MOUNT: &str = "Sensor mount";
pub(in crate::console) const TIP: &str = "Tip";
pub(in crate::console) const HAND_EYE: &str = "Hand-eye";
pub(in crate::console) const TABLE: &str = "Table";
pub(in crate::console) const VIEW: &str = "View";
pub(in crate::console) const TROCAR: &str = "Trocar";
pub(in crate::console) const MOUNT_MEANING: &str = "Checks how the wrist sensor is turned on the arm's flange";
pub(in crate::console) const TIP_MEANING: &str = "Finds the instrument's tip in the frame of the arm's flange";
pub(in crate::console) const HAND_EYE_MEANING: &str =
    "Finds the marker on the instrument, and the tracker beside the arm";
pub(in crate::console) const TABLE_MEANING: &str =
    "Finds origin and plane of the workspace from points touched with the tip";
pub(in crate::console) const VIEW_MEANING: &str = "Finds how the endoscope's picture is turned against arm and handle";
pub(in crate::console) const TROCAR_MEANING: &str = "Finds the point about which the instrument pivots";

pub(in crate::console) const MOUNT_BEFORE: &str =
    "Take the instrument out of the trocar; nothing may touch it. Recording begins with the next step.";
pub(in crate::console) const MOUNT_TASK: &str = "Hold the tool still in each orientation until it is recorded";
pub(in crate::console) const TIP_BEFORE: &str = "Take the instrument out of the trocar, and put its tip into a dimple that cannot move, such as a screw's recess. Recording begins with the next step.";
pub(in crate::console) const TIP_TASK: &str = "Tilt to all sides by 20 to 30 degrees, and turn about the shaft. Hold each pose still for half a second. The tip must stay in the dimple.";
pub(in crate::console) const HAND_EYE_BEFORE: &str = "Take the instrument out of the trocar, and turn its marker towards the tracker. The other arm and its marker rest. Recording begins with the next step.";
pub(in crate::console) const HAND_EYE_TASK: &str = "Tilt and turn the instrument in every pose, also about its shaft; moves without turns tell nothing. Hold each pose still for half a second.";
pub(in crate::console) const TABLE_BEFORE: &str = "Clear the table, and mark its origin, a point along x and a point on the side of y, about 10 cm apart. Put the tip on the origin. Recording begins with the next step.";
pub(in crate::console) const TABLE_TASK: &str =
    "Touch each point with the tip and hold still for half a second. If a wrong point was recorded, remove it.";
pub(in crate::console) const VIEW_BEFORE: &str =
    "Bring the tip into the middle of the endoscope's picture and hold it still. Recording begins with the next step.";
pub(in crate::console) const VIEW_TASK: &str =
    "Look at the picture only. Move the tip about 3 cm each time, then hold still for half a second.";
pub(in crate::console) const VIEW_HANDLE_BEFORE: &str =
    "Hold the handle still in the middle of its range. Recording begins with the next step.";
pub(in crate::console) const VIEW_HANDLE_TASK: &str = "Look at the picture only. Move the handle about 3 cm each time, as if the tip followed, then hold still for half a second.";
pub(in crate::console) const TROCAR_BEFORE: &str =
    "Put the instrument through the trocar; the tip must be clear of tissue. Recording begins with the next step.";
pub(in crate::console) const TROCAR_TASK: &str =
    "Pivot the instrument to all sides by 10 degrees or more, at several depths. Lines are recorded while it moves.";

pub(in crate::console) const POSES: &str = "poses";
pub(in crate::console) const POINTS: &str = "points";
pub(in crate::console) const PLACES: &str = "places";
pub(in crate::console) const LINES: &str = "lines";

pub(in crate::console) const BY_TRACKER: &str = "Measure with the tracker instead of the arm's joints";
pub(in crate::console) const BY_TRACKER_HOVER: &str =
    "The tracker sees the patient's trocar move, which joints that are held in a configured trocar do not tell";
pub(in crate::console) const BY_HANDLE: &str = "Move the handle instead of the tip";
pub(in crate::console) const BY_HANDLE_HOVER: &str =
    "Do both, one after the other: then the handle's right is the picture's right";
pub(in crate::console) const NEEDS_HAND_EYE: &str = "Do the hand-eye calibration first";

pub(in crate::console) const PIVOT: &str = "Turn about the tip, then hold still";
pub(in crate::console) const TURN: &str = "Tilt and turn, then hold still";
pub(in crate::console) const PIVOT_IN_TROCAR: &str = "Pivot in the trocar, without a pause";
pub(in crate::console) const TOUCH_ORIGIN: &str = "Touch the origin";
pub(in crate::console) const TOUCH_X: &str = "Touch the point along x";
pub(in crate::console) const TOUCH_Y: &str = "Touch the point on the side of y";
pub(in crate::console) const TOUCH_FURTHER: &str = "Touch any other point of the table";
pub(in crate::console) const HOLD_STILL: &str = "Hold still where you begin";
pub(in crate::console) const THE_TIP: &str = "Tip";
pub(in crate::console) const THE_HANDLE: &str = "Handle";
pub(in crate::console) const ALL_RECORDED: &str = "All recorded: let go, and press Next";
pub(in crate::console) const PAUSED: &str = "paused";

pub(in crate::console) const STEP_CHECK_HOVER: &str = "Checks that everything that is needed sends data";
pub(in crate::console) const STEP_RECORD: &str = "Record";
pub(in crate::console) const STEP_RECORD_HOVER: &str = "Follow the instructions until all is recorded";
pub(in crate::console) const STEP_RESULT_HOVER: &str = "The result, its errors, and what it changes in the rig file";
pub(in crate::console) const STEP_SAVE_HOVER: &str =
    "Saves the record, and writes the numbers into the rig file; its comments stay";
pub(in crate::console) const CHECKS_TITLE: &str = "Before the recording";
pub(in crate::console) const CHECKS_HOVER: &str = "Everything that is needed must send data first";
pub(in crate::console) const CHECK_ARM: &str = "Joints of the arm";
pub(in crate::console) const CHECK_MARKER: &str = "Marker in sight of the tracker";
pub(in crate::console) const CHECK_HANDLE: &str = "Position of the handle";
pub(in crate::console) const CHECK_WRENCH: &str = "Force at the wrist";
pub(in crate::console) const OPTIONS_TITLE: &str = "How to measure";
pub(in crate::console) const OPTIONS_HOVER: &str = "Leave this off unless you need it";
pub(in crate::console) const NEEDS_ARM: &str = "This rig has no arm with joints";
pub(in crate::console) const NO_ARM: &str =
    "This rig has no arm with joints: choose a rig with devices on the start page, for example the emulated rig";
pub(in crate::console) const RECORD_TITLE: &str = "Do this now";
pub(in crate::console) const RECORD_HOVER: &str = "What to do until all is recorded";
pub(in crate::console) const PROGRESS: &str = "Now";
pub(in crate::console) const COVERAGE: &str = "Recorded";
pub(in crate::console) const REMOVE_LAST: &str = "Remove the last one";
pub(in crate::console) const PAUSE: &str = "Pause";
pub(in crate::console) const GO_ON: &str = "Go on";
pub(in crate::console) const PAUSE_HOVER: &str = "Records nothing until you go on";
pub(in crate::console) const NEEDS_MORE: &str = "Not enough is recorded yet";
pub(in crate::console) const NEEDS_RESULT: &str = "There is no result to save: go back and record more";
pub(in crate::console) const NO_RESULT_HOVER: &str = "Nothing could be computed from the recording";
pub(in crate::console) const TOO_FEW: &str = "Too little is recorded: go back and record more";
pub(in crate::console) const VERDICT_HOVER: &str = "Judged on data that were held out of the fit";
pub(in crate::console) const RECORDED_HOVER: &str = "How many were recorded";
pub(in crate::console) const LEFT_OUT: &str = "Left out";
pub(in crate::console) const LEFT_OUT_HOVER: &str = "These contradict the others and were not used";
pub(in crate::console) const HELD_OUT: &str = "Held-out error";
pub(in crate::console) const HELD_OUT_HOVER: &str = "Root mean square error on data that were not used for the fit";
pub(in crate::console) const HELD_OUT_MAX: &str = "Largest held-out error";
pub(in crate::console) const HELD_OUT_MAX_HOVER: &str = "The largest of these errors";
pub(in crate::console) const FITTED: &str = "Error in the fit";
pub(in crate::console) const FITTED_HOVER: &str = "Root mean square error on the data of the fit";
pub(in crate::console) const UNCERTAINTY: &str = "Known to within";
pub(in crate::console) const UNCERTAINTY_HOVER: &str = "Half the length of the 95 % interval of the result";
pub(in crate::console) const TOOL_MASS: &str = "Tool";
pub(in crate::console) const TOOL_MASS_HOVER: &str = "Mass that hangs on the sensor";
pub(in crate::console) const CHANGE_TITLE: &str = "What changes in the rig file";
pub(in crate::console) const CHANGE_HOVER: &str =
    "Nothing is changed before you save; afterwards the change can be undone";
pub(in crate::console) const NO_CHANGE: &str = "Nothing: the rig file is right";
pub(in crate::console) const WITHIN_UNCERTAINTY: &str =
    "The change is smaller than the uncertainty of the result: the rig file was right";
pub(in crate::console) const KEY: &str = "Key";
pub(in crate::console) const BEFORE: &str = "Now";
pub(in crate::console) const AFTER: &str = "New";
pub(in crate::console) const CHANGE: &str = "Change";
pub(in crate::console) const NOT_GIVEN: &str = "not given";
pub(in crate::console) const PROOF: &str = "Accepted on held-out data";
pub(in crate::console) const UNDO_TITLE: &str = "Undo";
pub(in crate::console) const UNDO_CARD_HOVER: &str =
    "The record keeps the values of before; they can be put back into the rig file";
pub(in crate::console) const UNDO: &str = "Put the values of before back";
pub(in crate::console) const UNDONE: &str = "The values of before are in the rig file again";

/// What the technician is to hold.
pub(in crate::console) fn hold(name: &str) -> String {
    format!("Hold still: {name}")
}

/// What is to be moved, and where to.
pub(in crate::console) fn moved(what: &str, way: &str) -> String {
    format!("{what}: {way}, then hold still")
}

/// How much is there, and what is missing most.
pub(in crate::console) fn coverage(count: usize, units: &str, missing: Option<&str>) -> String {
    let missing = missing.map_or_else(|| "complete".to_owned(), |missing| format!("still needed: {missing}"));
    format!("{count} {units}; {missing}")
}

/// The picture of a change in one sentence.
pub(in crate::console) fn effect(change: Option<[f64; 2]>) -> String {
    change.map_or_else(
        || "solid: found now; the rig file does not give it".to_owned(),
        |[m, deg]| {
            // A point has no angle, and a rotation no place.
            let moved = (m > 1e-9).then(|| format!("moved by {:.2} mm", m * 1e3));
            let turned = (deg > 1e-6).then(|| format!("turned by {deg:.2} deg"));
            let words: Vec<_> = moved.into_iter().chain(turned).collect();
            format!("dashed: now   solid: new   {}", words.join(", "))
        },
    )
}

/// Length of the scale.
pub(in crate::console) fn scale(length_m: f64) -> String {
    format!("{} mm", (length_m * 1e4).round() / 10.0)
}

/// How the mount that was found compares with the rig file's.
pub(in crate::console) fn mount_found(off_deg: f64, agrees: bool) -> String {
    let verdict = if agrees { "it agrees with the rig file" } else { "the rig file is wrong" };
    format!("The mount that was found differs by {off_deg:.1} deg: {verdict}")
}

/// Which axes are exchanged.
pub(in crate::console) fn mount_axes(axes: &str) -> String {
    format!("The sensor's x, y, z are the rig file's {axes}")
}

/// The rig file that was written.
pub(in crate::console) fn written(record: &std::path::Path, rig: &std::path::Path) -> String {
    format!("Saved: {}; in use: {}", record.display(), rig.display())
}
