//! The top bar: state, stop, engage, refusals.

use crate::{
    language::{Text, text_format},
    report_text::sentence,
};

pub const NIMA_CONSOLE: Text = Text::of("NIMA Console", "NIMA-Konsole");
pub const RESEARCH_ONLY: Text =
    Text::of("Research software, not for clinical use", "Forschungssoftware, nicht für klinische Anwendung");
pub const DISCONNECTED_MEANING: Text = Text::of(
    "A device needed for force feedback is missing. The console reconnects it automatically.",
    "Ein für die Kraftrückkopplung nötiges Gerät fehlt. Die Konsole verbindet es von selbst wieder.",
);
pub const READY_MEANING: Text = Text::of(
    "The drives are on but at rest, without force, until hand and tip are aligned",
    "Antriebe ein, aber still und ohne Kraft, bis Hand und Spitze ausgerichtet sind",
);
pub const CLUTCHED_MEANING: Text = Text::of(
    "The clutch is pressed: the hand moves freely, the follower holds still, no force",
    "Kupplung gedrückt: die Hand bewegt sich frei, der Folgearm steht still, keine Kraft",
);
pub const IDLE_MEANING: Text = Text::of(
    "The loop only measures. No force and no motion until you engage it.",
    "Die Regelung misst nur. Vor dem Koppeln keine Kraft und keine Bewegung.",
);
pub const ENGAGED_MEANING: Text = Text::of(
    "The follower moves with the hand, and the hand feels the force",
    "Der Folgearm folgt der Hand, und die Hand spürt die Kraft",
);
pub const STOPPED_MEANING: Text = Text::of(
    "Stopped by the operator: no force, no motion. The loop stays stopped until you press Release stop.",
    "Vom Bediener angehalten: keine Kraft, keine Bewegung. Bleibt so, bis der Halt gelöst wird.",
);
pub const FAULT_MEANING: Text = Text::of(
    "Stopped by a fault: no force, no motion. The loop stays stopped until you press Release stop.",
    "Durch eine Störung angehalten: keine Kraft, keine Bewegung. Bleibt so, bis der Halt gelöst wird.",
);
pub const JUST_CHANGED: Text =
    Text::of("The state has just changed: press again", "Der Zustand hat gerade gewechselt: noch einmal drücken");
pub const STOP: Text = Text::of("Stop", "Halt");
pub const STOP_HOVER: Text = Text::of(
    "Sets the force to zero and stops the follower at once. Space or Escape does the same.",
    "Setzt die Kraft auf null und hält den Folgearm sofort an. Leertaste oder Escape tun dasselbe.",
);
pub const ENGAGE_HOVER: Text = Text::of(
    "Second of two steps: starts motion and force feedback",
    "Zweiter von zwei Schritten: startet Bewegung und Kraftrückkopplung",
);
pub const ENGAGE_AFTER_STALL_HOVER: Text = Text::of(
    "One step after a stall of less than a second: starts motion and force feedback",
    "Ein Schritt nach einer Stockung unter einer Sekunde: startet Bewegung und Kraftrückkopplung",
);
pub const RELEASE_STOP_HOVER: Text = Text::of(
    "First of two steps: returns to idle, still without force",
    "Erster von zwei Schritten: zurück in den Leerlauf, noch ohne Kraft",
);
pub const RELEASE_FAULT_HOVER: Text = Text::of(
    "First of two steps: returns to idle. Refused while the cause of the fault is present.",
    "Erster von zwei Schritten: zurück in den Leerlauf. Abgelehnt, solange die Störung besteht.",
);
pub const NOT_ENGAGED: Text = Text::of("Not engaged", "Nicht gekoppelt");
pub const NOT_RELEASED: Text = Text::of("Not released", "Nicht gelöst");
pub const NOT_SET: Text = Text::of("Not set", "Nicht gesetzt");

/// Returns the refused command; `arm` is empty for a rig with one arm.
pub fn refused(what: &str, arm: &str) -> String {
    let arm = if arm.is_empty() { String::new() } else { text_format!(" ({arm} arm)", " (Arm {arm})") };
    format!("{what}{arm}")
}

/// Returns the refused command from [`refused`], with the cause.
pub fn refused_because(what: &str, cause: &str) -> String {
    format!("{what}: {cause}")
}

/// Returns the refused command with cause and remedy. The remedy is a separate sentence, because the remedies of
/// devices begin with a capital.
pub fn refused_with_cure(because: &str, cure: &str) -> String {
    format!("{because}. {}", sentence(cure))
}

pub fn device(name: &str, cause: &str) -> String {
    format!("{name}: {cause}")
}

pub fn scene_and_rig(scene: &str, rig: &str) -> String {
    text_format!("Scene: {scene}\nRig: {rig}", "Szene: {scene}\nAufbau: {rig}")
}

/// Returns the hover text of the state.
pub fn state_meaning(meaning: &str) -> String {
    text_format!("State of the control loop\n{meaning}", "Zustand der Regelung\n{meaning}")
}

pub fn state_of_side(side: &str, state: &str) -> String {
    format!("{side}: {state}")
}

/// Returns the accessible name of the state.
pub fn state(state: &str) -> String {
    text_format!("Loop state: {state}", "Regelung: {state}")
}
