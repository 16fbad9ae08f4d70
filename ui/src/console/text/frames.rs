//! The wizards of the frame calibrations: sensor mount, tip, hand-eye, table, view, trocar.

use crate::language::{Text, told, word};

pub(in crate::console) const MOUNT: Text = Text::of("Sensor mount", "Sensor mount");
pub(in crate::console) const TIP: Text = Text::of("Tip", "Tip");
pub(in crate::console) const HAND_EYE: Text = Text::of("Hand-eye", "Hand-eye");
pub(in crate::console) const TABLE: Text = Text::of("Table", "Table");
pub(in crate::console) const VIEW: Text = Text::of("View", "View");
pub(in crate::console) const TROCAR: Text = Text::of("Trocar", "Trocar");
pub(in crate::console) const MOUNT_MEANING: Text = Text::of(
    "Checks how the wrist sensor is turned on the arm's flange",
    "Checks how the wrist sensor is turned on the arm's flange",
);
pub(in crate::console) const TIP_MEANING: Text = Text::of(
    "Finds the instrument's tip in the frame of the arm's flange",
    "Finds the instrument's tip in the frame of the arm's flange",
);
pub(in crate::console) const HAND_EYE_MEANING: Text = Text::of(
    "Finds the marker on the instrument, and the tracker beside the arm",
    "Finds the marker on the instrument, and the tracker beside the arm",
);
pub(in crate::console) const TABLE_MEANING: Text = Text::of(
    "Finds origin and plane of the workspace from points touched with the tip",
    "Finds origin and plane of the workspace from points touched with the tip",
);
pub(in crate::console) const VIEW_MEANING: Text = Text::of(
    "Finds how the endoscope's picture is turned against arm and handle",
    "Finds how the endoscope's picture is turned against arm and handle",
);
pub(in crate::console) const TROCAR_MEANING: Text =
    Text::of("Finds the point about which the instrument pivots", "Finds the point about which the instrument pivots");

pub(in crate::console) const MOUNT_BEFORE: Text = Text::of(
    "Take the instrument out of the trocar; nothing may touch it. Recording begins with the next step.",
    "Take the instrument out of the trocar; nothing may touch it. Recording begins with the next step.",
);
pub(in crate::console) const MOUNT_TASK: Text = Text::of(
    "Hold the tool still in each orientation until it is recorded",
    "Hold the tool still in each orientation until it is recorded",
);
pub(in crate::console) const TIP_BEFORE: Text = Text::of(
    "Take the instrument out of the trocar, and put its tip into a dimple that cannot move, such as a screw's recess. \
     Recording begins with the next step.",
    "Take the instrument out of the trocar, and put its tip into a dimple that cannot move, such as a screw's recess. \
     Recording begins with the next step.",
);
pub(in crate::console) const TIP_TASK: Text = Text::of(
    "Tilt to all sides by 20 to 30 degrees, and turn about the shaft. Hold each pose still for half a second. The tip \
     must stay in the dimple.",
    "Tilt to all sides by 20 to 30 degrees, and turn about the shaft. Hold each pose still for half a second. The tip \
     must stay in the dimple.",
);
pub(in crate::console) const HAND_EYE_BEFORE: Text = Text::of(
    "Take the instrument out of the trocar, and turn its marker towards the tracker. The other arm and its marker \
     rest. Recording begins with the next step.",
    "Take the instrument out of the trocar, and turn its marker towards the tracker. The other arm and its marker \
     rest. Recording begins with the next step.",
);
pub(in crate::console) const HAND_EYE_TASK: Text = Text::of(
    "Tilt and turn the instrument in every pose, also about its shaft; moves without turns tell nothing. Hold each \
     pose still for half a second.",
    "Tilt and turn the instrument in every pose, also about its shaft; moves without turns tell nothing. Hold each \
     pose still for half a second.",
);
pub(in crate::console) const TABLE_BEFORE: Text = Text::of(
    "Clear the table, and mark its origin, a point along x and a point on the side of y, about 10 cm apart. Put the \
     tip on the origin. Recording begins with the next step.",
    "Clear the table, and mark its origin, a point along x and a point on the side of y, about 10 cm apart. Put the \
     tip on the origin. Recording begins with the next step.",
);
pub(in crate::console) const TABLE_TASK: Text = Text::of(
    "Touch each point with the tip and hold still for half a second. If a wrong point was recorded, remove it.",
    "Touch each point with the tip and hold still for half a second. If a wrong point was recorded, remove it.",
);
pub(in crate::console) const VIEW_BEFORE: Text = Text::of(
    "Bring the tip into the middle of the endoscope's picture and hold it still. Recording begins with the next step.",
    "Bring the tip into the middle of the endoscope's picture and hold it still. Recording begins with the next step.",
);
pub(in crate::console) const VIEW_TASK: Text = Text::of(
    "Look at the picture only. Move the tip about 3 cm each time, then hold still for half a second.",
    "Look at the picture only. Move the tip about 3 cm each time, then hold still for half a second.",
);
pub(in crate::console) const VIEW_HANDLE_BEFORE: Text = Text::of(
    "Hold the handle still in the middle of its range. Recording begins with the next step.",
    "Hold the handle still in the middle of its range. Recording begins with the next step.",
);
pub(in crate::console) const VIEW_HANDLE_TASK: Text = Text::of(
    "Look at the picture only. Move the handle about 3 cm each time, as if the tip followed, then hold still for half \
     a second.",
    "Look at the picture only. Move the handle about 3 cm each time, as if the tip followed, then hold still for half \
     a second.",
);
pub(in crate::console) const TROCAR_BEFORE: Text = Text::of(
    "Put the instrument through the trocar; the tip must be clear of tissue. Recording begins with the next step.",
    "Put the instrument through the trocar; the tip must be clear of tissue. Recording begins with the next step.",
);
pub(in crate::console) const TROCAR_TASK: Text = Text::of(
    "Pivot the instrument to all sides by 10 degrees or more, at several depths. Lines are recorded while it moves.",
    "Pivot the instrument to all sides by 10 degrees or more, at several depths. Lines are recorded while it moves.",
);

