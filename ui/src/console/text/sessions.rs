//! Sessions that are recorded.

use std::{io, path::Path, time::Duration};

use crate::console::sessions::Shown;

use crate::language::{Text, told, word};

pub(in crate::console) const NAME_KEEP: Text = Text::of("Keep this session", "Keep this session");
pub(in crate::console) const NAME_KEPT: Text = Text::of("This session is kept", "This session is kept");
pub(in crate::console) const CURE: Text = Text::of(
    "Free space or change the folder; if the recording has ended, start the rig again",
    "Free space or change the folder; if the recording has ended, start the rig again",
);

/// On the button that keeps a session: how long it has been recorded, and whether it is kept.
pub(in crate::console) fn recorded_for(seconds: u64, kept: bool) -> String {
    let what = if kept { word("Kept", "Kept") } else { word("Rec", "Rec") };
    let (hours, minutes, seconds) = (seconds / 3600, seconds / 60 % 60, seconds % 60);
    if hours > 0 {
        format!("{what} {hours}:{minutes:02}:{seconds:02}")
    } else {
        format!("{what} {minutes}:{seconds:02}")
    }
}

/// Below the pointer.
pub(in crate::console) fn hover(shown: &Shown) -> String {
    let what = if shown.kept {
        word(
            "This session is kept. Press to let it be deleted when room is needed (key K)",
            "This session is kept. Press to let it be deleted when room is needed (key K)",
        )
    } else {
        word(
            "Every session is recorded; the oldest make room for new ones. Press to keep this one (key K)",
            "Every session is recorded; the oldest make room for new ones. Press to keep this one (key K)",
        )
    };
    let lost = if shown.lost > 0 {
        told!("\n{} entries lost: the disk is too slow", "\n{} entries lost: the disk is too slow", shown.lost)
    } else {
        String::new()
    };
    let watched = shown.watched.iter().fold(String::new(), |words, one| {
        words + &told!("\nOthers watch at {}: {} now", "\nOthers watch at {}: {} now", one.at, one.watchers)
    });
    let (path, megabytes) = (shown.path.display(), shown.bytes as f64 * 1e-6);
    let pictures = if shown.pictures > 0 {
        told!("\n{} pictures of the endoscope", "\n{} pictures of the endoscope", shown.pictures)
    } else {
        String::new()
    };
    told!(
        "{what}\n{path}\n{megabytes:.1} MB, marks: {} (key E sets one){pictures}{lost}{watched}",
        "{what}\n{path}\n{megabytes:.1} MB, marks: {} (key E sets one){pictures}{lost}{watched}",
        shown.marks
    )
}

/// The folder cannot be used.
pub(in crate::console) fn no_folder(folder: &Path, error: &io::Error) -> String {
    told!("the folder {} cannot be used: {error}", "the folder {} cannot be used: {error}", folder.display())
}

/// The mark cannot be written or removed.
pub(in crate::console) fn not_kept(path: &Path, error: &io::Error) -> String {
    told!(
        "whether {} is kept cannot be changed: {error}",
        "whether {} is kept cannot be changed: {error}",
        path.display()
    )
}

/// The recording had to leave its place.
pub(in crate::console) fn moved(why: &str, to: &Path) -> String {
    told!("it goes on in {}, because: {why}", "it goes on in {}, because: {why}", to.display())
}

/// The disk does not answer.
pub(in crate::console) fn slow(waits: Duration) -> String {
    told!(
        "the disk has not answered for {:.1} s; after 2 s a part of the session is lost",
        "the disk has not answered for {:.1} s; after 2 s a part of the session is lost",
        waits.as_secs_f64()
    )
}

/// Entries are missing.
pub(in crate::console) fn lost(entries: u64) -> String {
    told!(
        "the disk is too slow: {entries} entries of this session are lost, a replay ends at the first of them",
        "the disk is too slow: {entries} entries of this session are lost, a replay ends at the first of them"
    )
}

/// Pictures are missing.
pub(in crate::console) fn pictures_lost(pictures: u64) -> String {
    told!(
        "the disk is too slow: {pictures} pictures of the endoscope are missing in this session, nothing else",
        "the disk is too slow: {pictures} pictures of the endoscope are missing in this session, nothing else"
    )
}

/// Cause of an alarm.
pub(in crate::console) fn cause(why: &str) -> String {
    told!("Recording: {why}", "Recording: {why}")
}

/// In the log of a session: a moment that the operator marked.
pub(in crate::console) fn mark(number: usize) -> String {
    told!("mark {number}", "mark {number}")
}

/// The cause of an alarm has appeared.
pub(in crate::console) fn alarm(cause: &str) -> String {
    told!("alarm: {cause}", "alarm: {cause}")
}

/// And it has ended.
pub(in crate::console) fn alarm_over(cause: &str) -> String {
    told!("alarm over: {cause}", "alarm over: {cause}")
}
