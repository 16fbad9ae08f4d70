//! Alarms: cause and cure of each, the alarm strip, and the list of recent alarms.

use crate::language::{Text, told};

pub(in crate::console) const ALARM: Text = Text::of("Alarm", "Alarm");
pub(in crate::console) const WARNING: Text = Text::of("Warning", "Warning");
pub(in crate::console) const NOTE: Text = Text::of("Note", "Note");
pub(in crate::console) const STOP_STUCK_CAUSE: Text =
    Text::of("The stop has not reached the control loop", "The stop has not reached the control loop");
pub(in crate::console) const STOP_STUCK_CURE: Text = Text::of(
    "Press the arm's own emergency stop to cut its power",
    "Press the arm's own emergency stop to cut its power",
);
pub(in crate::console) const LOOP_SILENT_CAUSE: Text = Text::of(
    "The control loop has stopped sending data; the screen shows its last state",
    "The control loop has stopped sending data; the screen shows its last state",
);
pub(in crate::console) const LOOP_SILENT_CURE: Text = Text::of(
    "Press the arm's own emergency stop, then restart the console",
    "Press the arm's own emergency stop, then restart the console",
);
pub(in crate::console) const PERIODS_MISSED_CURE: Text = Text::of(
    "Close other programs, or grant real-time priority (see Timing)",
    "Close other programs, or grant real-time priority (see Timing)",
);
pub(in crate::console) const BIAS_MOVED_CURE: Text = Text::of(
    "Make sure nothing touches the tool; if the alarm stays, calibrate gravity again",
    "Make sure nothing touches the tool; if the alarm stays, calibrate gravity again",
);
pub(in crate::console) const SHOW_ALL: Text = Text::of("All alarms (F5)", "All alarms (F5)");
pub(in crate::console) const SHOW_ALL_HOVER: Text = Text::of(
    "The last alarms with their times, including those that have ended",
    "The last alarms with their times, including those that have ended",
);
pub(in crate::console) const ACKNOWLEDGE: Text = Text::of("Acknowledge (A)", "Acknowledge (A)");
pub(in crate::console) const ACKNOWLEDGED_HOVER: Text =
    Text::of("Acknowledged; the cause is still present", "Acknowledged; the cause is still present");
pub(in crate::console) const LIST_NOTE: Text = Text::of(
    "The last 50 alarms, newest first. Times are UTC, with the loop's own clock in brackets, as in the traces.",
    "The last 50 alarms, newest first. Times are UTC, with the loop's own clock in brackets, as in the traces.",
);
pub(in crate::console) const LIST_EMPTY: Text = Text::of("No alarms so far", "No alarms so far");
pub(in crate::console) const ACKNOWLEDGE_HOVER: Text = Text::of(
    "Stops the flashing and the sound. The alarm stays until its cause is gone. A new alarm of the same \
    or a higher priority flashes and sounds again.",
    "Stops the flashing and the sound. The alarm stays until its cause is gone. A new alarm of the same \
    or a higher priority flashes and sounds again.",
);
pub(in crate::console) const LIST_TITLE: Text = Text::of("Alarms", "Alarms");
pub(in crate::console) const ACKNOWLEDGED_REMARK: Text = Text::of(", acknowledged", ", acknowledged");
pub(in crate::console) const NOW: Text = Text::of("now", "now");
pub(in crate::console) const ENDED: Text = Text::of("ended", "ended");
pub(in crate::console) const PRESENT: Text = Text::of("still present", "still present");
pub(in crate::console) const DEVICE_MISSING_CURE: Text = Text::of(
    "It is opened again automatically; check its cable and its power",
    "It is opened again automatically; check its cable and its power",
);

/// A fault and the time of its first report, s on the loop's clock.
pub(in crate::console) fn fault(cause: &str, t_s: f64) -> String {
    told!("{cause} (at {t_s:.1} s)", "{cause} (at {t_s:.1} s)")
}

/// A device that is missing.
pub(in crate::console) fn device(name: &str, cause: &str) -> String {
    told!("The {name} is missing: {cause}", "The {name} is missing: {cause}")
}

/// A device that is connected but no longer delivers.
pub(in crate::console) fn device_lost(name: &str, cause: &str) -> String {
    told!("The {name} is lost: {cause}", "The {name} is lost: {cause}")
}

/// A fault of a device.
pub(in crate::console) fn fault_of(name: &str, cause: &str) -> String {
    format!("{cause} ({name})")
}

/// The loop misses too many deadlines.
pub(in crate::console) fn periods_missed(percent: f64) -> String {
    told!(
        "The control loop misses {percent:.1} % of its periods",
        "The control loop misses {percent:.1} % of its periods"
    )
}

/// The bias of the wrist sensor has changed since the calibration.
pub(in crate::console) fn bias_moved(by_n: f64) -> String {
    told!(
        "The wrist sensor reads {by_n:.2} N without contact: its bias has drifted since the calibration",
        "The wrist sensor reads {by_n:.2} N without contact: its bias has drifted since the calibration"
    )
}

/// No program for playing sounds is installed.
pub(in crate::console) fn no_player(players: &str) -> String {
    told!(
        "No alarm sound: none of these players is installed: {players}",
        "No alarm sound: none of these players is installed: {players}"
    )
}

pub(in crate::console) const UNCHECKED_CAUSE: Text = Text::of(
    "No ready check of the last 12 hours has passed with these devices",
    "No ready check of the last 12 hours has passed with these devices",
);
pub(in crate::console) const UNCHECKED_CURE: Text = Text::of(
    "Press Ready check in the panel Calibration before you engage",
    "Press Ready check in the panel Calibration before you engage",
);

/// The program for playing sounds failed.
pub(in crate::console) fn player_failed(status: &impl std::fmt::Display) -> String {
    told!("The alarm sound could not be played ({status})", "The alarm sound could not be played ({status})")
}

/// The program for playing sounds could not be started.
pub(in crate::console) fn player_not_started(error: &impl std::fmt::Display) -> String {
    told!("The alarm sound could not be played: {error}", "The alarm sound could not be played: {error}")
}

/// The alarm in the strip; `remarks` mention further alarms and the acknowledgement.
pub(in crate::console) fn pinned(priority: &str, cause: &str, began_utc: &str, remarks: &str) -> String {
    told!("{priority}: {cause}, since {began_utc} UTC{remarks}", "{priority}: {cause}, since {began_utc} UTC{remarks}")
}

/// Remark: number of further alarms.
pub(in crate::console) fn others(count: usize) -> String {
    told!(" (+{count} more)", " (+{count} more)")
}

/// An entry of the list of recent alarms.
pub(in crate::console) fn entry(began: &str, until: &str, priority: &str, standing: &str) -> String {
    told!("{began} to {until}: {priority}, {standing}", "{began} to {until}: {priority}, {standing}")
}
