//! Alarms: cause and cure of each, the alarm strip, and the list of recent alarms.

pub(in crate::console) const ALARM: &str = "Alarm";
pub(in crate::console) const WARNING: &str = "Warning";
pub(in crate::console) const NOTE: &str = "Note";
pub(in crate::console) const STOP_STUCK_CAUSE: &str = "The stop has not reached the control loop";
pub(in crate::console) const STOP_STUCK_CURE: &str = "Press the arm's own emergency stop to cut its power";
pub(in crate::console) const LOOP_SILENT_CAUSE: &str =
    "The control loop has stopped sending data; the screen shows its last state";
pub(in crate::console) const LOOP_SILENT_CURE: &str = "Press the arm's own emergency stop, then restart the console";
pub(in crate::console) const PERIODS_MISSED_CURE: &str =
    "Close other programs, or grant real-time priority (see Timing)";
pub(in crate::console) const BIAS_MOVED_CURE: &str =
    "Make sure nothing touches the tool; if the alarm stays, calibrate gravity again";
pub(in crate::console) const SHOW_ALL: &str = "All alarms (F5)";
pub(in crate::console) const SHOW_ALL_HOVER: &str = "The last alarms with their times, including those that have ended";
pub(in crate::console) const ACKNOWLEDGE: &str = "Acknowledge (A)";
pub(in crate::console) const ACKNOWLEDGED_HOVER: &str = "Acknowledged; the cause is still present";
pub(in crate::console) const LIST_NOTE: &str =
    "The last 50 alarms, newest first. Times are UTC, with the loop's own clock in brackets, as in the traces.";
pub(in crate::console) const LIST_EMPTY: &str = "No alarms so far";
pub(in crate::console) const ACKNOWLEDGE_HOVER: &str = "Stops the flashing and the sound. The alarm stays until its cause is gone. A new alarm of the same \
    or a higher priority flashes and sounds again.";
pub(in crate::console) const LIST_TITLE: &str = "Alarms";
pub(in crate::console) const ACKNOWLEDGED_REMARK: &str = ", acknowledged";
pub(in crate::console) const NOW: &str = "now";
pub(in crate::console) const ENDED: &str = "ended";
pub(in crate::console) const PRESENT: &str = "still present";
pub(in crate::console) const DEVICE_MISSING_CURE: &str =
    "It is opened again automatically; check its cable and its power";

/// A fault and the time of its first report, s on the loop's clock.
pub(in crate::console) fn fault(cause: &str, t_s: f64) -> String {
    format!("{cause} (at {t_s:.1} s)")
}

/// A device that is missing.
pub(in crate::console) fn device(name: &str, cause: &str) -> String {
    format!("The {name} is missing: {cause}")
}

/// A device that is connected but no longer delivers.
pub(in crate::console) fn device_lost(name: &str, cause: &str) -> String {
    format!("The {name} is lost: {cause}")
}

/// A fault of a device.
pub(in crate::console) fn fault_of(name: &str, cause: &str) -> String {
    format!("{cause} ({name})")
}

/// The loop misses too many deadlines.
pub(in crate::console) fn periods_missed(percent: f64) -> String {
    format!("The control loop misses {percent:.1} % of its periods")
}

/// The bias of the wrist sensor has changed since the calibration.
pub(in crate::console) fn bias_moved(by_n: f64) -> String {
    format!("The wrist sensor reads {by_n:.2} N without contact: its bias has drifted since the calibration")
}

/// No program for playing sounds is installed.
pub(in crate::console) fn no_player(players: &str) -> String {
    format!("No alarm sound: none of these players is installed: {players}")
}

pub(in crate::console) const UNCHECKED_CAUSE: &str =
    "No ready check of the last 12 hours has passed with these devices";
pub(in crate::console) const UNCHECKED_CURE: &str = "Press Ready check in the panel Calibration before you engage";

/// The program for playing sounds failed.
pub(in crate::console) fn player_failed(status: &impl std::fmt::Display) -> String {
    format!("The alarm sound could not be played ({status})")
}

/// The program for playing sounds could not be started.
pub(in crate::console) fn player_not_started(error: &impl std::fmt::Display) -> String {
    format!("The alarm sound could not be played: {error}")
}

/// The alarm in the strip; `remarks` mention further alarms and the acknowledgement.
pub(in crate::console) fn pinned(priority: &str, cause: &str, began_utc: &str, remarks: &str) -> String {
    format!("{priority}: {cause}, since {began_utc} UTC{remarks}")
}

/// Remark: number of further alarms.
pub(in crate::console) fn others(count: usize) -> String {
    format!(" (+{count} more)")
}

/// An entry of the list of recent alarms.
pub(in crate::console) fn entry(began: &str, until: &str, priority: &str, standing: &str) -> String {
    format!("{began} to {until}: {priority}, {standing}")
}
