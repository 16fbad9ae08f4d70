//! The Prediction error panel, which compares the modes.

use crate::language::{Text, text_format};

pub const NAME: Text = Text::of("Prediction error", "Vorhersagefehler");
pub const MEANING: Text = Text::of(
    "Difference between the force that each mode would render now, before the gates, and the force measured now \
     (N, 3-D distance, mean of the last four seconds). Each mode receives only data as old as the link's delay. \
     All modes are always computed.",
    "Differenz zwischen der Kraft, die jeder Modus jetzt vor den Sperren darstellen würde, und der jetzt \
     gemessenen (N, 3-D-Abstand, Mittel der letzten vier Sekunden). Jeder Modus erhält nur Daten, die so alt \
     sind wie die Verzögerung der Verbindung. Alle Modi werden ständig berechnet.",
);

pub const LAST_3_MIN: Text = Text::of("last 3 min", "letzte 3 min");
pub const REFERENCE: Text = Text::of("reference", "Referenz");
pub const COMPARE: Text = Text::of("Compare all modes", "Alle Modi vergleichen");
pub const COMPARE_HOVER: Text = Text::of(
    "Computes every mode on the same samples and shows its error. Otherwise only the mode in use is computed, \
     which takes less time. The force in the hand does not change.",
    "Berechnet jeden Modus auf denselben Messwerten und zeigt seinen Fehler. Sonst wird nur der aktive Modus \
     berechnet, das braucht weniger Zeit. Die Kraft in der Hand ändert sich nicht.",
);
pub const IN_USE: Text = Text::of(" (in use)", " (aktiv)");

pub fn ahead(delay_ms: f64) -> String {
    text_format!(
        "Mean error {delay_ms:.0} ms ahead, last seconds; line: delayed DFR",
        "Mittlerer Fehler {delay_ms:.0} ms voraus, letzte Sekunden; Linie: verzögerte DFR"
    )
}

/// Like [`ahead`], for an audience.
pub fn ahead_plain(delay_ms: f64) -> String {
    text_format!(
        "Mean error {delay_ms:.0} ms ahead; line: direct reflection",
        "Mittlerer Fehler {delay_ms:.0} ms voraus; Linie: direkte Reflexion"
    )
}

/// Name of direct force reflection, for an audience.
pub const DIRECT: Text = Text::of("Direct reflection", "Direkte Reflexion");

/// Returns how many times the error of direct reflection an error is, for an audience.
pub fn times_direct(times: &str) -> String {
    text_format!("{times}x direct", "{times}x direkt")
}

/// Returns the mean errors of the two curves of the trend, with their unit.
pub fn trend(seconds: usize, mode: &str, error: &str, reference: &str, dfr: &str) -> String {
    text_format!(
        "Last {seconds} s: {mode} {error}, {reference} {dfr}",
        "Letzte {seconds} s: {mode} {error}, {reference} {dfr}"
    )
}

pub const DELAYED_DFR: Text = Text::of("delayed DFR", "verzögerte DFR");

pub fn trend_name(trend: &str) -> String {
    text_format!("Error over the last minutes. {trend}", "Fehler der letzten Minuten. {trend}")
}

pub fn trend_meaning(trend: &str) -> String {
    text_format!(
        "{trend}\nMean prediction error (N) of each second, for up to three minutes",
        "{trend}\nMittlerer Vorhersagefehler (N) jeder Sekunde, bis zu drei Minuten"
    )
}

/// Returns the accessible name of a bar.
pub fn error(words: &str) -> String {
    text_format!("Error {words}", "Fehler {words}")
}
