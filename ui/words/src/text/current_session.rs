//! The session that is being recorded, as the screen shows it.

use std::path::PathBuf;

use super::sessions::disk_left;
use crate::language::{text_format, word};

/// Address and number of viewers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WatchStatus {
    /// The address that a viewer enters.
    pub at: String,
    pub watchers: usize,
}

#[derive(Clone, Debug, PartialEq)]
pub struct DisplayState {
    /// Duration of the recording.
    pub seconds: u64,
    pub kept: bool,
    pub path: PathBuf,
    pub bytes: u64,
    /// Free bytes on the disk; `None` if the system does not report them.
    pub free_bytes: Option<u64>,
    /// Entries lost because the disk was slower than the loop.
    pub lost: u64,
    /// Number of endoscope images.
    pub images: u64,
    /// Number of marks.
    pub marks: usize,
    /// Addresses and numbers of live viewers.
    pub watched: Vec<WatchStatus>,
}

impl DisplayState {
    /// Explains the recording.
    pub fn explained(&self) -> String {
        let what = if self.kept {
            word(
                "This session is kept. Press to allow its deletion when space is needed (key K)",
                "Diese Sitzung ist gesichert. Drücken gibt sie zum Löschen bei Platzmangel frei (Taste K)",
            )
        } else {
            word(
                "Every session is recorded, and the oldest are deleted to make room. Press to keep this one (key K)",
                "Jede Sitzung wird aufgezeichnet, die ältesten werden bei Platzmangel gelöscht. Drücken sichert \
                 diese (Taste K)",
            )
        };
        let lost = if self.lost > 0 {
            text_format!(
                "\n{} entries lost: the disk is too slow",
                "\n{} Einträge verloren: die Platte ist zu langsam",
                self.lost
            )
        } else {
            String::new()
        };
        let watched = self.watched.iter().fold(String::new(), |words, one| {
            words + &text_format!("\nShared at {}: {} watching", "\nZuschauer über {}: jetzt {}", one.at, one.watchers)
        });
        let disk = self.free_bytes.map_or_else(String::new, |free_bytes| format!("\n{}", disk_left(free_bytes)));
        let path = self.path.display();
        let megabytes = self.bytes as f64 * 1e-6;
        let images = if self.images > 0 {
            text_format!("\n{} endoscope images", "\n{} Endoskopbilder", self.images)
        } else {
            String::new()
        };
        text_format!(
            "{what}\n{path}\n{megabytes:.1} MB, marks: {} (key E sets one){images}{disk}{lost}{watched}",
            "{what}\n{path}\n{megabytes:.1} MB, Marken: {} (Taste E setzt eine){images}{disk}{lost}{watched}",
            self.marks
        )
    }
}
