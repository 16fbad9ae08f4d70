//! The wizard that trains and checks the tip-force network.

use crate::language::{Text, told};

pub(in crate::console) const STEP_READY: Text = Text::of("Ready", "Ready");
pub(in crate::console) const STEP_READY_HOVER: Text = Text::of(
    "Checks that everything needed for a recording is present",
    "Checks that everything needed for a recording is present",
);
pub(in crate::console) const STEP_RECORD: Text = Text::of("Record", "Record");
pub(in crate::console) const STEP_RECORD_HOVER: Text = Text::of(
    "Work through the trocar while the sensor under the tissue measures the true force",
    "Work through the trocar while the sensor under the tissue measures the true force",
);
pub(in crate::console) const STEP_TRAIN: Text = Text::of("Train", "Train");
pub(in crate::console) const STEP_TRAIN_HOVER: Text = Text::of(
    "Trains the network on the recording; you can go on working in this window",
    "Trains the network on the recording; you can go on working in this window",
);
pub(in crate::console) const STEP_CHECK_HOVER: Text = Text::of(
    "A new, short recording that was not used for training shows how accurate the network is",
    "A new, short recording that was not used for training shows how accurate the network is",
);
pub(in crate::console) const SIZE_SMALL: Text = Text::of("Small", "Small");
pub(in crate::console) const SIZE_USUAL: Text = Text::of("Default", "Default");
pub(in crate::console) const SIZE_LARGE: Text = Text::of("Large", "Large");
pub(in crate::console) const NEEDS_CORRESPONDENCE: Text = Text::of(
    "The correspondence is not known: calibrate it first",
    "The correspondence is not known: calibrate it first",
);
pub(in crate::console) const NEEDS_RECORDING: Text = Text::of("Nothing is recorded yet", "Nothing is recorded yet");
pub(in crate::console) const NEEDS_GOALS: Text = Text::of("Some goals are not met yet", "Some goals are not met yet");
pub(in crate::console) const NEEDS_TRAINING_END: Text = Text::of(
    "Wait until the training has finished, or cancel it",
    "Wait until the training has finished, or cancel it",
);
pub(in crate::console) const NEEDS_NETWORK: Text = Text::of("No network is trained yet", "No network is trained yet");
pub(in crate::console) const NEEDS_CHECK: Text =
    Text::of("The network is not checked yet", "The network is not checked yet");
pub(in crate::console) const RECORDING_DISCARDED: Text = Text::of(
    "Sensor, tool or correspondence have changed: the recording made with the old ones was discarded",
    "Sensor, tool or correspondence have changed: the recording made with the old ones was discarded",
);
pub(in crate::console) const CANCELLED: Text =
    Text::of("Cancelled. The recording is kept.", "Cancelled. The recording is kept.");
pub(in crate::console) const NO_FOLDER: Text = Text::of(
    "No folder for the recording was found: set NIMA_DATA_DIR",
    "No folder for the recording was found: set NIMA_DATA_DIR",
);
pub(in crate::console) const NO_CHECKED_NETWORK: Text =
    Text::of("There is no checked network: go back", "There is no checked network: go back");
pub(in crate::console) const CHECK_TITLE: Text = Text::of("A new recording", "A new recording");
pub(in crate::console) const CHECK_HOVER: Text = Text::of(
    "Only data that were not used for training show how accurate the network is",
    "Only data that were not used for training show how accurate the network is",
);
pub(in crate::console) const RECORD_MORE: Text = Text::of("Record more", "Record more");
pub(in crate::console) const RECORD_MORE_HOVER: Text = Text::of(
    "Goes back to the recording; new rows are added to the existing ones",
    "Goes back to the recording; new rows are added to the existing ones",
);
pub(in crate::console) const CHECK_PROGRESS: Text = Text::of("Rows of the check", "Rows of the check");
pub(in crate::console) const CHECK_JUDGING: Text =
    Text::of("The network is being evaluated", "The network is being evaluated");
