//! The Traces panel: force over time.

use std::{fmt::Display, io};

use crate::language::{Text, text_format, word};

pub const NAME: Text = Text::of("Traces", "Verläufe");
pub const MEANING: Text = Text::of(
    "Measured and rendered force over time, along x, y and z",
    "Gemessene und dargestellte Kraft über der Zeit, längs x, y und z",
);

pub const HOVER: Text = Text::of(
    "Force in N along the world axes x, y and z as drawn in the view, z up. Measured: at the instrument, now. Rendered: \
     to the hand, after all gates. The band spans the lowest and the highest sample of each column. Drag to pan, wheel to \
     zoom, Shift and wheel to zoom the vertical axis, click and Shift click to set two cursors, right click for more, \
     double-click to reset. E marks a moment.",
    "Kraft in N längs der Weltachsen x, y und z wie in der Ansicht, z nach oben. Gemessen: am Instrument, jetzt. \
     Dargestellt: in der Hand, nach allen Sperren. Das Band reicht vom kleinsten bis zum größten Messwert jeder Spalte. \
     Ziehen verschiebt, Mausrad zoomt, mit Umschalt die senkrechte Achse; Klick und Umschalt-Klick setzen zwei Cursor zum \
     Messen, Rechtsklick öffnet ein Menü, Doppelklick setzt zurück. E markiert einen Moment.",
);
pub const SIGNALS: Text = Text::of("Signals", "Signale");
pub const SIGNALS_HOVER: Text = Text::of("Chooses the plots", "Wählt die Kurven aus");
pub const UNITS: Text = Text::of("Units", "Einheiten");
pub const UNITS_HOVER: Text = Text::of(
    "Units of the plots; saved files keep N, mm and mm/s",
    "Einheiten der Kurven; gespeicherte Dateien behalten N, mm und mm/s",
);
pub const NO_PLOT: Text =
    Text::of("No signal is chosen: choose some under Signals", "Kein Signal gewählt: unter Signale auswählen");
pub const LEGEND_HOVER: Text = Text::of("Click to hide or show", "Klick blendet aus oder ein");
pub const PLOT_X: Text = Text::of("Force along x", "Kraft längs x");
pub const PLOT_Y: Text = Text::of("Force along y", "Kraft längs y");
pub const PLOT_Z: Text = Text::of("Force along z", "Kraft längs z");
pub const PLOT_MAGNITUDE: Text = Text::of("Magnitude of the force |f|", "Betrag der Kraft |f|");
pub const PLOT_ERROR: Text = Text::of("Error: rendered minus measured", "Fehler: dargestellt minus gemessen");
pub const PLOT_POSITION: Text = Text::of("Position of the tip", "Position der Spitze");
pub const PLOT_SPEED: Text = Text::of("Speed of the tip", "Tempo der Spitze");
pub const PLOT_GATES: Text = Text::of("Gates: gain and governor", "Sperren: Verstärkung und Bremse");
pub const PLOT_DEGREE: Text = Text::of("Degree N", "Grad N");
pub const PLOT_TORQUE: Text = Text::of("Torque at the wrist sensor", "Moment am Handgelenksensor");
pub const ERROR: Text = Text::of("error", "Fehler");
pub const X: Text = Text::of("x", "x");
pub const Y: Text = Text::of("y", "y");
pub const Z: Text = Text::of("z", "z");
pub const SPEED: Text = Text::of("speed", "Tempo");
pub const GAIN: Text = Text::of("gain", "Verstärkung");
pub const GOVERNED: Text = Text::of("removed by the governor", "von der Bremse entfernt");
pub const TORQUE: Text = Text::of("torque", "Moment");
pub const CURSOR_1_HERE: Text = Text::of("Set cursor 1 here", "Cursor 1 hier setzen");
pub const CURSOR_2_HERE: Text = Text::of("Set cursor 2 here", "Cursor 2 hier setzen");
pub const COPY: Text = Text::of("Copy values", "Werte kopieren");
pub const SAVE_CSV: Text = Text::of("Save as CSV", "Als CSV speichern");
pub const SAVE_PNG: Text = Text::of("Save as PNG", "Als PNG speichern");
pub const RESET: Text = Text::of("Reset zoom, remove cursors", "Zoom zurücksetzen, Cursor entfernen");
pub const TIME: Text = Text::of("time", "Zeit");

/// Returns a choice of the signals, with its unit.
pub fn plot_entry(name: &str, unit: &str) -> String {
    if unit.is_empty() { name.to_owned() } else { format!("{name} ({unit})") }
}

/// Returns the name of a cursor at its line.
pub fn cursor(number: usize) -> String {
    format!("[{number}]")
}

/// Returns the time from the first to the second cursor, s.
pub fn between(seconds: f64) -> String {
    let rate = if seconds.abs() > 1e-6 { format!(" ({:.2} Hz)", 1.0 / seconds.abs()) } else { String::new() };
    text_format!("[2] − [1]:  {seconds:+.3} s{rate}", "[2] − [1]:  {seconds:+.3} s{rate}")
}

