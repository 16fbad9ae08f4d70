//! The top bar: state, stop, engage, refusals.

use crate::language::{Text, told};

pub(in crate::console) const NIMA_CONSOLE: Text = Text::of("NIMA Console", "NIMA Console");
pub(in crate::console) const RESEARCH_ONLY: Text =
    Text::of("Research software, not for clinical use", "Research software, not for clinical use");
pub(in crate::console) const DISCONNECTED_MEANING: Text = Text::of(
    "A device needed for force feedback is missing. The console reconnects it automatically.",
    "A device needed for force feedback is missing. The console reconnects it automatically.",
);
pub(in crate::console) const READY_MEANING: Text = Text::of(
    "The drives are on but hold still, without force, until hand and tip are aligned",
    "The drives are on but hold still, without force, until hand and tip are aligned",
);
pub(in crate::console) const CLUTCHED_MEANING: Text = Text::of(
    "The clutch is pressed: the hand moves freely, the follower holds still, no force",
    "The clutch is pressed: the hand moves freely, the follower holds still, no force",
);
pub(in crate::console) const IDLE_MEANING: Text = Text::of(
    "The loop measures only. No force and no motion until you engage it.",
    "The loop measures only. No force and no motion until you engage it.",
);
pub(in crate::console) const ENGAGED_MEANING: Text = Text::of(
    "The follower moves with the hand, and the hand feels the force",
    "The follower moves with the hand, and the hand feels the force",
);
pub(in crate::console) const STOPPED_MEANING: Text = Text::of(
    "Stopped by the operator: no force, no motion. It stays stopped until you press Release stop.",
    "Stopped by the operator: no force, no motion. It stays stopped until you press Release stop.",
);
pub(in crate::console) const FAULT_MEANING: Text = Text::of(
    "Stopped by a fault: no force, no motion. It stays stopped until you press Release stop.",
    "Stopped by a fault: no force, no motion. It stays stopped until you press Release stop.",
);
pub(in crate::console) const STOP: Text = Text::of("Stop", "Stop");
pub(in crate::console) const STOP_HOVER: Text = Text::of(
    "Sets the force to zero and stops the follower at once. Space or Escape does the same.",
    "Sets the force to zero and stops the follower at once. Space or Escape does the same.",
);
pub(in crate::console) const ENGAGE_HOVER: Text = Text::of(
    "Second of two steps: starts motion and force feedback",
    "Second of two steps: starts motion and force feedback",
);
pub(in crate::console) const RELEASE_STOP_HOVER: Text = Text::of(
    "First of two steps: returns to idle, still without force",
    "First of two steps: returns to idle, still without force",
);
pub(in crate::console) const RELEASE_FAULT_HOVER: Text = Text::of(
    "First of two steps: returns to idle. Refused while the cause of the fault is present.",
    "First of two steps: returns to idle. Refused while the cause of the fault is present.",
);
pub(in crate::console) const NOT_ENGAGED: Text = Text::of("Not engaged", "Not engaged");
pub(in crate::console) const NOT_RELEASED: Text = Text::of("Not released", "Not released");
pub(in crate::console) const NOT_SET: Text = Text::of("Not set", "Not set");

/// A refused command: what was not done, for which arm if there are two, why, and what to do.
pub(in crate::console) fn refused(what: &str, arm: &str, cause: &str, cure: &str) -> String {
    let arm = if arm.is_empty() { String::new() } else { told!(" ({arm} arm)", " ({arm} arm)") };
    format!("{what}{arm}: {cause}; {cure}")
}

/// A missing device.
pub(in crate::console) fn device(name: &str, cause: &str) -> String {
    format!("{name}: {cause}")
}

/// Names of scene and rig.
pub(in crate::console) fn scene_and_rig(scene: &str, rig: &str) -> String {
    told!("Scene: {scene}\nRig: {rig}", "Scene: {scene}\nRig: {rig}")
}

/// Hover text of the state.
pub(in crate::console) fn state_meaning(meaning: &str) -> String {
    told!("State of the control loop\n{meaning}", "State of the control loop\n{meaning}")
}

/// State of one of two arms that differ.
pub(in crate::console) fn state_of_side(side: &str, state: &str) -> String {
    format!("{side}: {state}")
}

/// Accessible name of the state.
pub(in crate::console) fn state(state: &str) -> String {
    told!("Loop state: {state}", "Loop state: {state}")
}