pub(in crate::console) const CHECK_PAUSED: Text =
    Text::of("Paused: press \"Go on with the check\"", "Paused: press \"Go on with the check\"");
pub(in crate::console) const CHECK_DONE: Text = Text::of("The check is complete", "The check is complete");
pub(in crate::console) const PAUSE: Text = Text::of("Pause", "Pause");
pub(in crate::console) const CHECK_GO_ON: Text = Text::of("Go on with the check", "Go on with the check");
pub(in crate::console) const CHECK_AGAIN: Text = Text::of("Check again", "Check again");
pub(in crate::console) const CHECK_START: Text = Text::of("Start the check", "Start the check");
pub(in crate::console) const CHECK_WAIT: Text = Text::of("Wait for the result", "Wait for the result");
pub(in crate::console) const VERDICT_HOVER: Text = Text::of(
    "Compared with the paper's figures, on rows recorded after the training",
    "Compared with the paper's figures, on rows recorded after the training",
);
pub(in crate::console) const VERDICT_OVERRIDE: Text = Text::of(
    "You can still keep it under your name in the next step",
    "You can still keep it under your name in the next step",
);
pub(in crate::console) const DOUBT_HOVER: Text = Text::of(
    "Rows outside the range of the training data: there the network is not used and the fallback takes \
    over. At most 10 % are allowed.",
    "Rows outside the range of the training data: there the network is not used and the fallback takes \
    over. At most 10 % are allowed.",
);
pub(in crate::console) const ERRORS_HOVER: Text = Text::of(
    "All in N, along the axes of the wrist sensor (z along the shaft). MAE: mean absolute error. SD: \
    standard deviation of the error.",
    "All in N, along the axes of the wrist sensor (z along the shaft). MAE: mean absolute error. SD: \
    standard deviation of the error.",
);
pub(in crate::console) const ERRORS_TITLE: Text =
    Text::of("Errors in N, per axis of the wrist sensor", "Errors in N, per axis of the wrist sensor");
pub(in crate::console) const AXIS: Text = Text::of("Axis", "Axis");
pub(in crate::console) const WRIST_ALONE_MAE: Text = Text::of("wrist force\nalone: MAE", "wrist force\nalone: MAE");
pub(in crate::console) const FRICTION_MODEL_MAE: Text = Text::of("friction\nmodel: MAE", "friction\nmodel: MAE");
pub(in crate::console) const NO_CONTACT_MEAN: Text =
    Text::of("no contact:\nmean (paper 0.02)", "no contact:\nmean (paper 0.02)");
pub(in crate::console) const NO_CONTACT_SD: Text =
    Text::of("no contact:\nSD (paper 0.03)", "no contact:\nSD (paper 0.03)");
pub(in crate::console) const REGRESSION_TITLE: Text =
    Text::of("Predicted against measured force", "Predicted against measured force");
pub(in crate::console) const REGRESSION_HOVER: Text = Text::of(
    "Each point is one row; without error all points lie on the dashed line",
    "Each point is one row; without error all points lie on the dashed line",
);
pub(in crate::console) const NO_CONTACT_TITLE: Text =
    Text::of("Predicted force without contact", "Predicted force without contact");
