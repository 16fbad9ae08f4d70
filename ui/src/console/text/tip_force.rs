//! The wizard that trains and checks the tip-force network.

pub(in crate::console) const STEP_READY: &str = "Ready";
pub(in crate::console) const STEP_READY_HOVER: &str = "Checks that everything needed for a recording is present";
pub(in crate::console) const STEP_RECORD: &str = "Record";
pub(in crate::console) const STEP_RECORD_HOVER: &str =
    "Work through the trocar while the sensor under the tissue measures the true force";
pub(in crate::console) const STEP_TRAIN: &str = "Train";
pub(in crate::console) const STEP_TRAIN_HOVER: &str =
    "Trains the network on the recording; you can go on working in this window";
pub(in crate::console) const STEP_CHECK_HOVER: &str =
    "A new, short recording that was not used for training shows how accurate the network is";
pub(in crate::console) const SIZE_SMALL: &str = "Small";
pub(in crate::console) const SIZE_USUAL: &str = "Default";
pub(in crate::console) const SIZE_LARGE: &str = "Large";
pub(in crate::console) const NEEDS_CORRESPONDENCE: &str = "The correspondence is not known: calibrate it first";
pub(in crate::console) const NEEDS_RECORDING: &str = "Nothing is recorded yet";
pub(in crate::console) const NEEDS_GOALS: &str = "Some goals are not met yet";
pub(in crate::console) const NEEDS_TRAINING_END: &str = "Wait until the training has finished, or cancel it";
pub(in crate::console) const NEEDS_NETWORK: &str = "No network is trained yet";
pub(in crate::console) const NEEDS_CHECK: &str = "The network is not checked yet";
pub(in crate::console) const RECORDING_DISCARDED: &str =
    "Sensor, tool or correspondence have changed: the recording made with the old ones was discarded";
pub(in crate::console) const CANCELLED: &str = "Cancelled. The recording is kept.";
pub(in crate::console) const NO_FOLDER: &str = "No folder for the recording was found: set NIMA_DATA_DIR";
pub(in crate::console) const NO_CHECKED_NETWORK: &str = "There is no checked network: go back";
pub(in crate::console) const CHECK_TITLE: &str = "A new recording";
pub(in crate::console) const CHECK_HOVER: &str =
    "Only data that were not used for training show how accurate the network is";
pub(in crate::console) const RECORD_MORE: &str = "Record more";
pub(in crate::console) const RECORD_MORE_HOVER: &str =
    "Goes back to the recording; new rows are added to the existing ones";
pub(in crate::console) const CHECK_PROGRESS: &str = "Rows of the check";
pub(in crate::console) const CHECK_JUDGING: &str = "The network is being evaluated";
pub(in crate::console) const CHECK_PAUSED: &str = "Paused: press \"Go on with the check\"";
pub(in crate::console) const CHECK_DONE: &str = "The check is complete";
pub(in crate::console) const PAUSE: &str = "Pause";
pub(in crate::console) const CHECK_GO_ON: &str = "Go on with the check";
pub(in crate::console) const CHECK_AGAIN: &str = "Check again";
pub(in crate::console) const CHECK_START: &str = "Start the check";
pub(in crate::console) const CHECK_WAIT: &str = "Wait for the result";
pub(in crate::console) const VERDICT_HOVER: &str =
    "Compared with the paper's figures, on rows recorded after the training";
pub(in crate::console) const VERDICT_OVERRIDE: &str = "You can still keep it under your name in the next step";
pub(in crate::console) const DOUBT_HOVER: &str = "Rows outside the range of the training data: there the network is not used and the fallback takes \
    over. At most 10 % are allowed.";
pub(in crate::console) const ERRORS_HOVER: &str = "All in N, along the axes of the wrist sensor (z along the shaft). MAE: mean absolute error. SD: \
    standard deviation of the error.";