pub(in crate::console) const POSES: Text = Text::of("poses", "poses");
pub(in crate::console) const POINTS: Text = Text::of("points", "points");
pub(in crate::console) const PLACES: Text = Text::of("places", "places");
pub(in crate::console) const LINES: Text = Text::of("lines", "lines");

pub(in crate::console) const BY_TRACKER: Text = Text::of(
    "Measure with the tracker instead of the arm's joints",
    "Measure with the tracker instead of the arm's joints",
);
pub(in crate::console) const BY_TRACKER_HOVER: Text = Text::of(
    "The tracker sees the patient's trocar move, which joints that are held in a configured trocar do not tell",
    "The tracker sees the patient's trocar move, which joints that are held in a configured trocar do not tell",
);
pub(in crate::console) const BY_HANDLE: Text =
    Text::of("Move the handle instead of the tip", "Move the handle instead of the tip");
pub(in crate::console) const BY_HANDLE_HOVER: Text = Text::of(
    "Do both, one after the other: then the handle's right is the picture's right",
    "Do both, one after the other: then the handle's right is the picture's right",
);
pub(in crate::console) const NEEDS_HAND_EYE: Text =
    Text::of("Do the hand-eye calibration first", "Do the hand-eye calibration first");

pub(in crate::console) const PIVOT: Text =
    Text::of("Turn about the tip, then hold still", "Turn about the tip, then hold still");
pub(in crate::console) const TURN: Text = Text::of("Tilt and turn, then hold still", "Tilt and turn, then hold still");
pub(in crate::console) const PIVOT_IN_TROCAR: Text =
    Text::of("Pivot in the trocar, without a pause", "Pivot in the trocar, without a pause");
pub(in crate::console) const TOUCH_ORIGIN: Text = Text::of("Touch the origin", "Touch the origin");
pub(in crate::console) const TOUCH_X: Text = Text::of("Touch the point along x", "Touch the point along x");
pub(in crate::console) const TOUCH_Y: Text =
    Text::of("Touch the point on the side of y", "Touch the point on the side of y");
pub(in crate::console) const TOUCH_FURTHER: Text =
    Text::of("Touch any other point of the table", "Touch any other point of the table");
pub(in crate::console) const HOLD_STILL: Text = Text::of("Hold still where you begin", "Hold still where you begin");
pub(in crate::console) const THE_TIP: Text = Text::of("Tip", "Tip");
pub(in crate::console) const THE_HANDLE: Text = Text::of("Handle", "Handle");
pub(in crate::console) const ALL_RECORDED: Text =
    Text::of("All recorded: let go, and press Next", "All recorded: let go, and press Next");
pub(in crate::console) const PAUSED: Text = Text::of("paused", "paused");

pub(in crate::console) const STEP_CHECK_HOVER: Text =
    Text::of("Checks that everything that is needed sends data", "Checks that everything that is needed sends data");
pub(in crate::console) const STEP_RECORD: Text = Text::of("Record", "Record");
pub(in crate::console) const STEP_RECORD_HOVER: Text =
    Text::of("Follow the instructions until all is recorded", "Follow the instructions until all is recorded");
