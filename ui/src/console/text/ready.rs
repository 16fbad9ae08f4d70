//! The ready check.

use crate::language::{Text, told};

pub(in crate::console) const TITLE: Text = Text::of("Ready check", "Startprüfung");
pub(in crate::console) const MEANING: Text = Text::of(
    "Before the first engagement of the day: devices, calibrations, stop and watchdogs, in less than a minute",
    "Vor dem ersten Koppeln des Tages: Geräte, Kalibrierungen, Halt und Watchdogs, in unter einer Minute",
);
pub(in crate::console) const OPEN: Text = Text::of("Ready check…", "Startprüfung…");
pub(in crate::console) const WAITS: Text =
    Text::of("Waiting for the force sensors to tell who they are", "Warten auf die Kennung der Kraftsensoren");
pub(in crate::console) const NOW: Text = Text::of("Now", "Jetzt");
pub(in crate::console) const BY_ITSELF: Text = Text::of("This goes by itself: wait", "Läuft von selbst: warten");
pub(in crate::console) const PASSED: Text =
    Text::of("Ready: every point is in order", "Bereit: alle Punkte in Ordnung");
pub(in crate::console) const FAILED: Text =
    Text::of("Not ready: see the points that failed", "Nicht bereit: siehe fehlerhafte Punkte");
pub(in crate::console) const CLOSE: Text = Text::of("To the monitor", "Zum Monitor");
pub(in crate::console) const CLOSE_HOVER: Text = Text::of("Where the rig is engaged", "Dort wird der Aufbau gekoppelt");
pub(in crate::console) const AGAIN: Text = Text::of("Check again what failed", "Fehlerhafte Punkte neu prüfen");
pub(in crate::console) const AGAIN_HOVER: Text =
    Text::of("The points that passed keep their results", "Bestandene Punkte behalten ihr Ergebnis");
pub(in crate::console) const WHOLE: Text = Text::of("Check everything again", "Alles neu prüfen");
pub(in crate::console) const WHOLE_HOVER: Text =
    Text::of("Starts with the first point", "Beginnt mit dem ersten Punkt");
pub(in crate::console) const BY: Text = Text::of("Who checks", "Prüfer");
pub(in crate::console) const BY_HOVER: Text =
    Text::of("This name is written into the record", "Dieser Name kommt ins Protokoll");

/// A point with its figure or cause.
pub(in crate::console) fn line(check: &str, words: &str) -> String {
    format!("{check}: {words}")
}

/// A point that the rig cannot have.
pub(in crate::console) fn left_out(check: &str, why: &str) -> String {
    told!("{check}: left out, {why}", "{check}: ausgelassen, {why}")
}

/// Where the record is.
pub(in crate::console) fn saved(path: &std::path::Path) -> String {
    told!("Kept in {}", "Gespeichert in {}", path.display())
}

/// It could not be kept.
pub(in crate::console) fn not_saved(reason: &str) -> String {
    told!("The record is not kept: {reason}", "Protokoll nicht gespeichert: {reason}")
}

/// Since when it goes on, s.
pub(in crate::console) fn took(seconds: f64) -> String {
    format!("{seconds:.0} s")
}
