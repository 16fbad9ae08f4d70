//! Recorded sessions: their list, and the past on the screen.

use std::{
    collections::BTreeMap,
    io,
    path::Path,
    time::{Duration, UNIX_EPOCH},
};

use nima_devices::Standing;
use nima_machine::rig::DeviceName;
use nima_recording::store::utc_of;

use crate::language::{Text, told, word};
use crate::words::{device_name, loss_words};

pub(in crate::console) const SESSIONS: Text = Text::of("Sessions", "Sitzungen");
pub(in crate::console) const SESSIONS_HOVER: Text = Text::of(
    "Recorded sessions: look at one, keep it, report on it. F7",
    "Aufgezeichnete Sitzungen: ansehen, sichern, Bericht erstellen. F7",
);
pub(in crate::console) const LIST: Text = Text::of("Recorded sessions", "Aufgezeichnete Sitzungen");
pub(in crate::console) const EMPTY: Text =
    Text::of("No session has been recorded yet", "Noch keine Sitzung aufgezeichnet");
pub(in crate::console) const NO_SHELF: Text = Text::of(
    "There is no folder for your files: set NIMA_DATA_DIR",
    "Kein Ordner für Ihre Dateien: NIMA_DATA_DIR setzen",
);
pub(in crate::console) const LOOKING: Text = Text::of("Reading the folder", "Ordner wird gelesen");
pub(in crate::console) const RECORDING: Text = Text::of("being recorded", "wird aufgezeichnet");
pub(in crate::console) const OPEN: Text = Text::of("Open", "Öffnen");
pub(in crate::console) const OPEN_HOVER: Text = Text::of(
    "Shows the session in all views; the machine runs on",
    "Zeigt die Sitzung in allen Ansichten; die Maschine läuft weiter",
);
pub(in crate::console) const KEEP: Text = Text::of("Keep", "Sichern");
pub(in crate::console) const KEPT: Text = Text::of("Kept", "Gesichert");
pub(in crate::console) const KEEP_HOVER: Text = Text::of(
    "A kept session is never deleted to make room for new ones",
    "Eine gesicherte Sitzung wird nie gelöscht, um Platz zu schaffen",
);
pub(in crate::console) const REPORT: Text = Text::of("Report", "Bericht");
pub(in crate::console) const REPORT_HOVER: Text = Text::of(
    "Writes a page with the figures of this session and opens it",
    "Schreibt eine Seite mit den Werten dieser Sitzung und öffnet sie",
);
pub(in crate::console) const DELETE: Text = Text::of("Delete", "Löschen");
pub(in crate::console) const DELETE_HOVER: Text =
    Text::of("Deletes the file; you are asked once", "Löscht die Datei nach einer Rückfrage");
pub(in crate::console) const DELETE_KEPT_HOVER: Text =
    Text::of("A kept session cannot be deleted", "Gesicherte Sitzungen sind nicht löschbar");
pub(in crate::console) const DELETE_RUNNING_HOVER: Text =
    Text::of("This session is still being recorded", "Diese Sitzung wird noch aufgezeichnet");
pub(in crate::console) const DELETE_NOW: Text = Text::of("Delete it?", "Löschen?");
pub(in crate::console) const DELETE_NOW_HOVER: Text =
    Text::of("Deletes the file for good", "Löscht die Datei endgültig");
pub(in crate::console) const BACK: Text = Text::of("Back to the view", "Zurück zur Ansicht");
pub(in crate::console) const ELSEWHERE: Text = Text::of("Open file...", "Datei öffnen...");
pub(in crate::console) const ELSEWHERE_HOVER: Text = Text::of(
    "Opens a session from any folder; the list has only those in yours",
    "Öffnet eine Sitzung aus einem beliebigen Ordner; die Liste enthält nur die in Ihrem",
);
pub(in crate::console) const REPORTING: Text = Text::of("Writing the report", "Bericht wird geschrieben");
pub(in crate::console) const CUTTING: Text = Text::of("Saving the stretch", "Ausschnitt wird gespeichert");
pub(in crate::console) const NO_THREAD: Text =
    Text::of("The system cannot start another thread", "Das System kann keinen weiteren Thread starten");

pub(in crate::console) const PAST: Text = Text::of("PAST", "ARCHIV");
pub(in crate::console) const PAST_HOVER: Text = Text::of(
    "Everything inside this frame is recorded. The bar above is the machine now, and Stop stops it.",
    "Alles in diesem Rahmen ist aufgezeichnet. Die Leiste darüber ist die Maschine jetzt, und Halt hält sie an.",
);
pub(in crate::console) const MACHINE: Text = Text::of("The machine now", "Die Maschine jetzt");
pub(in crate::console) const LIVE_AGAIN: Text = Text::of("Live again (L)", "Wieder live (L)");
pub(in crate::console) const LIVE_AGAIN_HOVER: Text = Text::of(
    "Closes the session; the screen shows the machine again",
    "Schließt die Sitzung und zeigt wieder die Maschine",
);
pub(in crate::console) const BLOCKED: Text =
    Text::of("Not while the past is shown: press L first", "Nicht während der Wiedergabe: erst L drücken");
