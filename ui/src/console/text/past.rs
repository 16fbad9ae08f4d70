//! Recorded sessions: their list, and the past on the screen.

use std::{
    collections::BTreeMap,
    io,
    path::Path,
    time::{Duration, UNIX_EPOCH},
};

use nima_devices::Standing;
use nima_recording::store::utc_of;

use crate::language::{Text, told, word};

pub(in crate::console) const SESSIONS: Text = Text::of("Sessions", "Sessions");
pub(in crate::console) const SESSIONS_HOVER: Text = Text::of(
    "Recorded sessions: look at one, keep it, report on it. F7",
    "Recorded sessions: look at one, keep it, report on it. F7",
);
pub(in crate::console) const LIST: Text = Text::of("Recorded sessions", "Recorded sessions");
pub(in crate::console) const EMPTY: Text =
    Text::of("No session has been recorded yet", "No session has been recorded yet");
pub(in crate::console) const NO_SHELF: Text = Text::of(
    "There is no folder for your files: set NIMA_DATA_DIR",
    "There is no folder for your files: set NIMA_DATA_DIR",
);
pub(in crate::console) const LOOKING: Text = Text::of("Reading the folder", "Reading the folder");
pub(in crate::console) const RECORDING: Text = Text::of("being recorded", "being recorded");
pub(in crate::console) const OPEN: Text = Text::of("Open", "Open");
pub(in crate::console) const OPEN_HOVER: Text = Text::of(
    "Shows the session in all views; the machine runs on",
    "Shows the session in all views; the machine runs on",
);
pub(in crate::console) const KEEP: Text = Text::of("Keep", "Keep");
pub(in crate::console) const KEPT: Text = Text::of("Kept", "Kept");
pub(in crate::console) const KEEP_HOVER: Text = Text::of(
    "A kept session is never deleted to make room for new ones",
    "A kept session is never deleted to make room for new ones",
);
pub(in crate::console) const REPORT: Text = Text::of("Report", "Report");
pub(in crate::console) const REPORT_HOVER: Text = Text::of(
    "Writes a page with the figures of this session and opens it",
    "Writes a page with the figures of this session and opens it",
);
pub(in crate::console) const DELETE: Text = Text::of("Delete", "Delete");
pub(in crate::console) const DELETE_HOVER: Text =
    Text::of("Deletes the file; you are asked once", "Deletes the file; you are asked once");
pub(in crate::console) const DELETE_KEPT_HOVER: Text =
    Text::of("A kept session cannot be deleted", "A kept session cannot be deleted");
pub(in crate::console) const DELETE_RUNNING_HOVER: Text =
    Text::of("This session is still being recorded", "This session is still being recorded");
pub(in crate::console) const DELETE_NOW: Text = Text::of("Delete it?", "Delete it?");
pub(in crate::console) const DELETE_NOW_HOVER: Text =
    Text::of("Deletes the file for good", "Deletes the file for good");
pub(in crate::console) const BACK: Text = Text::of("Back to the view", "Back to the view");
pub(in crate::console) const REPORTING: Text = Text::of("Writing the report", "Writing the report");
pub(in crate::console) const CUTTING: Text = Text::of("Saving the stretch", "Saving the stretch");
pub(in crate::console) const NO_THREAD: Text =
    Text::of("The system cannot start another thread", "The system cannot start another thread");

pub(in crate::console) const PAST: Text = Text::of("PAST", "PAST");
pub(in crate::console) const PAST_HOVER: Text = Text::of(
    "Everything inside this frame is recorded. The bar above is the machine now, and Stop stops it.",
    "Everything inside this frame is recorded. The bar above is the machine now, and Stop stops it.",
);
pub(in crate::console) const MACHINE: Text = Text::of("The machine now", "The machine now");
pub(in crate::console) const LIVE_AGAIN: Text = Text::of("Live again (L)", "Live again (L)");
pub(in crate::console) const LIVE_AGAIN_HOVER: Text = Text::of(
    "Closes the session; the screen shows the machine again",
    "Closes the session; the screen shows the machine again",
);
pub(in crate::console) const BLOCKED: Text =
    Text::of("Not while the past is shown: press L first", "Not while the past is shown: press L first");
