//! Recorded sessions: their list, and the past on the screen.

use std::{
    collections::BTreeMap,
    io,
    path::Path,
    time::{Duration, UNIX_EPOCH},
};

use nima_devices::Standing;
use nima_recording::store::utc_of;

pub(in crate::console) const SESSIONS: &str = "Sessions";
pub(in crate::console) const SESSIONS_HOVER: &str = "Recorded sessions: look at one, keep it, report on it. F7";
pub(in crate::console) const LIST: &str = "Recorded sessions";
pub(in crate::console) const EMPTY: &str = "No session has been recorded yet";
pub(in crate::console) const NO_SHELF: &str = "There is no folder for your files: set NIMA_DATA_DIR";
pub(in crate::console) const LOOKING: &str = "Reading the folder";
pub(in crate::console) const RECORDING: &str = "being recorded";
pub(in crate::console) const OPEN: &str = "Open";
pub(in crate::console) const OPEN_HOVER: &str = "Shows the session in all views; the machine runs on";
pub(in crate::console) const KEEP: &str = "Keep";
pub(in crate::console) const KEPT: &str = "Kept";
pub(in crate::console) const KEEP_HOVER: &str = "A kept session is never deleted to make room for new ones";
pub(in crate::console) const REPORT: &str = "Report";
pub(in crate::console) const REPORT_HOVER: &str = "Writes a page with the figures of this session and opens it";
pub(in crate::console) const DELETE: &str = "Delete";
pub(in crate::console) const DELETE_HOVER: &str = "Deletes the file; you are asked once";
pub(in crate::console) const DELETE_KEPT_HOVER: &str = "A kept session cannot be deleted";
pub(in crate::console) const DELETE_RUNNING_HOVER: &str = "This session is still being recorded";
pub(in crate::console) const DELETE_NOW: &str = "Delete it?";
pub(in crate::console) const DELETE_NOW_HOVER: &str = "Deletes the file for good";
pub(in crate::console) const BACK: &str = "Back to the view";
pub(in crate::console) const REPORTING: &str = "Writing the report";
pub(in crate::console) const CUTTING: &str = "Saving the stretch";
pub(in crate::console) const NO_THREAD: &str = "The system cannot start another thread";

pub(in crate::console) const PAST: &str = "PAST";
pub(in crate::console) const PAST_HOVER: &str =
    "Everything inside this frame is recorded. The bar above is the machine now, and Stop stops it.";
pub(in crate::console) const MACHINE: &str = "The machine now";
pub(in crate::console) const LIVE_AGAIN: &str = "Live again (L)";
pub(in crate::console) const LIVE_AGAIN_HOVER: &str = "Closes the session; the screen shows the machine again";
pub(in crate::console) const BLOCKED: &str = "Not while the past is shown: press L first";
pub(in crate::console) const OPENING: &str = "Opening the session";
pub(in crate::console) const WHOLE: &str = "Replayed to the last bit";
pub(in crate::console) const PLOTTED: &str = "Forces, positions and states; the rest follows";
pub(in crate::console) const PLOTTED_ONLY: &str = "Only forces, positions and states";
pub(in crate::console) const SIMULATED: &str = "This rig has no devices: everything was simulated";
pub(in crate::console) const NOT_OF_DEVICES: &str = "A session does not hold what each device counted and measured on its own: \
rates, losses, ages, the drift of a sensor's bias, and the pages of the wizards";
pub(in crate::console) const TIMELINE: &str = "Time of the session";
pub(in crate::console) const PLAY: &str = "Play";
pub(in crate::console) const PAUSE: &str = "Pause";
pub(in crate::console) const PLAY_HOVER: &str = "Plays the session or holds it. Key P";
pub(in crate::console) const SPEED_HOVER: &str = "How fast the session is played";
pub(in crate::console) const COMPARE: &str = "Compare";
pub(in crate::console) const COMPARE_HOVER: &str =
    "Shows another session beside this one, at the same time since its beginning; press again to end it";
pub(in crate::console) const BESIDE: &str = "Choose the session to show beside this one";
pub(in crate::console) const FROM: &str = "From";
pub(in crate::console) const FROM_HOVER: &str = "The stretch to save begins at this moment";
pub(in crate::console) const TO: &str = "To";
pub(in crate::console) const TO_HOVER: &str = "The stretch to save ends at this moment";
pub(in crate::console) const SAVE: &str = "Save the stretch";
pub(in crate::console) const SAVE_HOVER: &str =
    "Writes what is between From and To as a session of its own, and keeps it";
pub(in crate::console) const SAVE_DISABLED_HOVER: &str = "Set From and To first: From must come before To";

/// A factor of speed.
pub(in crate::console) fn speed(factor: f64) -> String {
    format!("{factor}\u{d7}")
}

/// A time of a session, s.
pub(in crate::console) fn clock(t_s: f64) -> String {
    let (hours, minutes, seconds) = ((t_s / 3600.0).floor(), (t_s / 60.0).floor() % 60.0, t_s % 60.0);
    if hours > 0.0 { format!("{hours}:{minutes:02}:{seconds:06.3}") } else { format!("{minutes}:{seconds:06.3}") }
}

/// The same to the second.
pub(in crate::console) fn short_clock(t_s: f64) -> String {
    clock(t_s.floor()).trim_end_matches(".000").to_owned()
}

/// The time on the screen, and the length of the session, s.
pub(in crate::console) fn position(t_s: f64, end_s: f64) -> String {
    format!("{} of {}", clock(t_s), short_clock(end_s))
}

