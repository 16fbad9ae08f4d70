//! Words of the room `tip_force`.

pub(in crate::console) const READY: &str = "Ready";
pub(in crate::console) const IS_EVERYTHING_THERE_THAT: &str = "Is everything there that a recording needs?";
pub(in crate::console) const RECORD: &str = "Record";
pub(in crate::console) const WORK_THROUGH_THE_TROCAR: &str =
    "Work through the trocar while the sensor under the tissue tells the truth.";
pub(in crate::console) const TRAIN: &str = "Train";
pub(in crate::console) const THE_NETWORK_LEARNS_FROM: &str =
    "The network learns from the recording; the window stays alive.";
pub(in crate::console) const CHECK: &str = "Check";
pub(in crate::console) const A_NEW_SHORT_RECORDING: &str =
    "A new, short recording that the network has never seen tells how good it is.";
pub(in crate::console) const SAVE: &str = "Save";
pub(in crate::console) const KEPT_FOR_THIS_SENSOR: &str = "Kept for this sensor and this tool, with its figures.";
pub(in crate::console) const SMALL: &str = "Small";
pub(in crate::console) const USUAL: &str = "Usual";
pub(in crate::console) const LARGE: &str = "Large";
pub(in crate::console) const THE_CORRESPONDENCE_IS_NOT: &str = "The correspondence is not known: calibrate it first.";
pub(in crate::console) const A_CHECK_IS_NOT: &str = "A check is not met yet.";
pub(in crate::console) const NOTHING_IS_RECORDED_YET: &str = "Nothing is recorded yet.";
pub(in crate::console) const NOT_ALL_GOALS_ARE: &str = "Not all goals are met yet.";
pub(in crate::console) const WAIT_FOR_THE_TRAINING: &str = "Wait for the training, or cancel it.";
pub(in crate::console) const NO_NETWORK_IS_TRAINED: &str = "No network is trained yet.";
pub(in crate::console) const THE_NETWORK_IS_NOT: &str = "The network is not checked yet.";
pub(in crate::console) const SENSOR_TOOL_OR_CORRESPONDENCE: &str =
    "Sensor, tool or correspondence have changed: what was recorded with the others was put away.";
pub(in crate::console) const CANCELLED_THE_RECORDING_IS: &str = "Cancelled. The recording is kept.";
pub(in crate::console) const NO_FOLDER_FOR_THE: &str = "No folder for the recording is known: set NIMA_DATA_DIR.";
pub(in crate::console) const THERE_IS_NO_CHECKED: &str = "There is no checked network: go back.";
pub(in crate::console) const A_NEW_RECORDING: &str = "A new recording";
pub(in crate::console) const ROWS_THAT_THE_NETWORK: &str =
    "Rows that the network has never seen: only they tell how good it is.";
pub(in crate::console) const RECORD_MORE: &str = "Record more";
pub(in crate::console) const BACK_TO_THE_RECORDING: &str =
    "Back to the recording; new rows are added to those that are there.";
pub(in crate::console) const ROWS_OF_THE_CHECK: &str = "Rows of the check";
pub(in crate::console) const THE_NETWORK_IS_BEING: &str = "The network is being judged";
pub(in crate::console) const PAUSED_PRESS_GO_ON: &str = "Paused: press \"Go on with the check\"";
pub(in crate::console) const THE_CHECK_IS_DONE: &str = "The check is done";
pub(in crate::console) const PAUSE: &str = "Pause";
pub(in crate::console) const GO_ON_WITH_THE: &str = "Go on with the check";
pub(in crate::console) const CHECK_AGAIN: &str = "Check again";
pub(in crate::console) const START_THE_CHECK: &str = "Start the check";
pub(in crate::console) const WAIT_FOR_THE_VERDICT: &str = "Wait for the verdict.";
pub(in crate::console) const BY_THE_PAPER_S: &str = "By the paper's figures, on rows recorded after the training.";
pub(in crate::console) const IT_CAN_STILL_BE: &str = "It can still be kept under somebody's name in the next step.";
pub(in crate::console) const ROWS_OUTSIDE_OF_WHAT: &str =
    "Rows outside of what was trained: there the fallback answers. At most 10 %.";