pub(in crate::console) const OPENING: Text = Text::of("Opening the session", "Sitzung wird geöffnet");
pub(in crate::console) const WHOLE: Text = Text::of("Replayed to the last bit", "Bitgenau wiedergegeben");
pub(in crate::console) const PLOTTED: Text =
    Text::of("Forces, positions and states; the rest follows", "Kräfte, Positionen und Zustände; der Rest folgt");
pub(in crate::console) const PLOTTED_ONLY: Text =
    Text::of("Only forces, positions and states", "Nur Kräfte, Positionen und Zustände");
pub(in crate::console) const SIMULATED: Text = Text::of(
    "This rig has no devices: everything was simulated",
    "Dieser Aufbau hat keine Geräte: alles war simuliert",
);
pub(in crate::console) const NOT_OF_DEVICES: Text = Text::of(
    "A session does not hold what each device counted and measured on its own: \
rates, losses, ages, the drift of a sensor's bias, and the pages of the wizards",
    "Nicht in der Sitzung: eigene Zähler und Messwerte der Geräte (Raten, Verluste, Alter, Drift des \
     Sensor-Nullpunkts) und die Seiten der Assistenten",
);
pub(in crate::console) const TIMELINE: Text = Text::of("Time of the session", "Zeit der Sitzung");
pub(in crate::console) const PLAY: Text = Text::of("Play", "Abspielen");
pub(in crate::console) const PAUSE: Text = Text::of("Pause", "Pause");
pub(in crate::console) const PLAY_HOVER: Text =
    Text::of("Plays the session or holds it. Key P", "Spielt die Sitzung ab oder hält sie fest. Taste P");
pub(in crate::console) const SPEED_HOVER: Text = Text::of("How fast the session is played", "Tempo der Wiedergabe");
pub(in crate::console) const COMPARE: Text = Text::of("Compare", "Vergleichen");
pub(in crate::console) const COMPARE_HOVER: Text = Text::of(
    "Shows another session beside this one, at the same time since its beginning; press again to end it",
    "Zeigt daneben eine andere Sitzung, zur gleichen Zeit seit ihrem Beginn; nochmals drücken beendet es",
);
pub(in crate::console) const BESIDE: Text =
    Text::of("Choose the session to show beside this one", "Sitzung zum Vergleich wählen");
pub(in crate::console) const FROM: Text = Text::of("From", "Von");
pub(in crate::console) const FROM_HOVER: Text =
    Text::of("The stretch to save begins at this moment", "Hier beginnt der Ausschnitt");
pub(in crate::console) const TO: Text = Text::of("To", "Bis");
pub(in crate::console) const TO_HOVER: Text =
    Text::of("The stretch to save ends at this moment", "Hier endet der Ausschnitt");
pub(in crate::console) const SAVE: Text = Text::of("Save the stretch", "Speichern");
pub(in crate::console) const SAVE_HOVER: Text = Text::of(
    "Writes what is between From and To as a session of its own, and keeps it",
    "Schreibt den Teil zwischen Von und Bis als eigene, gesicherte Sitzung",
);
pub(in crate::console) const SAVE_DISABLED_HOVER: Text =
    Text::of("Set From and To first: From must come before To", "Erst Von und Bis setzen: Von muss vor Bis liegen");

/// A factor of speed.
pub(in crate::console) fn speed(factor: f64) -> String {
    format!("{factor}\u{d7}")
}

/// A time of a session, s.
pub(in crate::console) fn clock(t_s: f64) -> String {
    let hours = (t_s / 3600.0).floor();
    let minutes = (t_s / 60.0).floor() % 60.0;
    let seconds = t_s % 60.0;
    if hours > 0.0 { format!("{hours}:{minutes:02}:{seconds:06.3}") } else { format!("{minutes}:{seconds:06.3}") }
}

/// The same to the second.
pub(in crate::console) fn short_clock(t_s: f64) -> String {
    clock(t_s.floor()).trim_end_matches(".000").to_owned()
}

/// The time on the screen, and the length of the session, s.
pub(in crate::console) fn position(t_s: f64, end_s: f64) -> String {
    told!("{} of {}", "{} von {}", clock(t_s), short_clock(end_s))
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
    utc.map_or_else(
        || word("unknown date", "Datum unbekannt").to_owned(),
        |utc| utc.replace('T', "  ").replace('Z', word(" UTC", " UTC")),
    )
}

/// A stretch of a session that begins at this time, s.
pub(in crate::console) fn stretch(from_s: f64) -> String {
    told!("from {}", "ab {}", short_clock(from_s))
}

/// Size of a file.
pub(in crate::console) fn megabytes(bytes: u64) -> String {
    told!("{:.0} MB", "{:.0} MB", bytes as f64 * 1e-6)
}

/// Which part of the session was read, 0 to 1.
pub(in crate::console) fn read(share: f64) -> String {
    told!("{:.0} % read", "{:.0} % gelesen", 100.0 * share)
}