/// Date and time, from ns since 1970.
pub(in crate::console) fn when(time_ns: u64) -> String {
    let utc = utc_of(UNIX_EPOCH + Duration::from_nanos(time_ns)).replace('T', "  ");
    format!("{}.{} UTC", utc.trim_end_matches('Z'), time_ns / 100_000_000 % 10)
}

/// A moment of a session.
pub(in crate::console) fn of_session(when: &str, name: &str) -> String {
    format!("{when}  \u{b7}  {name}")
}

/// Date and time of a session's beginning.
pub(in crate::console) fn began(utc: Option<&str>) -> String {
    utc.map_or_else(|| "unknown date".to_owned(), |utc| utc.replace('T', "  ").replace('Z', " UTC"))
}

/// A stretch of a session that begins at this time, s.
pub(in crate::console) fn stretch(from_s: f64) -> String {
    format!("from {}", short_clock(from_s))
}

/// Size of a file.
pub(in crate::console) fn megabytes(bytes: u64) -> String {
    format!("{:.0} MB", bytes as f64 * 1e-6)
}

/// Which part of the session was read, 0 to 1.
pub(in crate::console) fn read(share: f64) -> String {
    format!("{:.0} % read", 100.0 * share)
}

/// An alarm of the moment on the screen.
pub(in crate::console) fn alarm_then(word: &str, cause: &str) -> String {
    format!("{word} then: {cause}")
}

/// Below the pointer on the time line.
pub(in crate::console) fn at(t_s: f64, words: &str) -> String {
    format!("{}  {words}", clock(t_s))
}

/// One of two sessions that are compared, and its time.
pub(in crate::console) fn half(name: &str, position: &str) -> String {
    format!("{name}  \u{b7}  {position}")
}

/// Largest forces in a short time, N.
pub(in crate::console) fn largest(t_s: f64, measured_n: f32, rendered_n: f32) -> String {
    format!("{}\nLargest forces: measured {measured_n:.2} N, rendered {rendered_n:.2} N", short_clock(t_s))
}

/// Why what comes after a part is only plotted.
pub(in crate::console) fn limited(why: &str) -> String {
    format!("Cannot be replayed in full: {why}")
}

/// The session cannot be shown.
pub(in crate::console) fn refused(why: &str) -> String {
    format!("This session cannot be shown: {why}")
}

/// Entries are missing in a journal.
pub(in crate::console) fn hole(lost: u64) -> String {
    format!("the recording lost {lost} entries here")
}

/// A replay is not what was recorded.
pub(in crate::console) fn differs(t_s: f64) -> String {
    format!("another version of this program recorded it, or the file was changed: it differs at {t_s:.3} s")
}

/// A part of the file is missing.
pub(in crate::console) fn without(name: &str) -> String {
    format!("the file holds no {name}")
}

/// A part of the file cannot be used.
pub(in crate::console) fn unusable(name: &str, why: &str) -> String {
    format!("its {name} cannot be used: {why}")
}

/// How a device was.
pub(in crate::console) fn device(name: &str, standing: Standing) -> String {
    let how = match standing {
        Standing::Closed => "not opened",
        Standing::Opening => "being opened",
        Standing::Connected => "connected",
        Standing::Lost(loss) => return format!("{name}: lost: {}", loss.cause()),
    };
    format!("{name}: {how}")
}

/// The calibrations of a side, from what its file tells; in force since the beginning, or since this time, s.
pub(in crate::console) fn calibrations(side: &str, table: &BTreeMap<String, String>, since_s: Option<f64>) -> String {
    let told = |key: &str| table.get(key).filter(|value| !value.is_empty());
    // The verdict, and the error on data that were not used.
    let result = |verdict: &str, error_n: &str| {
        let error_n = told(error_n).and_then(|error_n| error_n.parse::<f64>().ok());
        match (told(verdict), error_n) {
            (Some(verdict), Some(error_n)) => format!(" ({verdict}, {error_n:.2} N on new data)"),
            (Some(verdict), None) => format!(" ({verdict})"),
            (None, _) => String::new(),
        }
    };
    let gravity = if told("gravity_digest").is_some() {
        format!("gravity calibrated{}", result("gravity_verdict", "gravity_error_n"))
    } else {
        "no gravity calibration".to_owned()
    };
    let network = told("network_date").map_or_else(
        || "no network".to_owned(),
        |date| {
            let of = |key: &str| told(key).map_or("unknown", String::as_str);
            let result = result("network_verdict", "network_error_n");
            format!("network of {date} for sensor {}, tool {}{result}", of("network_sensor"), of("network_tool"))
        },
    );
    let since = since_s.map_or_else(String::new, |since_s| format!(", in force since {}", clock(since_s)));
    format!("{side} arm: {gravity}, {network}{since}")
}

/// Where a report is.
pub(in crate::console) fn reported(path: &Path) -> String {
    format!("Report: {}", path.display())
}

/// There is no report.
pub(in crate::console) fn not_reported(why: &str) -> String {
    format!("No report: {why}")
}

/// Where a stretch is.
pub(in crate::console) fn saved(path: &Path) -> String {
    format!("Saved: {}", path.display())
}

/// A stretch was not saved.
pub(in crate::console) fn not_saved(why: &str) -> String {
    format!("Not saved: {why}")
}

/// There is a file of this name.
pub(in crate::console) fn taken(path: &Path) -> String {
    format!("{} is there already", path.display())
}

/// A session was not deleted.
pub(in crate::console) fn not_deleted(path: &Path, error: &io::Error) -> String {
    format!("{} was not deleted: {error}", path.display())
}
