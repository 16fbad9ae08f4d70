//! The compared conditions.

use std::fmt;

use nima_core::{
    impedance::{Mode, OwnMotion},
    limits::{DELAY_S, GAIN},
};
use serde::{Deserialize, Serialize};

/// Maximum length of a name, characters.
const NAME_MAX: usize = 40;

/// A condition: the feedback to the hand. Its `Debug` output is empty, so that no log reveals it by accident.
#[derive(Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Condition {
    /// Name, for the report after the unblinding.
    pub name: String,
    /// Whether the hand feels no force at all; there is then neither mode nor gain.
    #[serde(default)]
    pub no_force: bool,
    /// The rendering mode.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mode: Option<Mode>,
    /// Gain, above 0, within [`GAIN`]; 1 if omitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gain: Option<f64>,
    /// One-way delay of the link, ms, within [`DELAY_S`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub delay_ms: Option<f64>,
    /// The motion from which the leader computes the force; the rig's if omitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub own_motion: Option<OwnMotion>,
}

impl fmt::Debug for Condition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Condition")
    }
}

impl Condition {
    /// Returns its mistakes, one line each.
    pub(crate) fn mistakes(&self) -> Vec<String> {
        let Self { name, no_force, mode, gain, delay_ms, own_motion } = self;
        let mut wrong = Vec::new();
        let usable = |letter: char| letter.is_alphanumeric() || " _-.+()%".contains(letter);
        if name.trim() != name || name.is_empty() || name.chars().count() > NAME_MAX || !name.chars().all(usable) {
            wrong.push(format!("its name must be 1 to {NAME_MAX} letters, digits, spaces or any of _ - . + ( ) %"));
        }
        if name.chars().count() == 1 {
            wrong.push("a name of one letter could be mistaken for a label: give it a longer one".to_owned());
        }
        if *no_force && (mode.is_some() || gain.is_some() || own_motion.is_some()) {
            wrong.push("no_force excludes mode, gain and own_motion: remove them or no_force".to_owned());
        }
        if !*no_force && mode.is_none() {
            wrong.push("mode is missing: add it, or set no_force = true".to_owned());
        }
        if !*no_force && delay_ms.is_none() {
            wrong.push("delay_ms is missing; write 0 for no delay".to_owned());
        }
        let delays_ms = DELAY_S.per(1e-3, "ms");
        if delay_ms.is_some_and(|delay_ms| !delays_ms.contains(delay_ms)) {
            wrong.push(format!("delay_ms must be from {delays_ms}"));
        }
        if gain.is_some_and(|gain| !(gain > GAIN.min && gain <= GAIN.max)) {
            wrong.push(format!("gain must be above 0 and at most {}; for no force, set no_force = true", GAIN.max));
        }
        wrong
    }

    /// Returns whether the hand would feel the same.
    pub(crate) fn feels_like(&self, other: &Self) -> bool {
        let of =
            |one: &Self| (one.no_force, one.mode, one.gain.unwrap_or(1.0), one.delay_ms.unwrap_or(0.0), one.own_motion);
        of(self) == of(other)
    }

    /// Returns the texts that would reveal the condition: its name, its mode, its delay.
    pub(crate) fn tells(&self) -> Vec<String> {
        let delay = self.delay_ms.filter(|delay_ms| *delay_ms > 0.0).map(|delay_ms| format!("{delay_ms}"));
        let mode = self.mode.map(|mode| mode.name().to_owned());
        [Some(self.name.clone()), mode, delay].into_iter().flatten().collect()
    }
}