pub(in crate::console) const NO_CONTACT_HOVER: Text = Text::of(
    "Without contact the predicted force should be zero",
    "Without contact the predicted force should be zero",
);
pub(in crate::console) const MEASURED_AXIS: Text = Text::of("Measured (N)", "Measured (N)");
pub(in crate::console) const PREDICTED_AXIS: Text = Text::of("Predicted (N)", "Predicted (N)");
pub(in crate::console) const REGRESSION_PLOT: Text = Text::of(
    "Regression plot: predicted against measured force, three axes",
    "Regression plot: predicted against measured force, three axes",
);
pub(in crate::console) const NO_CONTACT_AXIS: Text = Text::of("Predicted (N)", "Predicted (N)");
pub(in crate::console) const SHARE_AXIS: Text = Text::of("Share of rows (%)", "Share of rows (%)");
pub(in crate::console) const NO_CONTACT_PLOT: Text = Text::of(
    "Histogram of the predicted force without contact, three axes",
    "Histogram of the predicted force without contact, three axes",
);
pub(in crate::console) const SOURCE_WRIST: Text = Text::of("Wrist sensor", "Wrist sensor");
pub(in crate::console) const SOURCE_SILENT: Text = Text::of("no data; connect it", "no data; connect it");
pub(in crate::console) const SOURCE_GRAVITY: Text = Text::of("Gravity", "Gravity");
pub(in crate::console) const SOURCE_NO_GRAVITY: Text = Text::of(
    "not calibrated; press \"Calibrate gravity…\" on the left",
    "not calibrated; press \"Calibrate gravity…\" on the left",
);
pub(in crate::console) const SOURCE_TISSUE: Text = Text::of("Sensor under the tissue", "Sensor under the tissue");
pub(in crate::console) const SOURCE_TRACKER: Text = Text::of("Arm and tracker", "Arm and tracker");
pub(in crate::console) const SOURCE_NO_TRACKER: Text = Text::of(
    "the tracker does not see the marker, or the arm sends no data; clear the line of sight and check the arm",
    "the tracker does not see the marker, or the arm sends no data; clear the line of sight and check the arm",
);
pub(in crate::console) const SOURCE_DEPTH: Text = Text::of("Depth through the trocar", "Depth through the trocar");
pub(in crate::console) const SOURCE_NO_DEPTH: Text =
    Text::of("unknown; mount the trocar and check the arm", "unknown; mount the trocar and check the arm");
pub(in crate::console) const CHECKS_TITLE: Text = Text::of("Before the recording", "Before the recording");
pub(in crate::console) const CHECKS_HOVER: Text =
    Text::of("All six checks must pass before rows are recorded", "All six checks must pass before rows are recorded");
pub(in crate::console) const CHECKS_TASK: Text = Text::of(
    "Put the tissue on its sensor, put the instrument through the trocar, and hold its tip above the tissue",
    "Put the tissue on its sensor, put the instrument through the trocar, and hold its tip above the tissue",
);
pub(in crate::console) const SOURCE_CORRESPONDENCE: Text = Text::of("Correspondence", "Correspondence");
pub(in crate::console) const SOURCE_NO_CORRESPONDENCE: Text = Text::of(
    "not known; press \"Calibrate correspondence…\" on the left",
    "not known; press \"Calibrate correspondence…\" on the left",
);
pub(in crate::console) const RECORD_HOVER: Text = Text::of(
    "The person at the arm follows these instructions. A pause keeps all rows.",
    "The person at the arm follows these instructions. A pause keeps all rows.",
);
pub(in crate::console) const RECORD_TITLE: Text = Text::of("Do this now", "Do this now");
pub(in crate::console) const TRAIN_ANYWAY: Text = Text::of("Train anyway", "Train anyway");
pub(in crate::console) const TRAIN_ANYWAY_HOVER: Text = Text::of(
    "Trains on the rows recorded so far. Such a network is not proven: you can keep it only under your name.",
    "Trains on the rows recorded so far. Such a network is not proven: you can keep it only under your name.",
);
pub(in crate::console) const TRAIN_ANYWAY_DISABLED_HOVER: Text =
    Text::of("Only for an incomplete recording", "Only for an incomplete recording");
pub(in crate::console) const ROWS: Text = Text::of("Rows", "Rows");
pub(in crate::console) const RECORD_FIRST_STEP: Text = Text::of(
    "Then press \"Start recording\": first, the sensor under the tissue is set to zero",
    "Then press \"Start recording\": first, the sensor under the tissue is set to zero",
);
pub(in crate::console) const RECORD_COMPLETE: Text = Text::of(
    "All goals are met: go on to the training, or record more",
    "All goals are met: go on to the training, or record more",
);
pub(in crate::console) const RECORD_PAUSED: Text =
    Text::of("Paused: press \"Go on recording\"", "Paused: press \"Go on recording\"");
