//! Words of the room `alarms`.

pub(in crate::console) const ALARM: &str = "Alarm";
pub(in crate::console) const WARNING: &str = "Warning";
pub(in crate::console) const NOTE: &str = "Note";
pub(in crate::console) const THE_STOP_HAS_NOT: &str = "The stop has not reached the loop";
pub(in crate::console) const CUT_THE_POWER_OF: &str = "Cut the power of the arm with its own emergency stop";
pub(in crate::console) const THE_CONTROL_LOOP_SENDS: &str =
    "The control loop sends nothing any more; the screen shows its last state";
pub(in crate::console) const STOP_THE_ARM_BY: &str =
    "Stop the arm by its own emergency stop, then start the console again";
pub(in crate::console) const CLOSE_OTHER_PROGRAMS_OR: &str =
    "Close other programs, or grant real-time priority (see timing)";
pub(in crate::console) const LET_NOTHING_TOUCH_THE: &str =
    "Let nothing touch the tool; if this stays, calibrate gravity again";
pub(in crate::console) const ALL_ALARMS_F5: &str = "All alarms (F5)";
pub(in crate::console) const THE_LAST_ALARMS_WITH: &str = "The last alarms with their times, also those that are gone.";
pub(in crate::console) const ACKNOWLEDGE_A: &str = "Acknowledge (A)";
pub(in crate::console) const ACKNOWLEDGED_THE_CAUSE_STILL: &str = "Acknowledged. The cause still lives.";
pub(in crate::console) const THE_LAST_50_THE: &str =
    "The last 50, the newest first. Times are UTC; in brackets the loop's own clock, as in the traces.";
pub(in crate::console) const NOTHING_HAS_BEEN_WRONG: &str = "Nothing has been wrong so far.";
pub(in crate::console) const ACKNOWLEDGE: &str = "Stops flashing and sound. The alarm stays until its cause is gone; a new one of the same or a higher priority \
                           flashes and sounds again.";
pub(in crate::console) const LIST: &str = "Alarms";
pub(in crate::console) const SEEN: &str = ", acknowledged";

/// A fault, and when it was first told, s on the loop's clock.
pub(in crate::console) fn fault(cause: &str, t_s: f64) -> String {
    format!("{cause} (at {t_s:.1} s)")
}

/// The loop is late too often.
pub(in crate::console) fn periods_missed(percent: f64) -> String {
    format!("The loop misses {percent:.1} % of its periods")
}

/// Gravity is not what it was.
pub(in crate::console) fn bias_moved(by_n: f64) -> String {
    format!("The wrist sensor reads {by_n:.2} N at rest: its bias has moved since the calibration")
}

/// Nothing plays a sound.
pub(in crate::console) fn no_player(players: &str) -> String {
    format!("No sound output: none of {players} is installed.")
}

/// The player ended badly.
pub(in crate::console) fn player_failed(status: &impl std::fmt::Display) -> String {
    format!("The sound could not be played ({status}).")
}

/// The player did not begin.
pub(in crate::console) fn player_not_started(error: &impl std::fmt::Display) -> String {
    format!("The sound could not be played: {error}.")
}

/// The pinned alarm; `remarks` tell of others and of the acknowledgement.
pub(in crate::console) fn pinned(priority: &str, cause: &str, began_utc: &str, remarks: &str) -> String {
    format!("{priority}: {cause} - since {began_utc} UTC{remarks}")
}

/// A remark: others are folded under it.
pub(in crate::console) fn others(count: usize) -> String {
    format!(" (+{count} more)")
}