pub(in crate::console) const ERRORS_TITLE: &str = "Errors in N, per axis of the wrist sensor";
pub(in crate::console) const AXIS: &str = "Axis";
pub(in crate::console) const WRIST_ALONE_MAE: &str = "wrist force\nalone: MAE";
pub(in crate::console) const FRICTION_MODEL_MAE: &str = "friction\nmodel: MAE";
pub(in crate::console) const NO_CONTACT_MEAN: &str = "no contact:\nmean (paper 0.02)";
pub(in crate::console) const NO_CONTACT_SD: &str = "no contact:\nSD (paper 0.03)";
pub(in crate::console) const REGRESSION_TITLE: &str = "Predicted against measured force";
pub(in crate::console) const REGRESSION_HOVER: &str =
    "Each point is one row; without error all points lie on the dashed line";
pub(in crate::console) const NO_CONTACT_TITLE: &str = "Predicted force without contact";
pub(in crate::console) const NO_CONTACT_HOVER: &str = "Without contact the predicted force should be zero";
pub(in crate::console) const MEASURED_AXIS: &str = "Measured (N)";
pub(in crate::console) const PREDICTED_AXIS: &str = "Predicted (N)";
pub(in crate::console) const REGRESSION_PLOT: &str = "Regression plot: predicted against measured force, three axes";
pub(in crate::console) const NO_CONTACT_AXIS: &str = "Predicted (N)";
pub(in crate::console) const SHARE_AXIS: &str = "Share of rows (%)";
pub(in crate::console) const NO_CONTACT_PLOT: &str = "Histogram of the predicted force without contact, three axes";
pub(in crate::console) const SOURCE_WRIST: &str = "Wrist sensor";
pub(in crate::console) const SOURCE_SILENT: &str = "no data; connect it";
pub(in crate::console) const SOURCE_GRAVITY: &str = "Gravity";
pub(in crate::console) const SOURCE_NO_GRAVITY: &str = "not calibrated; press \"Calibrate gravity…\" on the left";
pub(in crate::console) const SOURCE_TISSUE: &str = "Sensor under the tissue";
pub(in crate::console) const SOURCE_TRACKER: &str = "Arm and tracker";
pub(in crate::console) const SOURCE_NO_TRACKER: &str =
    "the tracker does not see the marker, or the arm sends no data; clear the line of sight and check the arm";
pub(in crate::console) const SOURCE_DEPTH: &str = "Depth through the trocar";
pub(in crate::console) const SOURCE_NO_DEPTH: &str = "unknown; mount the trocar and check the arm";
pub(in crate::console) const CHECKS_TITLE: &str = "Before the recording";
pub(in crate::console) const CHECKS_HOVER: &str = "All six checks must pass before rows are recorded";
pub(in crate::console) const CHECKS_TASK: &str =
    "Put the tissue on its sensor, put the instrument through the trocar, and hold its tip above the tissue";
pub(in crate::console) const SOURCE_CORRESPONDENCE: &str = "Correspondence";
pub(in crate::console) const SOURCE_NO_CORRESPONDENCE: &str =
    "not known; press \"Calibrate correspondence…\" on the left";
pub(in crate::console) const RECORD_HOVER: &str =
    "The person at the arm follows these instructions. A pause keeps all rows.";
pub(in crate::console) const RECORD_TITLE: &str = "Do this now";
pub(in crate::console) const TRAIN_ANYWAY: &str = "Train anyway";
pub(in crate::console) const TRAIN_ANYWAY_HOVER: &str =
    "Trains on the rows recorded so far. Such a network is not proven: you can keep it only under your name.";
pub(in crate::console) const TRAIN_ANYWAY_DISABLED_HOVER: &str = "Only for an incomplete recording";
pub(in crate::console) const ROWS: &str = "Rows";
pub(in crate::console) const RECORD_FIRST_STEP: &str =
    "Then press \"Start recording\": first, the sensor under the tissue is set to zero";
pub(in crate::console) const RECORD_COMPLETE: &str = "All goals are met: go on to the training, or record more";
pub(in crate::console) const RECORD_PAUSED: &str = "Paused: press \"Go on recording\"";
pub(in crate::console) const ADVICE_LATER: &str = "After that";
pub(in crate::console) const ADVICE_NOW: &str = "Still to do";
pub(in crate::console) const RECORD_START: &str = "Start recording";
pub(in crate::console) const GOALS_TITLE: &str = "Goals";
pub(in crate::console) const GOALS_HOVER: &str =
    "The recording must cover everything that the network will meet in use: meet all of these goals";
