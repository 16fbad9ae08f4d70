//! The view of both forces in force space.

use crate::language::{Text, text_format};

pub const NAME: Text = Text::of("Force space", "Kraftraum");
pub const MEANING: Text = Text::of(
    "Measured and rendered force of the last seconds, drawn in 3-D",
    "Gemessene und dargestellte Kraft der letzten Sekunden in 3-D",
);

pub const HOVER: Text = Text::of(
    "Measured and rendered force of the last six seconds in force space (N, world axes), one line each. The dot \
     is the force now, or at the time under the pointer in a trace. The three rings are an ellipsoid around the \
     force measured now; it contains 95 % of the errors (rendered minus measured) if they are normally \
     distributed. The percentage that it really contains is given below. The dashed circle is the force ceiling. \
     Drag to turn, double-click to reset.",
    "Gemessene und dargestellte Kraft der letzten sechs Sekunden im Kraftraum (N, Weltachsen), je eine Linie. Der \
     Punkt ist die Kraft jetzt oder zur Zeit unter dem Zeiger in einem Verlauf. Die drei Ringe sind ein Ellipsoid um \
     die jetzt gemessene Kraft; es enthält 95 % der Fehler (dargestellt minus gemessen), falls sie normalverteilt \
     sind. Der tatsächlich enthaltene Anteil steht darunter. Der gestrichelte Kreis ist die Höchstkraft. Ziehen dreht, \
     Doppelklick setzt zurück.",
);

pub const RESET: Text = Text::of("Reset", "Zurücksetzen");
pub const RESET_HOVER: Text =
    Text::of("Shows both forces from the first direction again", "Zeigt wieder beide Kräfte aus der ersten Richtung");

/// Returns the name of a force with its magnitude.
pub fn magnitude(name: &str, force: &str) -> String {
    format!("{name} |f| {force}")
}

/// Returns the accessible name of the plot.
pub fn canvas(words: &str) -> String {
    text_format!("Force space. {words}", "Kraftraum. {words}")
}

/// Returns two lines, separated by a semicolon.
pub fn unknown(seconds: f64) -> String {
    text_format!(
        "Last {seconds:.0} s; the measured force is currently unknown",
        "Letzte {seconds:.0} s; die gemessene Kraft ist jetzt unbekannt"
    )
}

/// Returns two lines, separated by a semicolon.
pub fn too_short(seconds: f64) -> String {
    text_format!(
        "Last {seconds:.0} s; the error ellipsoid needs one second of data",
        "Letzte {seconds:.0} s; das Fehlerellipsoid braucht eine Sekunde Daten"
    )
}

/// Returns two lines, separated by a semicolon. Mean and half axes in N, `percent` of samples inside.
pub fn error(seconds: f64, mean_n: f64, [a, b, c]: [f64; 3], percent: f64) -> String {
    text_format!(
        "Error, last {seconds:.0} s: mean {mean_n:.2} N, 95 % half axes; {a:.2}, {b:.2}, {c:.2} N (contains \
         {percent:.0} %)",
        "Fehler, letzte {seconds:.0} s: Mittel {mean_n:.2} N, 95-%-Halbachsen; {a:.2}, {b:.2}, {c:.2} N (enthält \
         {percent:.0} %)"
    )
}