pub(in crate::console) const OPENING: Text = Text::of("Opening the session", "Opening the session");
pub(in crate::console) const WHOLE: Text = Text::of("Replayed to the last bit", "Replayed to the last bit");
pub(in crate::console) const PLOTTED: Text =
    Text::of("Forces, positions and states; the rest follows", "Forces, positions and states; the rest follows");
pub(in crate::console) const PLOTTED_ONLY: Text =
    Text::of("Only forces, positions and states", "Only forces, positions and states");
pub(in crate::console) const SIMULATED: Text =
    Text::of("This rig has no devices: everything was simulated", "This rig has no devices: everything was simulated");
pub(in crate::console) const NOT_OF_DEVICES: Text = Text::of(
    "A session does not hold what each device counted and measured on its own: \
rates, losses, ages, the drift of a sensor's bias, and the pages of the wizards",
    "A session does not hold what each device counted and measured on its own: \
rates, losses, ages, the drift of a sensor's bias, and the pages of the wizards",
);
pub(in crate::console) const TIMELINE: Text = Text::of("Time of the session", "Time of the session");
pub(in crate::console) const PLAY: Text = Text::of("Play", "Play");
pub(in crate::console) const PAUSE: Text = Text::of("Pause", "Pause");
pub(in crate::console) const PLAY_HOVER: Text =
    Text::of("Plays the session or holds it. Key P", "Plays the session or holds it. Key P");
pub(in crate::console) const SPEED_HOVER: Text =
    Text::of("How fast the session is played", "How fast the session is played");
pub(in crate::console) const COMPARE: Text = Text::of("Compare", "Compare");
pub(in crate::console) const COMPARE_HOVER: Text = Text::of(
    "Shows another session beside this one, at the same time since its beginning; press again to end it",
    "Shows another session beside this one, at the same time since its beginning; press again to end it",
);
pub(in crate::console) const BESIDE: Text =
    Text::of("Choose the session to show beside this one", "Choose the session to show beside this one");
pub(in crate::console) const FROM: Text = Text::of("From", "From");
pub(in crate::console) const FROM_HOVER: Text =
    Text::of("The stretch to save begins at this moment", "The stretch to save begins at this moment");
pub(in crate::console) const TO: Text = Text::of("To", "To");
pub(in crate::console) const TO_HOVER: Text =
    Text::of("The stretch to save ends at this moment", "The stretch to save ends at this moment");
pub(in crate::console) const SAVE: Text = Text::of("Save the stretch", "Save the stretch");
pub(in crate::console) const SAVE_HOVER: Text = Text::of(
    "Writes what is between From and To as a session of its own, and keeps it",
    "Writes what is between From and To as a session of its own, and keeps it",
);
pub(in crate::console) const SAVE_DISABLED_HOVER: Text =
    Text::of("Set From and To first: From must come before To", "Set From and To first: From must come before To");

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
    told!("{} of {}", "{} of {}", clock(t_s), short_clock(end_s))
}

/// Date and time, from ns since 1970.
pub(in crate::console) fn when(time_ns: u64) -> String {
    let utc = utc_of(UNIX_EPOCH + Duration::from_nanos(time_ns)).replace('T', "  ");
    told!("{}.{} UTC", "{}.{} UTC", utc.trim_end_matches('Z'), time_ns / 100_000_000 % 10)
}

/// A moment of a session.
pub(in crate::console) fn of_session(when: &str, name: &str) -> String {
    format!("{when}  \u{b7}  {name}")
}

/// Date and time of a session's beginning.
pub(in crate::console) fn began(utc: Option<&str>) -> String {
    utc.map_or_else(
        || word("unknown date", "unknown date").to_owned(),
        |utc| utc.replace('T', "  ").replace('Z', word(" UTC", " UTC")),
    )
}

/// A stretch of a session that begins at this time, s.
pub(in crate::console) fn stretch(from_s: f64) -> String {
    told!("from {}", "from {}", short_clock(from_s))
}

/// Size of a file.
pub(in crate::console) fn megabytes(bytes: u64) -> String {
    told!("{:.0} MB", "{:.0} MB", bytes as f64 * 1e-6)
}

/// Which part of the session was read, 0 to 1.
pub(in crate::console) fn read(share: f64) -> String {
    told!("{:.0} % read", "{:.0} % read", 100.0 * share)
}