/// An alarm of the moment on the screen.
pub(in crate::console) fn alarm_then(word: &str, cause: &str) -> String {
    told!("{word} then: {cause}", "{word} damals: {cause}")
}

/// Below the pointer on the time line.
pub(in crate::console) fn at(t_s: f64, words: &str) -> String {
    format!("{}  {words}", clock(t_s))
}

/// One of two sessions that are compared, and its time.
pub(in crate::console) fn half(name: &str, position: &str) -> String {
    format!("{name}  \u{b7}  {position}")
}

/// Largest forces in a short time: the measured one with its unit or the sign for one that is not known, and the rendered one, N.
pub(in crate::console) fn largest(t_s: f64, measured: &str, rendered_n: f32) -> String {
    told!(
        "{}\nLargest forces: measured {measured}, rendered {rendered_n:.2} N",
        "{}\nGrößte Kräfte: gemessen {measured}, dargestellt {rendered_n:.2} N",
        short_clock(t_s)
    )
}

/// Why what comes after a part is only plotted.
pub(in crate::console) fn limited(why: &str) -> String {
    told!("Cannot be replayed in full: {why}", "Nicht vollständig wiederzugeben: {why}")
}

/// The session cannot be shown.
pub(in crate::console) fn refused(why: &str) -> String {
    told!("This session cannot be shown: {why}", "Diese Sitzung ist nicht darstellbar: {why}")
}

/// Entries are missing in a journal.
pub(in crate::console) fn hole(lost: u64) -> String {
    told!("the recording lost {lost} entries here", "hier fehlen {lost} Einträge der Aufzeichnung")
}

/// A replay is not what was recorded.
pub(in crate::console) fn differs(t_s: f64) -> String {
    told!(
        "another version of this program recorded it, or the file was changed: it differs at {t_s:.3} s",
        "andere Programmversion oder geänderte Datei: weicht ab bei {t_s:.3} s"
    )
}

/// A part of the file is missing.
pub(in crate::console) fn without(name: &str) -> String {
    told!("the file holds no {name}", "in der Datei fehlt {name}")
}

/// A part of the file cannot be used.
pub(in crate::console) fn unusable(name: &str, why: &str) -> String {
    told!("its {name} cannot be used: {why}", "{name} darin ist unbrauchbar: {why}")
}

/// How a device was.
pub(in crate::console) fn device(name: DeviceName, standing: Standing) -> String {
    let name = device_name(name);
    let how = match standing {
        Standing::Closed => word("not opened", "nicht geöffnet"),
        Standing::Opening => word("being opened", "wird geöffnet"),
        Standing::Connected => word("connected", "verbunden"),
        Standing::Lost(loss) => return told!("{name}: lost: {}", "{name}: ausgefallen: {}", loss_words(loss)),
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
                told!(" ({verdict}, {error_n:.2} N on new data)", " ({verdict}, {error_n:.2} N auf neuen Daten)")
            }
            (Some(verdict), None) => format!(" ({verdict})"),
            (None, _) => String::new(),
        }
    };
    let gravity = if told("gravity_digest").is_some() {
        told!("gravity calibrated{}", "Schwerkraft kalibriert{}", result("gravity_verdict", "gravity_error_n"))
    } else {
        word("no gravity calibration", "ohne Schwerkraft-Kalibrierung").to_owned()
    };
    let network = told("network_date").map_or_else(
        || word("no network", "kein Netz").to_owned(),
        |date| {
            let of = |key: &str| told(key).map_or(word("unknown", "unbekannt"), String::as_str);
            let result = result("network_verdict", "network_error_n");
            told!(
                "network of {date} for sensor {}, tool {}{result}",
                "Netz vom {date} für Sensor {}, Instrument {}{result}",
                of("network_sensor"),
                of("network_tool")
            )
        },
    );
    let since =
        since_s.map_or_else(String::new, |since_s| told!(", in force since {}", ", gültig seit {}", clock(since_s)));
    told!("{side} arm: {gravity}, {network}{since}", "Arm {side}: {gravity}, {network}{since}")
}

/// Where a report is.
pub(in crate::console) fn reported(path: &Path) -> String {
    told!("Report: {}", "Bericht: {}", path.display())
}

/// There is no report.
pub(in crate::console) fn not_reported(why: &str) -> String {
    told!("No report: {why}", "Kein Bericht: {why}")
}

/// Where a stretch is.
pub(in crate::console) fn saved(path: &Path) -> String {
    told!("Saved: {}", "Gespeichert: {}", path.display())
}

/// A stretch was not saved.
pub(in crate::console) fn not_saved(why: &str) -> String {
    told!("Not saved: {why}", "Nicht gespeichert: {why}")
}

/// There is a file of this name.
pub(in crate::console) fn taken(path: &Path) -> String {
    told!("{} is there already", "{} gibt es schon", path.display())
}

/// A session was not deleted.
pub(in crate::console) fn not_deleted(path: &Path, error: &io::Error) -> String {
    told!("{} was not deleted: {error}", "{} wurde nicht gelöscht: {error}", path.display())
}