pub(in crate::console) const ALL_IN_N_IN: &str = "All in N, in the axes of the wrist sensor (z along the shaft). MAE: mean absolute error. SD: standard deviation of the error.";
pub(in crate::console) const ERRORS_IN_N_PER: &str = "Errors in N, per axis of the wrist sensor";
pub(in crate::console) const AXIS: &str = "Axis";
pub(in crate::console) const WRIST_FORCE_ALONE_MAE: &str = "wrist force\nalone: MAE";
pub(in crate::console) const FRICTION_MODEL_MAE: &str = "friction\nmodel: MAE";
pub(in crate::console) const NO_CONTACT_MEAN_PAPER: &str = "no contact:\nmean (paper 0.02)";
pub(in crate::console) const NO_CONTACT_SD_PAPER: &str = "no contact:\nSD (paper 0.03)";
pub(in crate::console) const MEASURED_AGAINST_PREDICTED: &str = "Measured against predicted";
pub(in crate::console) const A_PERFECT_NETWORK_LIES: &str = "A perfect network lies on the dashed line.";
pub(in crate::console) const ANSWERS_WITHOUT_CONTACT: &str = "Answers without contact";
pub(in crate::console) const ALL_OF_IT_SHOULD: &str = "All of it should stand at zero.";
pub(in crate::console) const MEASURED_N: &str = "Measured (N)";
pub(in crate::console) const PREDICTED_N: &str = "Predicted (N)";
pub(in crate::console) const REGRESSION_PLOT_MEASURED_AGAINST: &str =
    "Regression plot: measured against predicted force, three axes";
pub(in crate::console) const ANSWER_N: &str = "Answer (N)";
pub(in crate::console) const SHARE_OF_ROWS: &str = "Share of rows (%)";
pub(in crate::console) const HISTOGRAM_OF_THE_ANSWERS: &str = "Histogram of the answers without contact, three axes";
pub(in crate::console) const WRIST_SENSOR: &str = "Wrist sensor";
pub(in crate::console) const SILENT_CONNECT_IT: &str = "silent; connect it";
pub(in crate::console) const GRAVITY: &str = "Gravity";
pub(in crate::console) const NOT_IN_FORCE_PRESS: &str = "not in force; press \"Calibrate gravity...\" on the left";
pub(in crate::console) const SENSOR_UNDER_THE_TISSUE: &str = "Sensor under the tissue";
pub(in crate::console) const ARM_AND_TRACKER: &str = "Arm and tracker";
pub(in crate::console) const THE_TRACKER_DOES_NOT: &str =
    "the tracker does not see the marker, or the arm is silent; clear its sight";
pub(in crate::console) const DEPTH_THROUGH_THE_TROCAR: &str = "Depth through the trocar";
pub(in crate::console) const NOT_TOLD_MOUNT_THE: &str = "not told; mount the trocar and check the arm";
pub(in crate::console) const BEFORE_THE_RECORDING: &str = "Before the recording";
pub(in crate::console) const ALL_SIX_MUST_BE: &str = "All six must be met before rows are taken.";
pub(in crate::console) const LAY_THE_TISSUE_ON: &str =
    "Lay the tissue on its sensor, put the instrument through the trocar, and hold its tip above the tissue.";
pub(in crate::console) const CORRESPONDENCE: &str = "Correspondence";
pub(in crate::console) const NOT_KNOWN_PRESS_CALIBRATE: &str =
    "not known; press \"Calibrate correspondence...\" on the left";
pub(in crate::console) const THE_PERSON_AT_THE: &str =
    "The person at the arm does what stands here. A pause keeps all rows.";
pub(in crate::console) const DO_THIS_NOW: &str = "Do this now";
pub(in crate::console) const TRAIN_ANYWAY: &str = "Train anyway";
pub(in crate::console) const TRAINS_ON_WHAT_THERE: &str =
    "Trains on what there is. Such a network is not proven: it can be kept only under a name.";
pub(in crate::console) const FOR_A_RECORDING_THAT: &str = "For a recording that is not complete.";
pub(in crate::console) const ROWS: &str = "Rows";
pub(in crate::console) const THEN_PRESS_START_RECORDING: &str =
    "Then press \"Start recording\": the zero of the sensor under the tissue is taken first.";