pub(in crate::console) const ADVICE_LATER: Text = Text::of("After that", "After that");
pub(in crate::console) const ADVICE_NOW: Text = Text::of("Still to do", "Still to do");
pub(in crate::console) const RECORD_START: Text = Text::of("Start recording", "Start recording");
pub(in crate::console) const GOALS_TITLE: Text = Text::of("Goals", "Goals");
pub(in crate::console) const GOALS_HOVER: Text = Text::of(
    "The recording must cover everything that the network will meet in use: meet all of these goals",
    "The recording must cover everything that the network will meet in use: meet all of these goals",
);
pub(in crate::console) const TILT_X: Text = Text::of("towards x", "towards x");
pub(in crate::console) const TILT_Y: Text = Text::of("towards y (deg)", "towards y (deg)");
pub(in crate::console) const FORCE_ACROSS: Text = Text::of("across the shaft", "across the shaft");
pub(in crate::console) const FORCE_ALONG: Text = Text::of("along the shaft (N)", "along the shaft (N)");
pub(in crate::console) const TRAVEL_DEPTH: Text = Text::of("depth through the trocar", "depth through the trocar");
pub(in crate::console) const TRAVEL_SPEED: Text = Text::of("inward speed (mm/s)", "inward speed (mm/s)");
pub(in crate::console) const COVERAGE_HOVER: Text = Text::of(
    "The more rows a field holds, the brighter it is. The network can be trusted only where there are rows.",
    "The more rows a field holds, the brighter it is. The network can be trusted only where there are rows.",
);
pub(in crate::console) const COVERAGE_TITLE: Text =
    Text::of("Coverage of the recording (brighter: more rows)", "Coverage of the recording (brighter: more rows)");
pub(in crate::console) const MAP_TILT: Text = Text::of("Tilt of the shaft", "Tilt of the shaft");
pub(in crate::console) const MAP_FORCE: Text = Text::of("Force at the tip", "Force at the tip");
pub(in crate::console) const MAP_TRAVEL: Text = Text::of("Motion through the trocar", "Motion through the trocar");
pub(in crate::console) const TRAIN_HOVER: Text = Text::of(
    "Trains four networks in parallel, each tested on a different part of the recording",
    "Trains four networks in parallel, each tested on a different part of the recording",
);
pub(in crate::console) const TRAIN_DATA: Text = Text::of("Recording", "Recording");
pub(in crate::console) const TRAIN_DATA_HOVER: Text =
    Text::of("Saved to a file before the training starts", "Saved to a file before the training starts");
pub(in crate::console) const TRAIN_CANCEL: Text = Text::of("Cancel training", "Cancel training");
pub(in crate::console) const TRAIN_AGAIN: Text = Text::of("Train again", "Train again");
pub(in crate::console) const TRAIN_START: Text = Text::of("Start training", "Start training");
pub(in crate::console) const TRAIN_DISABLED_HOVER: Text = Text::of("Record first", "Record first");
pub(in crate::console) const TRAIN_PROGRESS: Text = Text::of("Training", "Training");
pub(in crate::console) const LOSS_HOVER: Text = Text::of(
    "Mean square error divided by the variance of the forces; 1 means that nothing was learned. \
    The held-out curve counts: its rows are not used to train that network.",
    "Mean square error divided by the variance of the forces; 1 means that nothing was learned. \
    The held-out curve counts: its rows are not used to train that network.",
);
pub(in crate::console) const LOSS_TITLE: Text =
    Text::of("Loss of each network, by epoch", "Loss of each network, by epoch");
pub(in crate::console) const SIZE: Text = Text::of("Size", "Size");
pub(in crate::console) const SIZE_HOVER: Text = Text::of(
    "Neurons in the hidden layers. Published figures are for the default size.",
    "Neurons in the hidden layers. Published figures are for the default size.",
);
pub(in crate::console) const TRAIN_STARTING: Text = Text::of("saving the recording", "saving the recording");
pub(in crate::console) const TRAIN_NOT_STARTED: Text = Text::of("not started", "not started");
pub(in crate::console) const TRAINED_TITLE: Text = Text::of("Trained", "Trained");
pub(in crate::console) const TRAINED_HOVER: Text =
    Text::of("This network is used in the check", "This network is used in the check");
