//! Recorded sessions: their list, and playback.

use std::{
    collections::BTreeMap,
    io,
    path::Path,
    time::{Duration, UNIX_EPOCH},
};

use jiff::{Timestamp, tz::TimeZone};
use nima_devices::ConnectionState;
use nima_machine::rig::DeviceName;
use nima_recording::store::utc_of;

use crate::language::{Text, text_format, word};
use crate::report_text::{device_name, loss_text};

pub const RECORDINGS: Text = Text::of("Recordings", "Aufzeichnungen");
pub const SESSIONS: Text = Text::of("Sessions", "Sitzungen");
pub const SESSIONS_HOVER: Text = Text::of(
    "Recorded sessions: play, keep, report or delete them. F7",
    "Aufgezeichnete Sitzungen: ansehen, sichern, auswerten, löschen. F7",
);
pub const LIST: Text = Text::of("Recorded sessions", "Aufgezeichnete Sitzungen");
pub const EMPTY: Text = Text::of("No session has been recorded yet", "Noch keine Sitzung aufgezeichnet");
pub const NO_SHELF: Text =
    Text::of("No data folder was found: set NIMA_DATA_DIR", "Kein Datenordner gefunden: NIMA_DATA_DIR setzen");
pub const LOOKING: Text = Text::of("Reading the folder", "Ordner wird gelesen");
pub const RECORDING: Text = Text::of("being recorded", "wird aufgezeichnet");
pub const OPEN: Text = Text::of("Open", "Öffnen");
pub const OPEN_HOVER: Text = Text::of(
    "Shows the session in all views; the machine keeps running",
    "Zeigt die Sitzung in allen Ansichten; die Maschine läuft weiter",
);
pub const KEEP: Text = Text::of("Keep", "Sichern");
pub const KEPT: Text = Text::of("Kept", "Gesichert");
pub const KEEP_HOVER: Text = Text::of(
    "A kept session is never deleted to make room for new ones",
    "Eine gesicherte Sitzung wird nie gelöscht, um Platz zu schaffen",
);
pub const REPORT: Text = Text::of("Report", "Bericht");
pub const REPORT_HOVER: Text = Text::of(
    "Writes a page with the results of this session and opens it",
    "Schreibt eine Seite mit den Werten dieser Sitzung und öffnet sie",
);
pub const DELETE: Text = Text::of("Delete", "Löschen");
pub const DELETE_HOVER: Text = Text::of("Deletes the file after you confirm", "Löscht die Datei nach einer Rückfrage");
pub const DELETE_KEPT_HOVER: Text =
    Text::of("A kept session cannot be deleted", "Gesicherte Sitzungen sind nicht löschbar");
pub const DELETE_RUNNING_HOVER: Text =
    Text::of("This session is still being recorded", "Diese Sitzung wird noch aufgezeichnet");
pub const DELETE_NOW: Text = Text::of("Delete it?", "Löschen?");
pub const DELETE_NOW_HOVER: Text = Text::of("Deletes the file permanently", "Löscht die Datei endgültig");
pub const TIME: Text = Text::of("Time", "Zeit");
pub const SCENE: Text = Text::of("Scene", "Szene");
pub const MODE: Text = Text::of("Mode", "Modus");
pub const LENGTH: Text = Text::of("Length", "Dauer");
pub const SIZE: Text = Text::of("Size", "Größe");
pub const ALARMS: Text = Text::of("Alarms", "Alarme");
pub const NOTE: Text = Text::of("Note", "Notiz");
pub const NOTE_HOVER: Text = Text::of(
    "A note of this session, saved in a file next to it",
    "Notiz zu dieser Sitzung, gesichert in einer Datei daneben",
);
pub const SORT_HOVER: Text = Text::of("Sorts the list by this column", "Sortiert nach dieser Spalte");
pub const SEARCH: Text = Text::of("Search sessions", "Sitzungen suchen");
pub const NOT_FOUND: Text = Text::of("No session matches the search", "Keine Sitzung passt zur Suche");
pub const OPEN_FOLDER: Text = Text::of("Open folder", "Ordner öffnen");
pub const BACK: Text = Text::of("Back to the view", "Zurück zur Ansicht");
pub const ELSEWHERE: Text = Text::of("Open file…", "Datei öffnen…");
pub const ELSEWHERE_HOVER: Text = Text::of(
    "Opens a session, or the forces and positions of another program's recording (CSV, MCAP), from any folder; the list has only your sessions",
    "Öffnet eine Sitzung oder Kräfte und Positionen einer Aufzeichnung eines anderen Programms (CSV, MCAP) aus einem beliebigen Ordner; die Liste enthält nur Ihre Sitzungen",
);
pub const REPORTING: Text = Text::of("Writing the report", "Bericht wird geschrieben");
pub const CUTTING: Text = Text::of("Saving the excerpt", "Ausschnitt wird gespeichert");
pub const NO_THREAD: Text =
    Text::of("The system cannot start another thread", "Das System kann keinen weiteren Thread starten");