pub(in crate::console) const ALL_GOALS_ARE_MET: &str = "All goals are met: go on to the training, or record more";
pub(in crate::console) const PAUSED_PRESS_GO_ON_RECORDING: &str = "Paused: press \"Go on recording\"";
pub(in crate::console) const AFTER_THAT: &str = "After that";
pub(in crate::console) const STILL_TO_DO: &str = "Still to do";
pub(in crate::console) const START_RECORDING: &str = "Start recording";
pub(in crate::console) const GOALS: &str = "Goals";
pub(in crate::console) const WHAT_THE_NETWORK_WILL: &str =
    "What the network will meet must be in the recording, in all of these respects.";
pub(in crate::console) const TOWARDS_X: &str = "towards x";
pub(in crate::console) const TOWARDS_Y_DEG: &str = "towards y (deg)";
pub(in crate::console) const ACROSS_THE_SHAFT: &str = "across the shaft";
pub(in crate::console) const ALONG_THE_SHAFT_N: &str = "along the shaft (N)";
pub(in crate::console) const DEPTH_THROUGH_THE_TROCAR_2: &str = "depth through the trocar";
pub(in crate::console) const SPEED_INWARDS_MM_S: &str = "speed inwards (mm/s)";
pub(in crate::console) const EACH_FIELD_IS_BRIGHTER: &str =
    "Each field is brighter the more rows lie in it. The network may be trusted only where there are some.";
pub(in crate::console) const WHAT_THE_RECORDING_HOLDS: &str = "What the recording holds (brighter: more rows)";
pub(in crate::console) const TILT_OF_THE_SHAFT: &str = "Tilt of the shaft";
pub(in crate::console) const FORCE_AT_THE_TIP: &str = "Force at the tip";
pub(in crate::console) const MOTION_THROUGH_THE_TROCAR: &str = "Motion through the trocar";
pub(in crate::console) const FOUR_NETWORKS_LEARN_SIDE: &str =
    "Four networks learn side by side, each judged by another part of the recording.";
pub(in crate::console) const RECORDING: &str = "Recording";
pub(in crate::console) const IT_IS_WRITTEN_TO: &str = "It is written to a file first, so that nothing is lost.";
pub(in crate::console) const CANCEL_TRAINING: &str = "Cancel training";
pub(in crate::console) const TRAIN_AGAIN: &str = "Train again";
pub(in crate::console) const START_TRAINING: &str = "Start training";
pub(in crate::console) const RECORD_FIRST: &str = "Record first.";
pub(in crate::console) const TRAINING: &str = "Training";
pub(in crate::console) const MEAN_SQUARE_ERROR_IN: &str = "Mean square error in squares of the forces' standard deviation: 1 is knowing nothing. What counts \
                       is the held-out one, of rows that this network never learns from.";
pub(in crate::console) const LOSS_OF_EACH_NETWORK: &str = "Loss of each network, epoch by epoch";
pub(in crate::console) const SIZE: &str = "Size";
pub(in crate::console) const NEURONS_IN_THE_HIDDEN: &str =
    "Neurons in the hidden layers. The usual size is the one that was measured.";
pub(in crate::console) const WRITING_THE_RECORDING_THEN: &str = "writing the recording, then beginning";
pub(in crate::console) const NOT_BEGUN: &str = "not begun";
pub(in crate::console) const TRAINED: &str = "Trained";
pub(in crate::console) const THE_NETWORK_THAT_GOES: &str = "The network that goes on to the check.";
pub(in crate::console) const ENSEMBLE: &str = "Ensemble";
pub(in crate::console) const THEIR_MEAN_IS_THE: &str = "Their mean is the answer; where they disagree it is in doubt.";
pub(in crate::console) const HELD_OUT_LOSS: &str = "Held-out loss";
pub(in crate::console) const MEAN_OVER_THE_NETWORKS: &str = "Mean over the networks; 1 is knowing nothing.";
pub(in crate::console) const THE_RECORDING_HAS_GROWN: &str =
    "The recording has grown since: train again to use all of it.";
