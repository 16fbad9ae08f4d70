//! The Feedback panel: mode, gain, delay, dead band.

use nima_core::limits::{self, GAIN_ABOVE_ONE, Limits, SLIDER_DEAD_BAND_M_S, SLIDER_DELAY_S};

use crate::language::{Text, text_format};

pub const NAME: Text = Text::of("Feedback", "Rückkopplung");
pub const MEANING: Text = Text::of(
    "Sets how the force measured at the instrument becomes the force in the hand",
    "Stellt ein, wie aus der am Instrument gemessenen Kraft die Kraft in der Hand wird",
);

/// Returns the hover text of the gain, with its maximum rate of change, 1/s.
pub fn gain_hover(rate_per_s: f64) -> String {
    let Limits { min, max, .. } = limits::GAIN;
    let highest = GAIN_ABOVE_ONE.max;
    text_format!(
        "Ratio of the force in the hand to the force that the mode requests, no unit: {min} to {max}, or up to \
         {highest} if allowed below. At 0 there is no force; 1 is natural. The gain changes by at most {rate_per_s} per \
         second.",
        "Verhältnis der Kraft in der Hand zu der vom Modus verlangten, ohne Einheit: {min} bis {max}, oder bis {highest}, wenn \
         unten erlaubt. Bei 0 wirkt keine Kraft; 1 ist natürlich. Ändert sich um höchstens {rate_per_s} je Sekunde."
    )
}

pub fn delay_hover() -> String {
    let Limits { min, max, unit } = SLIDER_DELAY_S.per(1e-3, "ms");
    text_format!(
        "One-way delay from the follower to the hand, {min} to {max} {unit}, added to the link's own. The paper uses \
         300 ms. Every mode gets its data this late and predicts this far ahead. Applied when you release the \
         slider.",
        "Einfache Verzögerung vom Folgearm zur Hand, {min} bis {max} {unit}, zusätzlich zu der der Verbindung. Der Artikel \
         verwendet 300 ms. Jeder Modus erhält seine Daten so spät und sagt so weit voraus. Gilt ab dem Loslassen des \
         Reglers."
    )
}

pub fn dead_band_hover() -> String {
    let Limits { min, max, unit } = SLIDER_DEAD_BAND_M_S.per(1e-3, "mm/s");
    text_format!(
        "Hand speed, {min} to {max} {unit}, below which no force is rendered: at standstill an impedance cannot \
         be identified. The paper uses 1 mm/s; 0 switches the dead band off. The force fades in and reaches its \
         full magnitude at twice this speed. No effect while \"Keep force at standstill\" is on.",
        "Handgeschwindigkeit, {min} bis {max} {unit}, unter der keine Kraft dargestellt wird: im Stillstand ist eine \
         Impedanz nicht identifizierbar. Der Artikel verwendet 1 mm/s; 0 heißt kein Totband. Die Kraft blendet ein und ist \
         bei der doppelten Geschwindigkeit voll da. Ohne Wirkung, solange „Kraft im Stillstand halten“ ein ist."
    )
}
pub const HOLD_HOVER: Text = Text::of(
    "On: the force stays when the hand stops, so that you feel a steady push. Off: it fades out in the dead \
     band, as in the paper, and the Safety panel shows how much is not rendered (N).",
    "Ein: die Kraft bleibt, wenn die Hand anhält; ein stetiger Druck ist spürbar. Aus: sie blendet im Totband aus wie \
     im Artikel, und das Panel Sicherheit zeigt, wie viel nicht dargestellt wird (N).",
);
pub const RESEARCH_MODES: Text = Text::of("Research modes", "Forschungsmodi");
pub const RESEARCH_MODES_HOVER: Text = Text::of(
    "Modes for comparison: parts of the default, and the paper's rules",
    "Modi zum Vergleich: Teile der Vorgabe und die Regeln des Artikels",
);
pub const GAIN: Text = Text::of("Gain", "Verstärkung");
pub fn allow_above_1_hover() -> String {
    let highest = GAIN_ABOVE_ONE.max;
    let max = limits::GAIN.max;
    text_format!(
        "Allows a gain of up to {highest}, so that soft tissue feels stiffer than it is. The force ceiling still \
         applies. Clearing the box reduces the gain to at most {max}.",
        "Erlaubt Verstärkungen bis {highest}, sodass sich weiches Gewebe steifer anfühlt, als es ist. Die Höchstkraft gilt \
         weiter. Abwählen bringt die Verstärkung auf höchstens {max} zurück."
    )
}
pub const ALLOW_ABOVE_1: Text = Text::of("Allow above 1", "Über 1 erlauben");
pub const GAIN_IN_USE_HOVER: Text =
    Text::of("The gain in use now, after its ramp", "Die jetzt wirksame Verstärkung, nach ihrer Rampe");
pub const RAISE_GAIN: Text = Text::of("Raise the gain", "Verstärkung erhöhen");
pub const LOWER_GAIN: Text = Text::of("Lower the gain", "Verstärkung senken");
pub const LINK_DELAY: Text = Text::of("Link delay", "Verzögerung");
pub const DEAD_BAND: Text = Text::of("Dead band", "Totband");
pub const HOLD: Text = Text::of("Keep force at standstill", "Kraft im Stillstand halten");

pub fn gain_in_use(gain: f64) -> String {
    text_format!("in use {gain:.2}", "wirksam {gain:.2}")
}

/// Returns the hover text of a button that changes a value by 0.1.
pub fn by_a_tenth(name: &str) -> String {
    text_format!("{name} by 0.1", "{name} um 0.1")
}
