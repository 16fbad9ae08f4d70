//! Names that several panels use.

use crate::language::{Text, text_format};

pub const RIGHT: Text = Text::of("Right", "Rechts");
pub const LEFT: Text = Text::of("Left", "Links");
pub const MEASURED: Text = Text::of("Measured", "Gemessen");
pub const RENDERED: Text = Text::of("Rendered", "Dargestellt");

/// Returns the name of a hand, as in "Right hand".
pub fn hand(side: &str) -> String {
    let after = side.to_lowercase();
    text_format!("{side} hand", "Hand {after}")
}

/// Returns the reason why a click on a button with another label did not act.
pub fn has_become(label: &str) -> String {
    text_format!(
        "The button now reads “{label}”: press it again if you mean that",
        "Die Schaltfläche heißt inzwischen „{label}“: bei Bedarf noch einmal drücken"
    )
}