pub(in crate::console) const EPOCH: &str = "Epoch";
pub(in crate::console) const MEAN_SQUARE_ERROR_1: &str = "Mean square error (1: knows nothing)";
pub(in crate::console) const IT_BROKE_OFF_TRY: &str = "It broke off. Try again.";
pub(in crate::console) const THE_RECORDING_IS_FULL: &str = "the recording is full; go on to the training";
pub(in crate::console) const NOTHING_IS_TAKEN_THE: &str = "nothing is taken: the wrist sensor is silent; connect it";
pub(in crate::console) const WAITING_UNTIL_THE_INSTRUMENT: &str =
    "waiting until the instrument has moved in or out by 2 mm";
pub(in crate::console) const WORK_ON_THE_TISSUE: &str = "Work on the tissue: in and out, sideways, in contact and free";
pub(in crate::console) const MOVE_IN_AND_OUT: &str = "Move in and out and sideways without touching the tissue";
pub(in crate::console) const LIFT_THE_TIP_OFF: &str = "Lift the tip off the tissue and hold it still";

/// The check broke off.
pub(in crate::console) fn not_judged(error: &str) -> String {
    format!("The network could not be judged: {error}.")
}

/// The training broke off.
pub(in crate::console) fn not_trained(error: &str) -> String {
    format!("Not trained: {error}. The recording is kept.")
}

/// What a recording is doing.
pub(in crate::console) fn state(phase: &str) -> String {
    format!("State: {phase}.")
}

/// What the check asks for.
pub(in crate::console) fn check_task(work_s: f64, free_s: f64) -> String {
    format!("{work_s:.0} s of work on the tissue, then {free_s:.0} s without touching it")
}

/// What the check found.
pub(in crate::console) fn verdict(reason: &str) -> String {
    format!("Verdict: {reason}.")
}

/// How often the network was in doubt.
pub(in crate::console) fn doubt(percent: f64, rows: usize) -> String {
    format!("{percent:.1} % of {rows} rows")
}

/// There is nothing to work in the background.
pub(in crate::console) fn no_thread(error: &impl std::fmt::Display) -> String {
    format!("No thread could be started: {error}")
}

/// A recording was not kept.
pub(in crate::console) fn not_written(path: &std::path::Path, error: &impl std::fmt::Display) -> String {
    format!("The recording could not be written to {}: {error}", path.display())
}

/// Why good figures prove nothing.
pub(in crate::console) fn trained_on_too_little(goal: &str) -> String {
    format!("the recording it was trained on was not complete ({goal}); record more")
}

/// Length of the recording, beside the paper's.
pub(in crate::console) fn rows_and_seconds(rows: usize, seconds: f64, paper_rows: usize, paper_s: f64) -> String {
    format!("{rows}, {seconds:.0} s (the paper has {paper_rows}, {paper_s:.0} s)")
}

/// What is missing, and the goal that asks for it.
pub(in crate::console) fn advice(when: &str, advice: &str, goal: &str) -> String {
    format!("{when}: {advice} ({goal}).")
}

/// No rows come.
pub(in crate::console) fn nothing_taken(why: &str) -> String {
    format!("nothing is taken: {why}")
}

/// The zero is being taken.
pub(in crate::console) fn taking_zero(percent: f64) -> String {
    format!("zero of the sensor under the tissue: {percent:.0} %")
}

/// What was trained.
pub(in crate::console) fn networks_on_rows(networks: usize, rows: usize) -> String {
    format!("{networks} networks on {rows} rows")
}

/// The recording lacked something.
pub(in crate::console) fn not_complete(goal: &str) -> String {
    format!("Its recording was not complete ({goal}): it can be kept only under somebody's name.")
}

/// A line of the losses, by a network on rows that it has not seen.
pub(in crate::console) fn held_out(network: usize) -> String {
    format!("{network} held out")
}

/// A line of the losses, by a network on its own rows.
pub(in crate::console) fn training(network: usize) -> String {
    format!("{network} training")
}

/// The losses in one sentence.
pub(in crate::console) fn losses(networks: usize, epochs: usize) -> String {
    format!("Losses of {networks} networks over {epochs} epochs")
}