pub const PAST: Text = Text::of("PLAYBACK", "WIEDERGABE");
pub const PAST_HOVER: Text = Text::of(
    "Everything inside this frame is recorded. The bar above shows the machine now, and Stop stops the machine.",
    "Alles in diesem Rahmen ist aufgezeichnet. Die Leiste darüber zeigt die Maschine jetzt, und Halt hält die \
     Maschine an.",
);
pub const MACHINE: Text = Text::of("Machine now", "Die Maschine jetzt");
pub const LIVE_AGAIN: Text = Text::of("Return to live (L)", "Zurück zu live (L)");
pub const LIVE_AGAIN_HOVER: Text = Text::of(
    "Closes the session; the screen shows the machine again",
    "Schließt die Sitzung und zeigt wieder die Maschine",
);
pub const BLOCKED: Text =
    Text::of("Not during playback: press L first", "Nicht während der Wiedergabe: erst L drücken");
pub const OPENING: Text = Text::of("Opening the session", "Sitzung wird geöffnet");
pub const WHOLE: Text = Text::of("Replayed bit by bit", "Bitgenau wiedergegeben");
pub const PLOTTED: Text = Text::of(
    "Forces, positions and states; the rest is loading",
    "Kräfte, Positionen und Zustände; der Rest wird geladen",
);
pub const PLOTTED_ONLY: Text = Text::of("Only forces, positions and states", "Nur Kräfte, Positionen und Zustände");
pub const OF_ANOTHER_PROGRAM: Text =
    Text::of("recorded by another program", "von einem anderen Programm aufgezeichnet");
pub const ONLY_SESSIONS: Text = Text::of("Only for sessions of this program", "Nur für Sitzungen dieses Programms");
pub const SIMULATED: Text = Text::of(
    "This rig has no devices: everything was simulated",
    "Dieser Aufbau hat keine Geräte: alles war simuliert",
);
pub const NOT_OF_DEVICES: Text = Text::of(
    "A session does not contain the devices' own counters and readings (rates, losses, ages, sensor bias drift) \
     or the pages of the wizards",
    "Nicht in der Sitzung: eigene Zähler und Messwerte der Geräte (Raten, Verluste, Alter, Drift des \
     Sensor-Nullpunkts) und die Seiten der Assistenten",
);
pub const TIMELINE: Text = Text::of("Time of the session", "Zeit der Sitzung");
pub const PLAY: Text = Text::of("Play", "Abspielen");
pub const PAUSE: Text = Text::of("Pause", "Pause");
pub const PLAY_HOVER: Text =
    Text::of("Plays or pauses the session. Key P", "Spielt die Sitzung ab oder pausiert sie. Taste P");
pub const SPEED_HOVER: Text = Text::of("Playback speed", "Tempo der Wiedergabe");
pub const COMPARE: Text = Text::of("Compare", "Vergleichen");
pub const COMPARE_HOVER: Text = Text::of(
    "Shows another session next to this one, at the same time since its start; press again to end the comparison",
    "Zeigt daneben eine andere Sitzung, zur gleichen Zeit seit ihrem Beginn; nochmals drücken beendet den \
     Vergleich",
);
pub const BESIDE: Text = Text::of("Choose the session to compare with", "Sitzung zum Vergleich wählen");
pub const FROM: Text = Text::of("From", "Von");
pub const FROM_HOVER: Text = Text::of("The excerpt starts here", "Hier beginnt der Ausschnitt");
pub const TO: Text = Text::of("To", "Bis");
pub const TO_HOVER: Text = Text::of("The excerpt ends here", "Hier endet der Ausschnitt");
pub const SAVE: Text = Text::of("Save excerpt", "Ausschnitt speichern");
pub const SAVE_HOVER: Text = Text::of(
    "Saves the part between From and To as a separate, kept session",
    "Schreibt den Teil zwischen Von und Bis als eigene, gesicherte Sitzung",
);
pub const SAVE_DISABLED_HOVER: Text =
    Text::of("Set From and To first: From must be before To", "Erst Von und Bis setzen: Von muss vor Bis liegen");

