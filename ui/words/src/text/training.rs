//! Progress of a trial of a training scene.

use crate::language::{Text, text_format, word};

pub fn lumps_marked(marked: u32, is_led: bool) -> String {
    let keys = if is_led {
        word(" (X marks, D ends the trial, N restarts it)", " (X markiert, D beendet den Versuch, N startet ihn neu)")
    } else {
        ""
    };
    text_format!("Places marked: {marked}{keys}", "Markierte Stellen: {marked}{keys}")
}

pub fn lumps_found(found: u32, lumps: u32, mark_false: u32) -> String {
    text_format!(
        "Lumps found: {found} of {lumps}, false marks: {mark_false}",
        "Gefundene Knoten: {found} von {lumps}, falsche Marken: {mark_false}"
    )
}

pub fn wire(touches: u32, fraction: f64, ended: bool, is_led: bool) -> String {
    let keys = if is_led { word(" (N restarts the trial)", " (N startet den Versuch neu)") } else { "" };
    if ended {
        return text_format!("Goal reached, touches: {touches}{keys}", "Ziel erreicht, Berührungen: {touches}{keys}");
    }
    text_format!(
        "Path to the goal: {:.0} %, touches: {touches}{keys}",
        "Weg zum Ziel: {:.0} %, Berührungen: {touches}{keys}",
        100.0 * fraction
    )
}

pub const JAWS_ABOVE: Text = Text::of("above a ring", "über einem Ring");
pub const JAWS_AROUND: Text = Text::of("around a ring", "um einen Ring");
pub const JAWS_HOLD: Text = Text::of("holds a ring", "hält einen Ring");

pub fn jaws(side: &str, with_ring: Option<&str>) -> String {
    let with_ring = with_ring.map(|words| format!(" {words}")).unwrap_or_default();
    let after = side.to_lowercase();
    text_format!("{side} instrument{with_ring}", "Instrument {after}{with_ring}")
}

/// Peg transfer; `led` from [`jaws`]. Ways that rings still have to go (there and back), and counts of rings passed in
/// mid-air, placed on pegs and dropped.
pub fn rings(led: Option<&str>, [left, passed, placed, dropped]: [u32; 4], ended: bool) -> String {
    let led = led.map(|words| format!("{words}. ")).unwrap_or_default();
    if ended {
        return text_format!(
            "Task done. {led}Rings: passed {passed}, placed {placed}, dropped {dropped}",
            "Fertig. {led}Ringe: übergeben {passed}, gesetzt {placed}, gefallen {dropped}"
        );
    }
    text_format!(
        "{led}Rings: {left} to go, passed {passed}, placed {placed}, dropped {dropped}",
        "{led}Ringe: noch {left}, übergeben {passed}, gesetzt {placed}, gefallen {dropped}"
    )
}

/// Returns the line of a trial with its time, minutes and seconds.
pub fn timed(seconds: f64, words: &str) -> String {
    let seconds = seconds.max(0.0) as u64;
    format!("{}:{:02}   {words}", seconds / 60, seconds % 60)
}

pub const CHOOSE_MATCHED: Text = Text::of(
    "Two hands on one ring can end in a fault in the current mode: choose Matched",
    "Zwei Hände an einem Ring können im aktuellen Modus zu einer Störung führen: Abgeglichen wählen",
);