pub(in crate::console) const ENSEMBLE: Text = Text::of("Ensemble", "Ensemble");
pub(in crate::console) const ENSEMBLE_HOVER: Text = Text::of(
    "The result is the mean of all networks; where they disagree, it is marked as in doubt",
    "The result is the mean of all networks; where they disagree, it is marked as in doubt",
);
pub(in crate::console) const HELD_OUT_LOSS: Text = Text::of("Held-out loss", "Held-out loss");
pub(in crate::console) const HELD_OUT_LOSS_HOVER: Text = Text::of(
    "Mean of all networks; 1 means that nothing was learned",
    "Mean of all networks; 1 means that nothing was learned",
);
pub(in crate::console) const TRAINED_STALE: Text = Text::of(
    "New rows were recorded since: train again to use all of them",
    "New rows were recorded since: train again to use all of them",
);
pub(in crate::console) const EPOCH_AXIS: Text = Text::of("Epoch", "Epoch");
pub(in crate::console) const LOSS_AXIS: Text =
    Text::of("Mean square error (1: nothing learned)", "Mean square error (1: nothing learned)");
pub(in crate::console) const JOB_FAILED: Text = Text::of("It failed. Try again.", "It failed. Try again.");
pub(in crate::console) const PHASE_FULL: Text =
    Text::of("the recording is full; go on to the training", "the recording is full; go on to the training");
pub(in crate::console) const PHASE_WRIST_SILENT: Text = Text::of(
    "not recording: the wrist sensor sends no data; connect it",
    "not recording: the wrist sensor sends no data; connect it",
);
pub(in crate::console) const PHASE_NOT_MOVED: Text =
    Text::of("waiting; move the instrument in or out by 2 mm", "waiting; move the instrument in or out by 2 mm");
pub(in crate::console) const TASK_WORK: Text = Text::of(
    "Work where the task will be done: in and out, sideways, slowly and quickly, with and without contact",
    "Work where the task will be done: in and out, sideways, slowly and quickly, with and without contact",
);
pub(in crate::console) const TASK_WORK_FREE: Text = Text::of(
    "Move in and out and sideways, slowly and quickly, without touching the tissue",
    "Move in and out and sideways, slowly and quickly, without touching the tissue",
);
pub(in crate::console) const TASK_REST: Text =
    Text::of("Lift the tip off the tissue and hold it still", "Lift the tip off the tissue and hold it still");
pub(in crate::console) const DOUBT: Text = Text::of("In doubt", "In doubt");
pub(in crate::console) const TRAIN_STOPPING: Text = Text::of("stopping", "stopping");
pub(in crate::console) const TRAIN_DONE: Text = Text::of("done", "done");
pub(in crate::console) const RECORD_GO_ON: Text = Text::of("Go on recording", "Go on recording");
pub(in crate::console) const PHASE_PAUSED: Text = Text::of("paused", "paused");
pub(in crate::console) const PHASE_RECORDING: Text = Text::of("recording", "recording");

/// The check failed.
pub(in crate::console) fn not_judged(error: &str) -> String {
    told!("The network could not be evaluated: {error}", "The network could not be evaluated: {error}")
}

/// The training failed.
pub(in crate::console) fn not_trained(error: &str) -> String {
    told!("Not trained: {error}. The recording is kept.", "Not trained: {error}. The recording is kept.")
}

/// State of a recording.
pub(in crate::console) fn state(phase: &str) -> String {
    told!("State: {phase}", "State: {phase}")
}

/// Task of the person at the arm during the check.
pub(in crate::console) fn check_task(work_s: f64, free_s: f64) -> String {
    told!(
        "{work_s:.0} s of work on the tissue, then {free_s:.0} s without touching it",
        "{work_s:.0} s of work on the tissue, then {free_s:.0} s without touching it"
    )
}

