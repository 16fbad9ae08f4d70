//! The gates, and the reason for a missing force above them.

use crate::language::{Text, text_format};

pub const FREE_MOTION: Text = Text::of(
    "Free motion: no contact, so there is no force to render",
    "Freie Bewegung: kein Kontakt, also keine Kraft darzustellen",
);
pub const NONE_DEVICE_MISSING: Text =
    Text::of("No force: a device is missing (see Devices)", "Keine Kraft: ein Gerät fehlt (siehe Geräte)");
pub const NONE_IDLE: Text =
    Text::of("No force: the loop is idle; press Engage", "Keine Kraft: Regelung im Leerlauf; Koppeln drücken");
pub const NONE_STARTING: Text =
    Text::of("No force: the loop has not started yet", "Keine Kraft: Regelung noch nicht gestartet");
pub const NONE_IDLE_THEN: Text = Text::of("No force: the loop was idle", "Keine Kraft: Regelung war im Leerlauf");
pub const NONE_GETTING_READY: Text =
    Text::of("No force yet: the drives are switching on", "Noch keine Kraft: Antriebe schalten ein");
pub const NONE_CLUTCH: Text = Text::of(
    "No force: the clutch is pressed, the hand moves freely",
    "Keine Kraft: Kupplung gedrückt, die Hand ist frei beweglich",
);
pub const NONE_STOPPED: Text = Text::of("No force: stopped by the operator", "Keine Kraft: vom Bediener angehalten");
pub const NONE_OTHER_ARM: Text = Text::of("No force: the other arm has a fault", "Keine Kraft: Störung am anderen Arm");
pub const NONE_FAULT: Text = Text::of("No force: stopped by a fault", "Keine Kraft: durch Störung angehalten");
pub const NONE_INVALID: Text =
    Text::of("No force: the mode has no valid result", "Keine Kraft: der Modus hat kein gültiges Ergebnis");
pub const NONE_STALE: Text = Text::of("No force: the data are too old", "Keine Kraft: die Daten sind zu alt");
pub const NONE_GAIN: Text = Text::of(
    "No force: the gain is zero",
    "Keine Kraft: die Verstärkung \
 ist null",
);
pub const LESS_ENERGY: Text = Text::of(
    "Reduced force: the hand would get back more energy than it put in",
    "Weniger Kraft: die Hand bekäme mehr Energie zurück, als sie hineingab",
);
pub const DEAD_BAND_OFF: Text = Text::of("off: force is kept", "aus: Kraft wird gehalten");
pub const LESS_GOVERNED: Text = Text::of(
    "Reduced force: the handle is running away and no hand holds it. The force returns when a hand grips it.",
    "Weniger Kraft: das Handgerät läuft weg, keine Hand hält es. Die Kraft kehrt zurück, sobald eine Hand zugreift.",
);
pub const GOVERNOR_OFF: Text = Text::of(
    "off: handle's mass unknown",
    "aus: Handgerätemasse \
 unbekannt",
);
pub const NEVER_ACTED: Text = Text::of("Has not acted so far", "Hat bisher nicht eingegriffen");
pub const OPEN: Text = Text::of("open", "offen");
pub const CLOSED: Text = Text::of("closed", "geschlossen");
pub const LIMITING: Text = Text::of("limiting", "begrenzt");
pub const ENERGY_OFF: Text = Text::of("off", "aus");

pub fn gates_of(side: &str) -> String {
    text_format!("Shows why there is no force in the {side} hand", "Zeigt, warum in der Hand {side} keine Kraft ist")
}

/// `source`: source of the tip force, or the reason why it is unknown.
pub fn none_unknown(source: &str) -> String {
    text_format!("No force; tip force: {source}", "Keine Kraft; Kraft an der Spitze: {source}")
}

/// `why`: a sentence.
pub fn none_idle_closed(why: &str) -> String {
    text_format!("No force: the loop is idle. {why}", "Keine Kraft: Regelung im Leerlauf. {why}")
}

pub fn rendered(rendered_n: f64) -> String {
    text_format!("Force in the hand: {rendered_n:.1} N", "Kraft in der Hand: {rendered_n:.1} N")
}

pub fn withheld_by_dead_band(withheld_n: f64) -> String {
    text_format!(
        "{withheld_n:.1} N not rendered: the hand is slower than the dead band",
        "{withheld_n:.1} N nicht dargestellt: Hand langsamer als das Totband"
    )
}

pub fn withheld(withheld_n: f64) -> String {
    text_format!("{withheld_n:.1} N withheld", "{withheld_n:.1} N zurückgehalten")
}

pub fn on_its_way(delay_ms: f64) -> String {
    text_format!(
        "No force yet: the link delays it by {delay_ms:.0} ms",
        "Noch keine Kraft: die Verbindung verzögert um {delay_ms:.0} ms"
    )
}

pub fn zero_after(age_ms: f64) -> String {
    text_format!("zero after {age_ms:.0} ms", "null nach {age_ms:.0} ms")
}

pub fn governed(percent: f64) -> String {
    text_format!("{percent:.0} % withheld", "{percent:.0} % zurückgehalten")
}

pub fn energy_left(stored_mj: f64) -> String {
    text_format!("{stored_mj:.0} mJ left", "{stored_mj:.0} mJ übrig")
}

pub fn acted(ticks: u64, percent: f64, why: &str) -> String {
    text_format!(
        "Acted in {ticks} ticks ({percent:.1} %); last reason: {why}",
        "Griff in {ticks} Takten ein ({percent:.1} %); letzter Grund: {why}"
    )
}