pub fn speed(factor: f64) -> String {
    format!("{factor}\u{d7}")
}

/// Returns the time of a session, s, with milliseconds.
pub fn clock(t_s: f64) -> String {
    let hours = (t_s / 3600.0).floor();
    let minutes = (t_s / 60.0).floor() % 60.0;
    let seconds = t_s % 60.0;
    if hours > 0.0 { format!("{hours}:{minutes:02}:{seconds:06.3}") } else { format!("{minutes}:{seconds:06.3}") }
}

/// Returns the time of a session, s, in whole seconds.
pub fn short_clock(t_s: f64) -> String {
    clock(t_s.floor()).trim_end_matches(".000").to_owned()
}

/// Returns the time on the screen, and length of the session, s.
pub fn position(t_s: f64, end_s: f64) -> String {
    text_format!("{} of {}", "{} von {}", clock(t_s), short_clock(end_s))
}

/// Returns the date and time, from ns since 1970.
pub fn when(time_ns: u64) -> String {
    let utc = utc_of(UNIX_EPOCH + Duration::from_nanos(time_ns)).replace('T', "  ");
    format!("{}.{} UTC", utc.trim_end_matches('Z'), time_ns / 100_000_000 % 10)
}

pub fn of_session(when: &str, name: &str) -> String {
    format!("{when}  \u{b7}  {name}")
}

/// Returns date and time on this computer's clock, from a time in UTC (ISO 8601).
pub fn began(utc: Option<&str>) -> String {
    let unknown = || word("unknown date", "Datum unbekannt").to_owned();
    let Some(utc) = utc else { return unknown() };
    let local = |begin: Timestamp| begin.to_zoned(TimeZone::system()).strftime("%F  %T").to_string();
    utc.parse().map_or_else(|_| unknown(), local)
}

/// Returns the accessible name of the note of a session.
pub fn note_of(session: &str) -> String {
    text_format!("Note of {session}", "Notiz zu {session}")
}

/// Returns the accessible name of a heading.
pub fn sort_by(column: &str) -> String {
    text_format!("Sort by {column}", "Sortieren nach {column}")
}

pub fn note_not_saved(error: &io::Error) -> String {
    text_format!("The note cannot be saved: {error}", "Die Notiz lässt sich nicht sichern: {error}")
}

pub fn stretch(from_s: f64) -> String {
    text_format!("from {}", "ab {}", short_clock(from_s))
}

pub fn megabytes(bytes: u64) -> String {
    text_format!("{:.0} MB", "{:.0} MB", bytes as f64 * 1e-6)
}

/// `fraction`: fraction of the session that was read, 0 to 1.
pub fn read(fraction: f64) -> String {
    text_format!("{:.0} % read", "{:.0} % gelesen", 100.0 * fraction)
}

pub fn alarm_then(word: &str, cause: &str) -> String {
    text_format!("{word} then: {cause}", "{word} damals: {cause}")
}

pub fn at(t_s: f64, words: &str) -> String {
    format!("{}  {words}", clock(t_s))
}

pub fn half(name: &str, position: &str) -> String {
    format!("{name}  \u{b7}  {position}")
}

/// Both forces have their unit, or are the sign for an unknown force.
pub fn largest(t_s: f64, measured: &str, rendered: &str) -> String {
    text_format!(
        "{}\nLargest forces: measured {measured}, rendered {rendered}",
        "{}\nGrößte Kräfte: gemessen {measured}, dargestellt {rendered}",
        short_clock(t_s)
    )
}

/// The axes of another program's recording on which force and position are known, such as "x, z".
pub fn known_signals(force: &str, position: &str) -> String {
    let axes = |axes: &str| if axes.is_empty() { word("unknown", "unbekannt").to_owned() } else { axes.to_owned() };
    text_format!(
        "Recorded by another program. Force: {}. Position: {}. Everything else is unknown.",
        "Von einem anderen Programm aufgezeichnet. Kraft: {}. Position: {}. Alles andere ist unbekannt.",
        axes(force),
        axes(position)
    )
}

/// Returns forces and positions at a moment, with their units.
pub fn values_now(force: &str, position: &str) -> String {
    text_format!("Force  {force}     Position  {position}", "Kraft  {force}     Position  {position}")
}

pub fn limited(why: &str) -> String {
    text_format!("Cannot be replayed in full: {why}", "Nicht vollständig wiederzugeben: {why}")
}