pub(in crate::console) const STEP_RESULT_HOVER: Text = Text::of(
    "The result, its errors, and what it changes in the rig file",
    "The result, its errors, and what it changes in the rig file",
);
pub(in crate::console) const STEP_SAVE_HOVER: Text = Text::of(
    "Saves the record, and writes the numbers into the rig file; its comments stay",
    "Saves the record, and writes the numbers into the rig file; its comments stay",
);
pub(in crate::console) const CHECKS_TITLE: Text = Text::of("Before the recording", "Before the recording");
pub(in crate::console) const CHECKS_HOVER: Text =
    Text::of("Everything that is needed must send data first", "Everything that is needed must send data first");
pub(in crate::console) const CHECK_ARM: Text = Text::of("Joints of the arm", "Joints of the arm");
pub(in crate::console) const CHECK_MARKER: Text =
    Text::of("Marker in sight of the tracker", "Marker in sight of the tracker");
pub(in crate::console) const CHECK_HANDLE: Text = Text::of("Position of the handle", "Position of the handle");
pub(in crate::console) const CHECK_WRENCH: Text = Text::of("Force at the wrist", "Force at the wrist");
pub(in crate::console) const OPTIONS_TITLE: Text = Text::of("How to measure", "How to measure");
pub(in crate::console) const OPTIONS_HOVER: Text =
    Text::of("Leave this off unless you need it", "Leave this off unless you need it");
pub(in crate::console) const NEEDS_ARM: Text =
    Text::of("This rig has no arm with joints", "This rig has no arm with joints");
pub(in crate::console) const NO_ARM: Text = Text::of(
    "This rig has no arm with joints: choose a rig with devices on the start page, for example the emulated rig",
    "This rig has no arm with joints: choose a rig with devices on the start page, for example the emulated rig",
);
pub(in crate::console) const RECORD_TITLE: Text = Text::of("Do this now", "Do this now");
pub(in crate::console) const RECORD_HOVER: Text =
    Text::of("What to do until all is recorded", "What to do until all is recorded");
pub(in crate::console) const PROGRESS: Text = Text::of("Now", "Now");
pub(in crate::console) const COVERAGE: Text = Text::of("Recorded", "Recorded");
pub(in crate::console) const REMOVE_LAST: Text = Text::of("Remove the last one", "Remove the last one");
pub(in crate::console) const PAUSE: Text = Text::of("Pause", "Pause");
pub(in crate::console) const GO_ON: Text = Text::of("Go on", "Go on");
pub(in crate::console) const PAUSE_HOVER: Text =
    Text::of("Records nothing until you go on", "Records nothing until you go on");
pub(in crate::console) const NEEDS_MORE: Text = Text::of("Not enough is recorded yet", "Not enough is recorded yet");
pub(in crate::console) const NEEDS_RESULT: Text = Text::of(
    "There is no result to save: go back and record more",
    "There is no result to save: go back and record more",
);
pub(in crate::console) const NO_RESULT_HOVER: Text =
    Text::of("Nothing could be computed from the recording", "Nothing could be computed from the recording");
pub(in crate::console) const TOO_FEW: Text =
    Text::of("Too little is recorded: go back and record more", "Too little is recorded: go back and record more");
pub(in crate::console) const VERDICT_HOVER: Text =
    Text::of("Judged on data that were held out of the fit", "Judged on data that were held out of the fit");
pub(in crate::console) const RECORDED_HOVER: Text = Text::of("How many were recorded", "How many were recorded");
pub(in crate::console) const LEFT_OUT: Text = Text::of("Left out", "Left out");
pub(in crate::console) const LEFT_OUT_HOVER: Text =
    Text::of("These contradict the others and were not used", "These contradict the others and were not used");
pub(in crate::console) const HELD_OUT: Text = Text::of("Held-out error", "Held-out error");
pub(in crate::console) const HELD_OUT_HOVER: Text = Text::of(
    "Root mean square error on data that were not used for the fit",
    "Root mean square error on data that were not used for the fit",
);
pub(in crate::console) const HELD_OUT_MAX: Text = Text::of("Largest held-out error", "Largest held-out error");
pub(in crate::console) const HELD_OUT_MAX_HOVER: Text =
    Text::of("The largest of these errors", "The largest of these errors");
pub(in crate::console) const FITTED: Text = Text::of("Error in the fit", "Error in the fit");
pub(in crate::console) const FITTED_HOVER: Text =
    Text::of("Root mean square error on the data of the fit", "Root mean square error on the data of the fit");