pub(in crate::console) const TILT_X: &str = "towards x";
pub(in crate::console) const TILT_Y: &str = "towards y (deg)";
pub(in crate::console) const FORCE_ACROSS: &str = "across the shaft";
pub(in crate::console) const FORCE_ALONG: &str = "along the shaft (N)";
pub(in crate::console) const TRAVEL_DEPTH: &str = "depth through the trocar";
pub(in crate::console) const TRAVEL_SPEED: &str = "inward speed (mm/s)";
pub(in crate::console) const COVERAGE_HOVER: &str =
    "The more rows a field holds, the brighter it is. The network can be trusted only where there are rows.";
pub(in crate::console) const COVERAGE_TITLE: &str = "Coverage of the recording (brighter: more rows)";
pub(in crate::console) const MAP_TILT: &str = "Tilt of the shaft";
pub(in crate::console) const MAP_FORCE: &str = "Force at the tip";
pub(in crate::console) const MAP_TRAVEL: &str = "Motion through the trocar";
pub(in crate::console) const TRAIN_HOVER: &str =
    "Trains four networks in parallel, each tested on a different part of the recording";
pub(in crate::console) const TRAIN_DATA: &str = "Recording";
pub(in crate::console) const TRAIN_DATA_HOVER: &str = "Saved to a file before the training starts";
pub(in crate::console) const TRAIN_CANCEL: &str = "Cancel training";
pub(in crate::console) const TRAIN_AGAIN: &str = "Train again";
pub(in crate::console) const TRAIN_START: &str = "Start training";
pub(in crate::console) const TRAIN_DISABLED_HOVER: &str = "Record first";
pub(in crate::console) const TRAIN_PROGRESS: &str = "Training";
pub(in crate::console) const LOSS_HOVER: &str = "Mean square error divided by the variance of the forces; 1 means that nothing was learned. \
    The held-out curve counts: its rows are not used to train that network.";
pub(in crate::console) const LOSS_TITLE: &str = "Loss of each network, by epoch";
pub(in crate::console) const SIZE: &str = "Size";
pub(in crate::console) const SIZE_HOVER: &str =
    "Neurons in the hidden layers. Published figures are for the default size.";
pub(in crate::console) const TRAIN_STARTING: &str = "saving the recording";
pub(in crate::console) const TRAIN_NOT_STARTED: &str = "not started";
pub(in crate::console) const TRAINED_TITLE: &str = "Trained";
pub(in crate::console) const TRAINED_HOVER: &str = "This network is used in the check";
pub(in crate::console) const ENSEMBLE: &str = "Ensemble";
pub(in crate::console) const ENSEMBLE_HOVER: &str =
    "The result is the mean of all networks; where they disagree, it is marked as in doubt";
pub(in crate::console) const HELD_OUT_LOSS: &str = "Held-out loss";
pub(in crate::console) const HELD_OUT_LOSS_HOVER: &str = "Mean of all networks; 1 means that nothing was learned";
pub(in crate::console) const TRAINED_STALE: &str = "New rows were recorded since: train again to use all of them";
pub(in crate::console) const EPOCH_AXIS: &str = "Epoch";
pub(in crate::console) const LOSS_AXIS: &str = "Mean square error (1: nothing learned)";
pub(in crate::console) const JOB_FAILED: &str = "It failed. Try again.";
pub(in crate::console) const PHASE_FULL: &str = "the recording is full; go on to the training";
pub(in crate::console) const PHASE_WRIST_SILENT: &str = "not recording: the wrist sensor sends no data; connect it";
pub(in crate::console) const PHASE_NOT_MOVED: &str = "waiting; move the instrument in or out by 2 mm";
pub(in crate::console) const TASK_WORK: &str =
    "Work where the task will be done: in and out, sideways, slowly and quickly, with and without contact";
pub(in crate::console) const TASK_WORK_FREE: &str =
    "Move in and out and sideways, slowly and quickly, without touching the tissue";