/// An alarm of the moment on the screen.
pub(in crate::console) fn alarm_then(word: &str, cause: &str) -> String {
    told!("{word} then: {cause}", "{word} then: {cause}")
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
    told!(
        "{}\nLargest forces: measured {measured_n:.2} N, rendered {rendered_n:.2} N",
        "{}\nLargest forces: measured {measured_n:.2} N, rendered {rendered_n:.2} N",
        short_clock(t_s)
    )
}

/// Why what comes after a part is only plotted.
pub(in crate::console) fn limited(why: &str) -> String {
    told!("Cannot be replayed in full: {why}", "Cannot be replayed in full: {why}")
}

/// The session cannot be shown.
pub(in crate::console) fn refused(why: &str) -> String {
    told!("This session cannot be shown: {why}", "This session cannot be shown: {why}")
}

/// Entries are missing in a journal.
pub(in crate::console) fn hole(lost: u64) -> String {
    told!("the recording lost {lost} entries here", "the recording lost {lost} entries here")
}

/// A replay is not what was recorded.
pub(in crate::console) fn differs(t_s: f64) -> String {
    told!(
        "another version of this program recorded it, or the file was changed: it differs at {t_s:.3} s",
        "another version of this program recorded it, or the file was changed: it differs at {t_s:.3} s"
    )
}

/// A part of the file is missing.
pub(in crate::console) fn without(name: &str) -> String {
    told!("the file holds no {name}", "the file holds no {name}")
}

/// A part of the file cannot be used.
pub(in crate::console) fn unusable(name: &str, why: &str) -> String {
    told!("its {name} cannot be used: {why}", "its {name} cannot be used: {why}")
}

/// How a device was.
pub(in crate::console) fn device(name: &str, standing: Standing) -> String {
    let how = match standing {
        Standing::Closed => word("not opened", "not opened"),
        Standing::Opening => word("being opened", "being opened"),
        Standing::Connected => word("connected", "connected"),
        Standing::Lost(loss) => return told!("{name}: lost: {}", "{name}: lost: {}", loss.cause()),
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
            (Some(verdict), Some(error_n)) => {
                told!(" ({verdict}, {error_n:.2} N on new data)", " ({verdict}, {error_n:.2} N on new data)")
            }
            (Some(verdict), None) => format!(" ({verdict})"),
            (None, _) => String::new(),
        }
    };
    let gravity = if told(word("gravity_digest", "gravity_digest")).is_some() {
        told!(
            "gravity calibrated{}",
            "gravity calibrated{}",
            result(word("gravity_verdict", "gravity_verdict"), word("gravity_error_n", "gravity_error_n"))
        )
    } else {
        word("no gravity calibration", "no gravity calibration").to_owned()
    };
    let network = told(word("network_date", "network_date")).map_or_else(
        || word("no network", "no network").to_owned(),
        |date| {
            let of = |key: &str| told(key).map_or(word("unknown", "unknown"), String::as_str);
            let result = result(word("network_verdict", "network_verdict"), word("network_error_n", "network_error_n"));
            told!(
                "network of {date} for sensor {}, tool {}{result}",
                "network of {date} for sensor {}, tool {}{result}",
                of(word("network_sensor", "network_sensor")),
                of(word("network_tool", "network_tool"))
            )
        },
    );
    let since =
        since_s.map_or_else(String::new, |since_s| told!(", in force since {}", ", in force since {}", clock(since_s)));
    told!("{side} arm: {gravity}, {network}{since}", "{side} arm: {gravity}, {network}{since}")
}

/// Where a report is.
pub(in crate::console) fn reported(path: &Path) -> String {
    told!("Report: {}", "Report: {}", path.display())
}

/// There is no report.
pub(in crate::console) fn not_reported(why: &str) -> String {
    told!("No report: {why}", "No report: {why}")
}

/// Where a stretch is.
pub(in crate::console) fn saved(path: &Path) -> String {
    told!("Saved: {}", "Saved: {}", path.display())
}

/// A stretch was not saved.
pub(in crate::console) fn not_saved(why: &str) -> String {
    told!("Not saved: {why}", "Not saved: {why}")
}

/// There is a file of this name.
pub(in crate::console) fn taken(path: &Path) -> String {
    told!("{} is there already", "{} is there already", path.display())
}

/// A session was not deleted.
pub(in crate::console) fn not_deleted(path: &Path, error: &io::Error) -> String {
    told!("{} was not deleted: {error}", "{} was not deleted: {error}", path.display())
}