pub(in crate::console) const UNCERTAINTY: Text = Text::of("Known to within", "Known to within");
pub(in crate::console) const UNCERTAINTY_HOVER: Text = Text::of(
    "Half the length of the 95 % interval of the result",
    "Half the length of the 95 % interval of the result",
);
pub(in crate::console) const TOOL_MASS: Text = Text::of("Tool", "Tool");
pub(in crate::console) const TOOL_MASS_HOVER: Text =
    Text::of("Mass that hangs on the sensor", "Mass that hangs on the sensor");
pub(in crate::console) const CHANGE_TITLE: Text =
    Text::of("What changes in the rig file", "What changes in the rig file");
pub(in crate::console) const CHANGE_HOVER: Text = Text::of(
    "Nothing is changed before you save; afterwards the change can be undone",
    "Nothing is changed before you save; afterwards the change can be undone",
);
pub(in crate::console) const NO_CHANGE: Text =
    Text::of("Nothing: the rig file is right", "Nothing: the rig file is right");
pub(in crate::console) const WITHIN_UNCERTAINTY: Text = Text::of(
    "The change is smaller than the uncertainty of the result: the rig file was right",
    "The change is smaller than the uncertainty of the result: the rig file was right",
);
pub(in crate::console) const KEY: Text = Text::of("Key", "Key");
pub(in crate::console) const BEFORE: Text = Text::of("Now", "Now");
pub(in crate::console) const AFTER: Text = Text::of("New", "New");
pub(in crate::console) const CHANGE: Text = Text::of("Change", "Change");
pub(in crate::console) const NOT_GIVEN: Text = Text::of("not given", "not given");
pub(in crate::console) const PROOF: Text = Text::of("Accepted on held-out data", "Accepted on held-out data");
pub(in crate::console) const UNDO_TITLE: Text = Text::of("Undo", "Undo");
pub(in crate::console) const UNDO_CARD_HOVER: Text = Text::of(
    "The record keeps the values of before; they can be put back into the rig file",
    "The record keeps the values of before; they can be put back into the rig file",
);
pub(in crate::console) const UNDO: Text = Text::of("Put the values of before back", "Put the values of before back");
pub(in crate::console) const UNDONE: Text =
    Text::of("The values of before are in the rig file again", "The values of before are in the rig file again");

/// What the technician is to hold.
pub(in crate::console) fn hold(name: &str) -> String {
    told!("Hold still: {name}", "Hold still: {name}")
}

/// What is to be moved, and where to.
pub(in crate::console) fn moved(what: &str, way: &str) -> String {
    told!("{what}: {way}, then hold still", "{what}: {way}, then hold still")
}

/// How much is there, and what is missing most.
pub(in crate::console) fn coverage(count: usize, units: &str, missing: Option<&str>) -> String {
    let missing = missing.map_or_else(
        || word("complete", "complete").to_owned(),
        |missing| told!("still needed: {missing}", "still needed: {missing}"),
    );
    format!("{count} {units}; {missing}")
}

/// The picture of a change in one sentence.
pub(in crate::console) fn effect(change: Option<[f64; 2]>) -> String {
    change.map_or_else(
        || {
            word("solid: found now; the rig file does not give it", "solid: found now; the rig file does not give it")
                .to_owned()
        },
        |[m, deg]| {
            // A point has no angle, and a rotation no place.
            let moved = (m > 1e-9).then(|| told!("moved by {:.2} mm", "moved by {:.2} mm", m * 1e3));
            let turned = (deg > 1e-6).then(|| told!("turned by {deg:.2} deg", "turned by {deg:.2} deg"));
            let words: Vec<_> = moved.into_iter().chain(turned).collect();
            told!("dashed: now   solid: new   {}", "dashed: now   solid: new   {}", words.join(", "))
        },
    )
}

/// Length of the scale.
pub(in crate::console) fn scale(length_m: f64) -> String {
    told!("{} mm", "{} mm", (length_m * 1e4).round() / 10.0)
}

/// How the mount that was found compares with the rig file's.
pub(in crate::console) fn mount_found(off_deg: f64, agrees: bool) -> String {
    let verdict = if agrees {
        word("it agrees with the rig file", "it agrees with the rig file")
    } else {
        word("the rig file is wrong", "the rig file is wrong")
    };
    told!(
        "The mount that was found differs by {off_deg:.1} deg: {verdict}",
        "The mount that was found differs by {off_deg:.1} deg: {verdict}"
    )
}

/// Which axes are exchanged.
pub(in crate::console) fn mount_axes(axes: &str) -> String {
    told!("The sensor's x, y, z are the rig file's {axes}", "The sensor's x, y, z are the rig file's {axes}")
}

/// The rig file that was written.
pub(in crate::console) fn written(record: &std::path::Path, rig: &std::path::Path) -> String {
    told!("Saved: {}; in use: {}", "Saved: {}; in use: {}", record.display(), rig.display())
}
