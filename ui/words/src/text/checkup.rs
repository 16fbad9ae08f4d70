//! Measurements of the device test.

use crate::language::{Text, text_format};

pub const RATE: Text = Text::of("Rate", "Rate");
pub const RATE_HOVER: Text =
    Text::of("Readings per second, measured and expected", "Messwerte pro Sekunde, Ist und Soll");
pub const AGE: Text = Text::of("Age", "Alter");
pub const AGE_HOVER: Text = Text::of(
    "Age of the newest reading in a tick of the loop: median and 99th percentile",
    "Alter des neuesten Messwerts in einem Takt der Regelung: Median und 99. Perzentil",
);
pub const LOSSES: Text = Text::of("Lost, damaged, refused", "Verloren, beschädigt, abgelehnt");
pub const LOSSES_HOVER: Text = Text::of(
    "Lost: missing in the device's own count. Damaged: wrong checksum or structure. Refused: error status or \
     impossible values.",
    "Verloren: fehlt nach der Zählung des Geräts. Beschädigt: falsche Prüfsumme oder Struktur. Abgelehnt: \
     Fehlerstatus oder unmögliche Werte.",
);
pub const NOISE_HOVER: Text = Text::of(
    "Standard deviation of each value (x, y, z, or per joint) within 0.1 s, so that slow motion does not count",
    "Standardabweichung jedes Werts (x, y, z oder je Gelenk) innerhalb von 0.1 s, damit langsame Bewegung nicht \
     zählt",
);
pub const SPAN_HOVER: Text = Text::of(
    "Lowest and highest reading of each value (x, y, z, or per joint). Where the device's range is known, also the \
     fraction of it that was reached, measured from its middle.",
    "Kleinster und größter Messwert (x, y, z oder je Gelenk). Wo der Gerätebereich bekannt ist, auch der ab \
     dessen Mitte erreichte Anteil.",
);
pub const UP: Text = Text::of("Up", "Oben");
pub const UP_HOVER: Text = Text::of(
    "Direction that the accelerometer measures as up, in the sensor's axes, and the magnitude of gravity; 9.81 \
     m/s\u{b2} at rest",
    "Richtung, die der Beschleunigungssensor als oben misst, in Sensorachsen, und Betrag der Schwerkraft; in \
     Ruhe 9.81 m/s\u{b2}",
);
pub const NO_AGE: Text = Text::of("no reading yet", "noch kein Messwert");

pub fn noise_of(name: &str) -> String {
    text_format!("Noise of {name}", "Rauschen: {name}")
}

pub fn span_of(name: &str) -> String {
    text_format!("Range of {name}", "Bereich: {name}")
}

pub fn rate(hz: f64, nominal_hz: Option<f64>) -> String {
    match nominal_hz {
        Some(nominal_hz) => text_format!("{hz:.0} of {nominal_hz:.0} Hz", "{hz:.0} von {nominal_hz:.0} Hz"),
        None => text_format!("{hz:.0} Hz", "{hz:.0} Hz"),
    }
}

/// Returns the median and 99th percentile of the ages, s.
pub fn age([p50_s, p99_s]: [f64; 2]) -> String {
    text_format!("p50 {:.0} ms, p99 {:.0} ms", "p50 {:.0} ms, p99 {:.0} ms", p50_s * 1e3, p99_s * 1e3)
}

pub fn losses(lost: u64, damaged: u64, refused: u64) -> String {
    format!("{lost}, {damaged}, {refused}")
}

pub fn up(axis: &str, off_deg: f64, size_m_s2: f64) -> String {
    text_format!(
        "{axis}, {off_deg:.0}\u{b0} off; {size_m_s2:.2} m/s\u{b2}",
        "{axis}, Abweichung {off_deg:.0}\u{b0}; {size_m_s2:.2} m/s\u{b2}"
    )
}

pub fn fraction(percent: f64) -> String {
    text_format!("{percent:.0} % of its range", "{percent:.0} % des Bereichs")
}
