//! Words of the room `top_bar`.

pub(in crate::console) const NIMA_CONSOLE: &str = "NIMA Console";
pub(in crate::console) const RESEARCH_SOFTWARE_NOT_FOR: &str = "Research software, not for clinical use";
pub(in crate::console) const A_DEVICE_THAT_FORCE: &str =
    "A device that force needs is missing; it is opened again by itself.";
pub(in crate::console) const DRIVES_ON_AT_REST: &str = "Drives on, at rest, without force, until hand and tip agree.";
pub(in crate::console) const THE_CLUTCH_IS_PRESSED: &str =
    "The clutch is pressed: the hand moves freely, the follower rests, no force.";
pub(in crate::console) const THE_LOOP_MEASURES_NO: &str = "The loop measures. No force, no motion until it is engaged.";
pub(in crate::console) const THE_FOLLOWER_MOVES_WITH: &str = "The follower moves with the hand and force is fed back.";
pub(in crate::console) const STOPPED_BY_THE_OPERATOR: &str = "Stopped by the operator: no force, no motion. Latched.";
pub(in crate::console) const STOPPED_BY_A_FAULT: &str = "Stopped by a fault: no force, no motion. Latched.";
pub(in crate::console) const STOP: &str = "Stop";
pub(in crate::console) const ZERO_FORCE_AND_A: &str =
    "Zero force and a resting follower at once. Space or Escape does the same.";
pub(in crate::console) const ENGAGE: &str = "Engage";
pub(in crate::console) const SECOND_STEP_MOTION_AND: &str = "Second step: motion and force feedback begin.";
pub(in crate::console) const RELEASE_STOP: &str = "Release stop";
pub(in crate::console) const FIRST_OF_TWO_STEPS: &str = "First of two steps: back to idle, still without force.";
pub(in crate::console) const FIRST_OF_TWO_STEPS_BACK: &str =
    "First of two steps: back to idle. Refused while the cause of the fault lives.";
pub(in crate::console) const ENGAGING_WAS_REFUSED_RELEASE: &str = "Engaging was refused: release the stop first";
pub(in crate::console) const THE_STOP_WAS_NOT: &str =
    "The stop was not released: nothing is stopped, or the cause of the fault still lives";
pub(in crate::console) const THE_LOOP_REFUSED_THE: &str = "The loop refused the last setting: it is outside its range";

/// What runs.
pub(in crate::console) fn scene_and_rig(scene: &str, rig: &str) -> String {
    format!("Scene: {scene}\nRig: {rig}")
}

/// What the state means.
pub(in crate::console) fn state_meaning(meaning: &str) -> String {
    format!("State of the loop. {meaning}")
}

/// The name of the state's field.
pub(in crate::console) fn state(state: &str) -> String {
    format!("Loop state: {state}")
}
