//! The ready check.

use crate::language::{Text, text_format};

pub const TITLE: Text = Text::of("Ready check", "Startprüfung");
pub const MEANING: Text = Text::of(
    "Before the first engagement of the day: devices, calibrations, stop and watchdogs, in less than a minute",
    "Vor dem ersten Koppeln des Tages: Geräte, Kalibrierungen, Halt und Watchdogs, in unter einer Minute",
);
pub const OPEN: Text = Text::of("Ready check…", "Startprüfung…");
pub const WAITS: Text = Text::of(
    "Waiting for the force sensors to report their serial numbers",
    "Warten auf die Seriennummern der Kraftsensoren",
);
pub const NOW: Text = Text::of("Now", "Jetzt");
pub const BY_ITSELF: Text = Text::of("Running automatically; please wait", "Läuft automatisch; bitte warten");
pub const PASSED: Text = Text::of("Ready: all checks passed", "Bereit: alle Punkte bestanden");
pub const FAILED: Text = Text::of("Not ready: see the failed checks", "Nicht bereit: siehe fehlerhafte Punkte");
pub const CLOSE: Text = Text::of("Continue to Engage", "Weiter zum Koppeln");
pub const CLOSE_HOVER: Text =
    Text::of("Returns to the monitor, where Engage is highlighted", "Zurück zum Monitor, wo Koppeln hervorgehoben ist");
/// Reason why nothing can be engaged meanwhile.
pub const ENGAGE_CLOSED: Text = Text::of(
    "Not during the ready check: finish it or close it first",
    "Nicht während der Startprüfung: erst beenden oder schließen",
);
pub const AGAIN: Text = Text::of("Repeat failed checks", "Fehlerhafte Punkte wiederholen");
pub const AGAIN_HOVER: Text = Text::of("Passed checks keep their results", "Bestandene Punkte behalten ihr Ergebnis");
pub const WHOLE: Text = Text::of("Repeat all checks", "Alle Punkte wiederholen");
pub const WHOLE_HOVER: Text = Text::of("Starts with the first check", "Beginnt mit dem ersten Punkt");
pub const BY: Text = Text::of("Checked by", "Prüfer");
pub const BY_HOVER: Text = Text::of("This name is written into the record", "Dieser Name kommt ins Protokoll");

pub fn line(check: &str, words: &str) -> String {
    format!("{check}: {words}")
}

pub fn left_out(check: &str, why: &str) -> String {
    text_format!("{check}: skipped, {why}", "{check}: ausgelassen, {why}")
}

pub fn saved(path: &std::path::Path) -> String {
    text_format!("Saved in {}", "Gespeichert in {}", path.display())
}

pub fn not_saved(reason: &str) -> String {
    text_format!("The record was not saved: {reason}", "Protokoll nicht gespeichert: {reason}")
}

pub fn took(seconds: f64) -> String {
    format!("{seconds:.0} s")
}