pub(in crate::console) const TASK_REST: &str = "Lift the tip off the tissue and hold it still";
pub(in crate::console) const DOUBT: &str = "In doubt";
pub(in crate::console) const TRAIN_STOPPING: &str = "stopping";
pub(in crate::console) const TRAIN_DONE: &str = "done";
pub(in crate::console) const RECORD_GO_ON: &str = "Go on recording";
pub(in crate::console) const PHASE_PAUSED: &str = "paused";
pub(in crate::console) const PHASE_RECORDING: &str = "recording";

/// The check failed.
pub(in crate::console) fn not_judged(error: &str) -> String {
    format!("The network could not be evaluated: {error}")
}

/// The training failed.
pub(in crate::console) fn not_trained(error: &str) -> String {
    format!("Not trained: {error}. The recording is kept.")
}

/// State of a recording.
pub(in crate::console) fn state(phase: &str) -> String {
    format!("State: {phase}")
}

/// Task of the person at the arm during the check.
pub(in crate::console) fn check_task(work_s: f64, free_s: f64) -> String {
    format!("{work_s:.0} s of work on the tissue, then {free_s:.0} s without touching it")
}

/// Result of the check.
pub(in crate::console) fn verdict(reason: &str) -> String {
    format!("Verdict: {reason}")
}

/// Share of samples for which the network was uncertain.
pub(in crate::console) fn doubt(percent: f64, rows: usize) -> String {
    format!("{percent:.1} % of {rows} rows")
}

/// The background thread could not be started.
pub(in crate::console) fn no_thread(error: &impl std::fmt::Display) -> String {
    format!("The background task could not be started: {error}")
}

/// A recording could not be saved.
pub(in crate::console) fn not_written(path: &std::path::Path, error: &impl std::fmt::Display) -> String {
    format!("The recording could not be written to {}: {error}", path.display())
}

/// Why the check cannot be passed: the training data were incomplete.
pub(in crate::console) fn trained_on_too_little(goal: &str) -> String {
    format!("the recording used for training is incomplete ({goal}); record more")
}

/// Length of the recording, compared with the paper's.
pub(in crate::console) fn rows_and_seconds(rows: usize, seconds: f64, paper_rows: usize, paper_s: f64) -> String {
    format!("{rows}, {seconds:.0} s (paper: {paper_rows}, {paper_s:.0} s)")
}

/// What is missing, and the requirement that it is for.
pub(in crate::console) fn advice(when: &str, advice: &str, goal: &str) -> String {
    format!("{when}: {advice} ({goal})")
}

/// No rows are being recorded.
pub(in crate::console) fn nothing_taken(why: &str) -> String {
    format!("not recording: {why}")
}

/// The sensor under the tissue is being zeroed.
pub(in crate::console) fn taking_zero(percent: f64) -> String {
    format!("setting the sensor under the tissue to zero: {percent:.0} %")
}

/// Size of the training.
pub(in crate::console) fn networks_on_rows(networks: usize, rows: usize) -> String {
    format!("{networks} networks on {rows} rows")
}

/// A requirement that the recording did not meet.
pub(in crate::console) fn not_complete(goal: &str) -> String {
    format!("The recording is incomplete ({goal}): you can keep this network only under your name")
}

/// Legend: loss of a network on held-out rows.
pub(in crate::console) fn held_out(network: usize) -> String {
    format!("{network} held out")
}

/// Legend: loss of a network on its training rows.
pub(in crate::console) fn training(network: usize) -> String {
    format!("{network} training")
}

/// The plot of the losses in one sentence.
pub(in crate::console) fn losses(networks: usize, epochs: usize) -> String {
    format!("Losses of {networks} networks over {epochs} epochs")
}

/// Progress of the check.
pub(in crate::console) fn rows_of(rows: usize, asked: usize) -> String {
    format!("{rows} of {asked}")
}

/// Size of a recording.
pub(in crate::console) fn rows_and_time(rows: usize, seconds: f64) -> String {
    format!("{rows} rows, {seconds:.0} s")
}

/// Progress of the training.
pub(in crate::console) fn time_left(percent: f64, elapsed_s: f64, left_s: f64) -> String {
    format!("{percent:.0} %, {elapsed_s:.0} s, at most {left_s:.0} s left")
}