/// Returns the accessible name of the differences between the cursors in a plot.
pub fn difference(plot: &str, values: &str) -> String {
    text_format!("Between the cursors, {plot}: {values}", "Zwischen den Cursorn, {plot}: {values}")
}

pub const HEADING: Text = Text::of("Force at the tip and in the hand", "Kraft an der Spitze und in der Hand");
pub const MEASURED: Text = Text::of("measured", "gemessen");
pub const RENDERED: Text = Text::of("rendered", "dargestellt");
pub const PAUSE: Text = Text::of("Pause", "Pause");
pub const PAUSE_HOVER: Text = Text::of(
    "Pauses the display only; recording and the control loop continue",
    "Hält nur die Anzeige an; Aufzeichnung und Regelung laufen weiter",
);
pub const GO_ON: Text = Text::of("Resume", "Fortsetzen");
pub const GO_ON_HOVER: Text = Text::of("Shows new data again", "Zeigt wieder neue Daten");
pub const MARK: Text = Text::of("Mark (E)", "Marke (E)");
pub const MARK_HOVER: Text = Text::of(
    "Marks this moment in all traces, even while they are paused",
    "Markiert diesen Moment in allen Verläufen, auch in der Pause",
);
pub const LAST_TEN_SECONDS: Text = Text::of("Last 10 s", "Letzte 10 s");
pub const LAST_TEN_SECONDS_HOVER: Text =
    Text::of("Shows the last ten seconds again", "Zeigt wieder die letzten zehn Sekunden");
/// Reports an export.
pub fn saved(path: &impl Display) -> String {
    text_format!("Saved as {path}", "Gespeichert als {path}")
}

pub fn not_saved(path: &impl Display, error: &io::Error) -> String {
    text_format!("{path} could not be saved: {error}", "{path} ließ sich nicht speichern: {error}")
}

pub const TIME_AXIS: Text = Text::of("Time before now (s)", "Zeit vor jetzt (s)");

/// Returns the values of a plot at the cursor of another plot.
pub fn at_cursor(plot: &str, values: &str) -> String {
    text_format!("At the cursor, {plot}: {values}", "Am Zeiger, {plot}: {values}")
}

/// Returns the accessible name of a plot.
pub fn plot(name: &str, side: &str) -> String {
    text_format!("{name}, {side} hand", "{name}, Hand {side}")
}

/// Returns the current value of a line (signed) and its maximum over `seconds`, both with their unit.
pub fn summary(line: &str, [now, max]: [String; 2], seconds: f64) -> String {
    text_format!(
        "{line} {now} now, maximum {max} in {seconds:.0} s",
        "{line} {now} jetzt, Maximum {max} in {seconds:.0} s"
    )
}

pub fn forces_of(side: &str) -> String {
    text_format!("Shows the forces of the {side} hand", "Zeigt die Kräfte der Hand {side}")
}

/// Returns these lines of values, which were valid this many seconds ago.
pub fn before_now(ago_s: f64, values: &str) -> String {
    text_format!("{ago_s:.2} s before now\n{values}", "{ago_s:.2} s vor jetzt\n{values}")
}

pub const TWIST_HOVER: Text = Text::of(
    "Torque about the instrument shaft, counter-clockwise as seen from the trocar: the torque of the object that \
     the jaws hold or touch, and the torque that the wrist sensor reads, bias included. A ring held off its \
     centre causes it. It is not rendered to the hand.",
    "Drehmoment um den Schaft des Instruments, vom Trokar gesehen gegen den Uhrzeigersinn: dessen, was die Backen \
     halten oder berühren, und am Handgelenksensor wie abgelesen, mit Nullpunkt. Ursache: ein außermittig gehaltener \
     Ring. Es wird nicht in der Hand dargestellt.",
);

/// Returns the torques about the shaft in mNm, of the object in the jaws and at the wrist sensor; `None` if unknown.
pub fn twist([jaws_mnm, wrist_mnm]: [Option<f64>; 2]) -> String {
    // Avoids `-0.0`.
    let report = |mnm: f64, whose: &str| {
        text_format!("{:+.2} mNm {whose}", "{:+.2} mNm {whose}", (mnm * 100.0).round() / 100.0 + 0.0)
    };
    let both = [
        jaws_mnm.map(|mnm| report(mnm, word("at the jaws", "an den Backen"))),
        wrist_mnm.map(|mnm| report(mnm, word("at the wrist sensor", "am Handgelenksensor"))),
    ];
    let both: Vec<String> = both.into_iter().flatten().collect();
    let known = if both.is_empty() { "\u{2013}".to_owned() } else { both.join(", ") };
    text_format!("Torque about the shaft: {known}", "Drehmoment um den Schaft: {known}")
}
