//! Sessions that are recorded.

use std::{io, path::Path, time::Duration};

use crate::language::{Text, text_format, word};

pub const NAME_KEEP: Text = Text::of("Keep this session", "Diese Sitzung sichern");
pub const NAME_KEPT: Text = Text::of("This session is kept", "Diese Sitzung ist gesichert");
pub const CURE: Text = Text::of(
    "Free disk space or change the folder; if the recording has ended, restart the rig",
    "Platz schaffen oder Ordner wechseln; ist die Aufzeichnung beendet, den Aufbau neu starten",
);

/// Returns the label of the button that keeps a session.
pub fn recorded_for(seconds: u64, kept: bool) -> String {
    let what = if kept { word("Kept", "Gesichert") } else { word("Rec", "Rec") };
    let hours = seconds / 3600;
    let minutes = seconds / 60 % 60;
    let seconds = seconds % 60;
    if hours > 0 {
        format!("{what} {hours}:{minutes:02}:{seconds:02}")
    } else {
        format!("{what} {minutes}:{seconds:02}")
    }
}

/// Returns the duration of the running recording and the room on the disk, if it is known.
pub fn recording(seconds: u64, free_bytes: Option<u64>) -> String {
    let clock = recorded_for(seconds, false);
    match free_bytes {
        Some(free_bytes) => format!("{clock}, {}", disk_left(free_bytes)),
        None => clock,
    }
}

pub fn disk_left(free_bytes: u64) -> String {
    let gigabytes = free_bytes as f64 * 1e-9;
    text_format!("{gigabytes:.0} GB left on the disk", "{gigabytes:.0} GB frei auf der Platte")
}

pub fn no_folder(folder: &Path, error: &io::Error) -> String {
    text_format!(
        "the folder {} cannot be used: {error}",
        "der Ordner {} ist nicht nutzbar: „{error}“",
        folder.display()
    )
}

pub fn not_kept(path: &Path, error: &io::Error) -> String {
    text_format!(
        "cannot change whether {} is kept: {error}",
        "die Sicherung von {} lässt sich nicht ändern: „{error}“",
        path.display()
    )
}

pub fn slow(waits: Duration) -> String {
    text_format!(
        "the disk has not responded for {:.1} s; after 2 s a part of the session is lost",
        "die Platte antwortet seit {:.1} s nicht; nach 2 s geht ein Teil der Sitzung verloren",
        waits.as_secs_f64()
    )
}

pub fn lost(entries: u64) -> String {
    text_format!(
        "the disk is too slow: {entries} entries of this session are lost; a replay ends at the first of them",
        "die Platte ist zu langsam: {entries} Einträge dieser Sitzung fehlen, eine Wiedergabe endet beim ersten davon"
    )
}

pub fn images_lost(images: u64) -> String {
    text_format!(
        "the disk is too slow: {images} endoscope images are missing from this session, but nothing else",
        "die Platte ist zu langsam: in dieser Sitzung fehlen {images} Endoskopbilder, sonst nichts"
    )
}

pub fn cause(why: &str) -> String {
    text_format!("Recording: {why}", "Aufzeichnung: {why}")
}

/// Returns the entry of the session log.
pub fn mark(number: usize) -> String {
    text_format!("mark {number}", "Marke {number}")
}

pub fn alarm(cause: &str) -> String {
    text_format!("alarm: {cause}", "Alarm: {cause}")
}

pub fn alarm_over(cause: &str) -> String {
    text_format!("alarm ended: {cause}", "Alarm beendet: {cause}")
}
