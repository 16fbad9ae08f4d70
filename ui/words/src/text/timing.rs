//! The timing panel.

use crate::language::{Text, text_format};

pub const NAME: Text = Text::of("Timing", "Timing");
pub const MEANING: Text = Text::of(
    "How late the control loop wakes up in each period, and how long it computes, since the console was opened \
     (µs)",
    "Wie spät die Regelung in jedem Takt aufwacht und wie lange sie rechnet, seit Öffnen der Konsole (µs)",
);

pub const WAKE_UP: Text = Text::of("Wake-up", "Aufwachen");
pub const WAKE_UP_HOVER: Text = Text::of(
    "How late the loop wakes up after the start of its period (µs)",
    "Wie spät die Regelung nach Beginn ihres Takts aufwacht (µs)",
);
pub const WORK: Text = Text::of("Work", "Rechnen");
pub const WORK_HOVER: Text = Text::of(
    "Computing time of one tick: gravity, identification, selection, rendering and gates (µs)",
    "Rechenzeit eines Takts: Schwerkraft, Identifikation, Auswahl, Darstellung und Sperren (µs)",
);
pub const SAMPLE_TO_FORCE: Text = Text::of("Sample to force", "Messung bis Kraft");
pub const SAMPLE_TO_FORCE_HOVER: Text = Text::of(
    "Time from the arrival of the oldest measurement to the sending of the force computed from it to the handle \
     (µs)",
    "Zeit vom Eintreffen des ältesten Messwerts, bis die daraus berechnete Kraft zum Handgerät geht (µs)",
);
pub const TICKS: Text = Text::of("Ticks", "Takte");
pub const TICKS_HOVER: Text = Text::of(
    "Ticks since the loop started, and ticks per second that reach this screen",
    "Takte seit Start der Regelung und wie viele pro Sekunde diesen Bildschirm erreichen",
);
pub const MISSED: Text = Text::of("Missed", "Versäumt");
pub const MISSED_HOVER: Text = Text::of(
    "Periods that the loop missed because it was late. They are counted and skipped, never caught up.",
    "Takte, die die Regelung verspätet versäumt hat. Sie werden gezählt und ausgelassen, nie nachgeholt.",
);
pub const DROPPED: Text = Text::of("Dropped", "Verloren");
pub const DROPPED_HOVER: Text = Text::of(
    "Ticks that this screen did not receive because it was busy. The loop never waits for the screen.",
    "Takte, die dieser Bildschirm nicht erhielt, weil er beschäftigt war. Die Regelung wartet nie auf den Bildschirm.",
);
pub const CONSOLE_FRAME: Text = Text::of("Console frame", "Konsolenbild");
pub const SCHEDULING_HOVER: Text = Text::of(
    "Real-time priority prevents other programs from delaying the loop; locked memory prevents page faults",
    "Echtzeitpriorität verhindert, dass andere Programme die Regelung verzögern; gesperrter Speicher verhindert \
     Seitenfehler",
);
pub const REAL_TIME_PRIORITY: Text = Text::of("Real-time priority", "Echtzeitpriorität");
pub const LOCKED_MEMORY: Text = Text::of("Locked memory", "Gesperrter Speicher");
pub const FRAME_HOVER: Text = Text::of(
    "Time between two frames of this window since it opened (ms; target 31 ms, idle time not counted), and the \
     work in the current frame",
    "Zeit zwischen zwei Bildern dieses Fensters seit dem Öffnen (ms; Ziel 31 ms, ohne Leerlauf) und die Arbeit am \
     aktuellen Bild",
);
pub const FRAME_HOVER_ROUGH: Text = Text::of(
    "Time between two frames of this window since it opened (ms; target 31 ms, idle time not counted), and the \
     work in the current frame. Edges in 3-D are not smoothed, because this computer would draw too slowly.",
    "Zeit zwischen zwei Bildern dieses Fensters seit dem Öffnen (ms; Ziel 31 ms, ohne Leerlauf) und die Arbeit am \
     aktuellen Bild. Kanten in 3-D sind nicht geglättet, weil dieser Rechner sonst zu langsam zeichnet.",
);
pub const GRANTED: Text = Text::of("granted", "gewährt");
pub const REFUSED: Text = Text::of("refused", "verweigert");

pub fn and_more(from_us: f64) -> String {
    text_format!("{from_us:.0} µs or more", "{from_us:.0} µs oder mehr")
}

pub fn from_to(from_us: f64, to_us: f64) -> String {
    text_format!("{from_us:.0} to {to_us:.0} µs", "{from_us:.0} bis {to_us:.0} µs")
}

/// Returns the hover text of a bar.
pub fn bar(name: &str, range: &str, ticks: &str, fraction: &str) -> String {
    text_format!("{name}: {range}\n{ticks} ticks, {fraction}", "{name}: {range}\n{ticks} Takte, {fraction}")
}

pub fn histogram(name: &str, late: &str, total: &str, deadline_us: f64) -> String {
    text_format!(
        "{name} histogram: {late} of {total} ticks exceeded the deadline of {deadline_us:.0} µs",
        "Histogramm {name}: {late} von {total} Takten über der Frist von {deadline_us:.0} µs"
    )
}

pub fn deadline(deadline_us: f64) -> String {
    text_format!("deadline {deadline_us:.0} µs", "Frist {deadline_us:.0} µs")
}

pub fn log_scale(top: &str) -> String {
    text_format!("log scale, maximum {top}", "log. Skala, Maximum {top}")
}

pub fn missed(minutes: usize, count: &str) -> String {
    text_format!("Missed in the last {minutes} min: {count}", "Versäumt in den letzten {minutes} min: {count}")
}

/// Returns the accessible name of the strip.
pub fn missed_periods(words: &str) -> String {
    text_format!("{words} periods", "{words} Takte")
}

/// Returns the hover text of a bar of the strip.
pub fn missed_at(age_s: usize, count: &str) -> String {
    text_format!("{age_s} s ago: {count} periods missed", "vor {age_s} s: {count} Takte versäumt")
}

pub fn ticks_at(ticks: &str, rate_hz: f64) -> String {
    text_format!("{ticks} at {rate_hz:.0} Hz", "{ticks} mit {rate_hz:.0} Hz")
}

/// Returns the time between two frames (median and 99th percentile) and work per frame, ms.
pub fn frame([p50_ms, p99_ms]: [f64; 2], work_ms: f64) -> String {
    text_format!(
        "p50 {p50_ms:.0}, p99 {p99_ms:.0}, work {work_ms:.0} ms",
        "p50 {p50_ms:.0}, p99 {p99_ms:.0}, Arbeit {work_ms:.0} ms"
    )
}
