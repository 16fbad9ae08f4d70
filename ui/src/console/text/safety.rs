//! Words of the room `safety`.

pub(in crate::console) const IDLE: &str = "Idle";
pub(in crate::console) const READY: &str = "Ready";
pub(in crate::console) const ENGAGED: &str = "Engaged";
pub(in crate::console) const CLUTCHED: &str = "Clutched";
pub(in crate::console) const STOPPED: &str = "Stopped";
pub(in crate::console) const FAULT: &str = "Fault";
pub(in crate::console) const THE_OPERATOR_ASKED_FOR: &str = "the operator asked for it";
pub(in crate::console) const THE_DEVICES_CAME: &str = "the devices came";
pub(in crate::console) const A_DEVICE_WENT: &str = "a device went";
pub(in crate::console) const DRIVES_OBEY_HAND_AND: &str = "drives obey, hand and tip agree";
pub(in crate::console) const THE_CLUTCH: &str = "the clutch";
pub(in crate::console) const THE_DRIVES_DID_NOT: &str = "the drives did not obey in time";
pub(in crate::console) const NOBODY_HOLDS_THE_HANDLE: &str = "nobody holds the handle";
pub(in crate::console) const SINCE_THE_LOOP_BEGAN: &str = "since the loop began";
pub(in crate::console) const FORCE_AND_MOTION_EXIST: &str = "Force and motion exist in Engaged only. Stop and fault are latched: out of them it takes a release to Idle and a new \
         engagement. What went away comes back as Idle. Nothing resumes by itself; only the clutch returns to Engaged.";
pub(in crate::console) const FROM_EVERYWHERE: &str = "from everywhere";
pub(in crate::console) const SIZE_OF_THE_FORCE: &str =
    "Size of the force that the mode asks for now, and of what reaches the hand after all gates (N).";
pub(in crate::console) const NO_DEVICE: &str = "No device";
pub(in crate::console) const A_FAULT: &str = "a fault";

/// Of which hand, where there are two.
pub(in crate::console) fn of_hand(side: &str) -> String {
    format!(", {side} hand")
}

/// When the state began (s on the loop's clock), and why.
pub(in crate::console) fn since(t_s: f64, why: &str) -> String {
    format!("since {t_s:.1} s: {why}")
}

/// The diagram's title; `whose` as from [`of_hand`].
pub(in crate::console) fn interlock(whose: &str, state: &str) -> String {
    format!("Interlock{whose}: {state}")
}

/// A gate in one sentence; `whose` as from [`of_hand`].
pub(in crate::console) fn gate(name: &str, whose: &str, standing: &str, ticks: u64) -> String {
    format!("Gate {name}{whose}: {standing}, acted on {ticks} ticks")
}
