//! The Traces panel: force over time.

use std::{fmt::Display, io};

use crate::language::{Text, text_format, word};

pub(in crate::console) const HOVER: Text = Text::of(
    "Force in N along the world axes x, y and z as drawn in the view, z up. Measured: at the instrument, \
    now. Rendered: to the hand, after all gates. Drag to pan, wheel to zoom, double-click to show the \
    last 10 s. E marks a moment.",
    "Kraft in N längs der Weltachsen x, y und z wie in der Ansicht, z nach oben. Gemessen: am Instrument, jetzt. \
     Dargestellt: in der Hand, nach allen Sperren. Ziehen verschiebt, Mausrad zoomt, Doppelklick zeigt die letzten 10 \
     s. E markiert einen Moment.",
);
pub(in crate::console) const HEADING: Text =
    Text::of("Force at the tip and in the hand", "Kraft an der Spitze und in der Hand");
pub(in crate::console) const MEASURED: Text = Text::of("measured", "gemessen");
pub(in crate::console) const RENDERED: Text = Text::of("rendered", "dargestellt");
pub(in crate::console) const PAUSE: Text = Text::of("Pause", "Pause");
pub(in crate::console) const PAUSE_HOVER: Text = Text::of(
    "Pauses the display only; recording and the control loop continue",
    "Hält nur die Anzeige an; Aufzeichnung und Regelung laufen weiter",
);
pub(in crate::console) const GO_ON: Text = Text::of("Resume", "Fortsetzen");
pub(in crate::console) const GO_ON_HOVER: Text = Text::of("Shows new data again", "Zeigt wieder neue Daten");
pub(in crate::console) const MARK: Text = Text::of("Mark (E)", "Marke (E)");
pub(in crate::console) const MARK_HOVER: Text = Text::of(
    "Marks this moment in all traces, even while they are paused",
    "Markiert diesen Moment in allen Verläufen, auch in der Pause",
);
pub(in crate::console) const LAST_TEN_SECONDS: Text = Text::of("Last 10 s", "Letzte 10 s");
pub(in crate::console) const LAST_TEN_SECONDS_HOVER: Text =
    Text::of("Shows the last ten seconds again", "Zeigt wieder die letzten zehn Sekunden");
/// Reports an export.
pub(in crate::console) fn saved(path: &impl Display) -> String {
    text_format!("Saved as {path}", "Gespeichert als {path}")
}

pub(in crate::console) fn not_saved(path: &impl Display, error: &io::Error) -> String {
    text_format!("{path} could not be saved: {error}", "{path} ließ sich nicht speichern: {error}")
}

pub(in crate::console) const TIME_AXIS: Text = Text::of("Time before now (s)", "Zeit vor jetzt (s)");

/// Returns both forces of an axis (signed, with their unit) at the cursor of another plot.
pub(in crate::console) fn at_cursor(axis: &str, measured: &str, rendered: &str) -> String {
    text_format!(
        "At the cursor, {axis}: measured {measured}, rendered {rendered}",
        "Am Zeiger, {axis}: gemessen {measured}, dargestellt {rendered}"
    )
}

/// Returns the name of the plot of an axis.
pub(in crate::console) fn plot(axis: &str, side: &str) -> String {
    text_format!("Force along {axis}, {side} hand", "Kraft längs {axis}, Hand {side}")
}

/// For measured and rendered force: the current value (signed) and the maximum over `seconds`, both with their unit.
pub(in crate::console) fn summary([measured, rendered]: [[String; 2]; 2], seconds: f64) -> String {
    let report = |[now, max]: [String; 2]| {
        text_format!("{now} now, maximum {max} in {seconds:.0} s", "{now} jetzt, Maximum {max} in {seconds:.0} s")
    };
    text_format!("Measured {}; rendered {}", "Gemessen {}; dargestellt {}", report(measured), report(rendered))
}

pub(in crate::console) fn forces_of(side: &str) -> String {
    text_format!("Shows the forces of the {side} hand", "Zeigt die Kräfte der Hand {side}")
}

/// Returns both forces of an axis (signed, with their unit) this many seconds ago.
pub(in crate::console) fn before_now(ago_s: f64, axis: &str, measured: &str, rendered: &str) -> String {
    text_format!(
        "{ago_s:.2} s before now\nmeasured {axis} {measured}\nrendered {axis} {rendered}",
        "{ago_s:.2} s vor jetzt\ngemessen {axis} {measured}\ndargestellt {axis} {rendered}"
    )
}

pub(in crate::console) const TWIST_HOVER: Text = Text::of(
    "Torque about the instrument shaft, counter-clockwise as seen from the trocar: the torque of the object that \
     the jaws hold or touch, and the torque that the wrist sensor reads, bias included. A ring held off its \
     centre causes it. It is not rendered to the hand.",
    "Drehmoment um den Schaft des Instruments, vom Trokar gesehen gegen den Uhrzeigersinn: dessen, was die Backen \
     halten oder berühren, und am Handgelenksensor wie abgelesen, mit Nullpunkt. Ursache: ein außermittig gehaltener \
     Ring. Es wird nicht in der Hand dargestellt.",
);

/// Torques about the shaft in mNm, of the object in the jaws and at the wrist sensor; `None` if unknown.
pub(in crate::console) fn twist([jaws_mnm, wrist_mnm]: [Option<f64>; 2]) -> String {
    // Avoids `-0.0`.
    let report = |mnm: f64, whose: &str| {
        text_format!("{:+.2} mNm {whose}", "{:+.2} mNm {whose}", (mnm * 100.0).round() / 100.0 + 0.0)
    };
    let both = [
        jaws_mnm.map(|mnm| report(mnm, word("at the jaws", "an den Backen"))),
        wrist_mnm.map(|mnm| report(mnm, word("at the wrist sensor", "am Handgelenksensor"))),
    ];
    let both: Vec<String> = both.into_iter().flatten().collect();
    text_format!("Torque about the shaft: {}", "Drehmoment um den Schaft: {}", both.join(", "))
}
