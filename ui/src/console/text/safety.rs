//! The safety panel: the interlock and the row of gates.

pub(in crate::console) const IDLE: &str = "Idle";
pub(in crate::console) const READY: &str = "Ready";
pub(in crate::console) const ENGAGED: &str = "Engaged";
pub(in crate::console) const CLUTCHED: &str = "Clutched";
pub(in crate::console) const STOPPED: &str = "Stopped";
pub(in crate::console) const FAULT: &str = "Fault";
pub(in crate::console) const WHY_ASKED: &str = "requested by the operator";
pub(in crate::console) const WHY_CONNECTED: &str = "the devices are connected";
pub(in crate::console) const WHY_DISCONNECTED: &str = "a device was lost";
pub(in crate::console) const WHY_AGREED: &str = "the drives are on, hand and tip are aligned";
pub(in crate::console) const WHY_CLUTCH: &str = "the clutch";
pub(in crate::console) const WHY_LATE: &str = "the drives did not switch on in time";
pub(in crate::console) const WHY_ABSENT: &str = "nobody holds the handle";
pub(in crate::console) const SINCE_START: &str = "since the loop started";
pub(in crate::console) const INTERLOCK_HOVER: &str = "Force and motion are possible in Engaged only. Stop and fault are latched: press Release stop to \
    return to Idle, then Engage. A device that reconnects returns to Idle. Nothing resumes by itself; \
    only the clutch returns to Engaged.";
pub(in crate::console) const FROM_ANY_STATE: &str = "from any state";
pub(in crate::console) const FORCE_HOVER: &str =
    "Size of the force that the mode asks for now, and of the force that reaches the hand after all gates (N)";
pub(in crate::console) const NO_DEVICE: &str = "No device";
pub(in crate::console) const WHY_FAULT: &str = "a fault";
pub(in crate::console) const ASKED: &str = "asked";
pub(in crate::console) const HAND: &str = "hand";
pub(in crate::console) const NEVER: &str = "never";

/// Addition for the side, if there are two arms.
pub(in crate::console) fn of_hand(side: &str) -> String {
    format!(", {side} hand")
}

/// When the state was entered (s on the loop's clock), and why.
pub(in crate::console) fn since(t_s: f64, why: &str) -> String {
    format!("since {t_s:.1} s: {why}")
}

/// Title of the diagram; `whose` from [`of_hand`].
pub(in crate::console) fn interlock(whose: &str, state: &str) -> String {
    format!("Interlock{whose}: {state}")
}

/// A gate in one sentence; `whose` from [`of_hand`].
pub(in crate::console) fn gate(name: &str, whose: &str, standing: &str, ticks: u64) -> String {
    format!("Gate {name}{whose}: {standing}, acted in {ticks} ticks")
}