/// Result of the check.
pub(in crate::console) fn verdict(reason: &str) -> String {
    told!("Verdict: {reason}", "Verdict: {reason}")
}

/// Share of samples for which the network was uncertain.
pub(in crate::console) fn doubt(percent: f64, rows: usize) -> String {
    told!("{percent:.1} % of {rows} rows", "{percent:.1} % of {rows} rows")
}

/// The background thread could not be started.
pub(in crate::console) fn no_thread(error: &impl std::fmt::Display) -> String {
    told!("The background task could not be started: {error}", "The background task could not be started: {error}")
}

/// A recording could not be saved.
pub(in crate::console) fn not_written(path: &std::path::Path, error: &impl std::fmt::Display) -> String {
    told!(
        "The recording could not be written to {}: {error}",
        "The recording could not be written to {}: {error}",
        path.display()
    )
}

/// Why the check cannot be passed: the training data were incomplete.
pub(in crate::console) fn trained_on_too_little(goal: &str) -> String {
    told!(
        "the recording used for training is incomplete ({goal}); record more",
        "the recording used for training is incomplete ({goal}); record more"
    )
}

/// Length of the recording, compared with the paper's.
pub(in crate::console) fn rows_and_seconds(rows: usize, seconds: f64, paper_rows: usize, paper_s: f64) -> String {
    told!(
        "{rows}, {seconds:.0} s (paper: {paper_rows}, {paper_s:.0} s)",
        "{rows}, {seconds:.0} s (paper: {paper_rows}, {paper_s:.0} s)"
    )
}

/// What is missing, and the requirement that it is for.
pub(in crate::console) fn advice(when: &str, advice: &str, goal: &str) -> String {
    format!("{when}: {advice} ({goal})")
}

/// No rows are being recorded.
pub(in crate::console) fn nothing_taken(why: &str) -> String {
    told!("not recording: {why}", "not recording: {why}")
}

/// The sensor under the tissue is being zeroed.
pub(in crate::console) fn taking_zero(percent: f64) -> String {
    told!(
        "setting the sensor under the tissue to zero: {percent:.0} %",
        "setting the sensor under the tissue to zero: {percent:.0} %"
    )
}

/// Size of the training.
pub(in crate::console) fn networks_on_rows(networks: usize, rows: usize) -> String {
    told!("{networks} networks on {rows} rows", "{networks} networks on {rows} rows")
}

/// A requirement that the recording did not meet.
pub(in crate::console) fn not_complete(goal: &str) -> String {
    told!(
        "The recording is incomplete ({goal}): you can keep this network only under your name",
        "The recording is incomplete ({goal}): you can keep this network only under your name"
    )
}

/// Legend: loss of a network on held-out rows.
pub(in crate::console) fn held_out(network: usize) -> String {
    told!("{network} held out", "{network} held out")
}

/// Legend: loss of a network on its training rows.
pub(in crate::console) fn training(network: usize) -> String {
    told!("{network} training", "{network} training")
}

/// The plot of the losses in one sentence.
pub(in crate::console) fn losses(networks: usize, epochs: usize) -> String {
    told!("Losses of {networks} networks over {epochs} epochs", "Losses of {networks} networks over {epochs} epochs")
}

/// Progress of the check.
pub(in crate::console) fn rows_of(rows: usize, asked: usize) -> String {
    told!("{rows} of {asked}", "{rows} of {asked}")
}

/// Size of a recording.
pub(in crate::console) fn rows_and_time(rows: usize, seconds: f64) -> String {
    told!("{rows} rows, {seconds:.0} s", "{rows} rows, {seconds:.0} s")
}

/// Progress of the training.
pub(in crate::console) fn time_left(percent: f64, elapsed_s: f64, left_s: f64) -> String {
    told!(
        "{percent:.0} %, {elapsed_s:.0} s, at most {left_s:.0} s left",
        "{percent:.0} %, {elapsed_s:.0} s, at most {left_s:.0} s left"
    )
}