/// `line`: data that the session lacks.
pub fn lacks(line: &str) -> String {
    text_format!("Not complete: {line}", "Nicht vollständig: „{line}“")
}

pub fn refused(why: &str) -> String {
    text_format!("This recording cannot be shown: {why}", "Diese Aufzeichnung ist nicht darstellbar: {why}")
}

/// Why another program's recording is not shown with the usual names.
pub fn unnamed(why: &str) -> String {
    text_format!(
        "{why}. To select its signals, start it with `nima view FILE --map NAME=COLUMN`",
        "{why}. Um seine Signale zu wählen, mit `nima view DATEI --map NAME=SPALTE` starten"
    )
}

pub fn hole(lost: u64) -> String {
    text_format!("{lost} entries of the recording are missing here", "hier fehlen {lost} Einträge der Aufzeichnung")
}

pub fn differs(t_s: f64) -> String {
    text_format!(
        "recorded by a different version of this program, or the file was changed: the replay differs at {t_s:.3} s",
        "andere Programmversion oder geänderte Datei: weicht ab bei {t_s:.3} s"
    )
}

pub fn without(name: &str) -> String {
    text_format!("the file has no {name}", "in der Datei fehlt {name}")
}

pub fn unusable(name: &str, why: &str) -> String {
    text_format!("its {name} cannot be used: {why}", "{name} darin ist unbrauchbar: {why}")
}

pub fn device(name: DeviceName, standing: ConnectionState) -> String {
    let name = device_name(name);
    let how = match standing {
        ConnectionState::Closed => word("not opened", "nicht geöffnet"),
        ConnectionState::Opening => word("being opened", "wird geöffnet"),
        ConnectionState::Connected => word("connected", "verbunden"),
        ConnectionState::Lost(loss) => {
            return text_format!("{name}: lost: {}", "{name}: ausgefallen: {}", loss_text(loss));
        }
    };
    format!("{name}: {how}")
}

/// Returns the calibrations of a side, from the metadata of the session; used since this time, s, or since the
/// beginning.
pub fn calibrations(side: &str, table: &BTreeMap<String, String>, since_s: Option<f64>) -> String {
    let report = |key: &str| table.get(key).filter(|value| !value.is_empty());
    // Verdict and error on held-out data.
    let result = |verdict: &str, error_n: &str| {
        let error_n = report(error_n).and_then(|error_n| error_n.parse::<f64>().ok());
        match (report(verdict), error_n) {
            (Some(verdict), Some(error_n)) => {
                text_format!(" ({verdict}, {error_n:.2} N on new data)", " ({verdict}, {error_n:.2} N auf neuen Daten)")
            }
            (Some(verdict), None) => format!(" ({verdict})"),
            (None, _) => String::new(),
        }
    };
    let gravity = if report("gravity_digest").is_some() {
        text_format!("gravity calibrated{}", "Schwerkraft kalibriert{}", result("gravity_verdict", "gravity_error_n"))
    } else {
        word("no gravity calibration", "ohne Schwerkraft-Kalibrierung").to_owned()
    };
    let network = report("network_date").map_or_else(
        || word("no network", "kein Netz").to_owned(),
        |date| {
            let of = |key: &str| report(key).map_or(word("unknown", "unbekannt"), String::as_str);
            let result = result("network_verdict", "network_error_n");
            text_format!(
                "network of {date} for sensor {}, tool {}{result}",
                "Netz vom {date} für Sensor {}, Instrument {}{result}",
                of("network_sensor"),
                of("network_tool")
            )
        },
    );
    let since = since_s
        .map_or_else(String::new, |since_s| text_format!(", used since {}", ", verwendet seit {}", clock(since_s)));
    text_format!("{side} arm: {gravity}, {network}{since}", "Arm {side}: {gravity}, {network}{since}")
}

pub fn reported(path: &Path) -> String {
    text_format!("Report: {}", "Bericht: {}", path.display())
}

pub fn not_reported(why: &str) -> String {
    text_format!("No report: {why}", "Kein Bericht: „{why}“")
}

pub fn saved(path: &Path) -> String {
    text_format!("Saved: {}", "Gespeichert: {}", path.display())
}

pub fn not_saved(why: &str) -> String {
    text_format!("Not saved: {why}", "Nicht gespeichert: {why}")
}

pub fn taken(path: &Path) -> String {
    text_format!("{} already exists", "{} gibt es schon", path.display())
}

pub fn not_deleted(path: &Path, error: &io::Error) -> String {
    text_format!("{} was not deleted: {error}", "{} wurde nicht gelöscht: „{error}“", path.display())
}
