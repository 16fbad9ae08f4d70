//! The safety panel: the interlock and the row of gates.

use crate::language::{Text, told};

pub(in crate::console) const IDLE: Text = Text::of("Idle", "Idle");
pub(in crate::console) const READY: Text = Text::of("Ready", "Ready");
pub(in crate::console) const ENGAGED: Text = Text::of("Engaged", "Engaged");
pub(in crate::console) const CLUTCHED: Text = Text::of("Clutched", "Clutched");
pub(in crate::console) const STOPPED: Text = Text::of("Stopped", "Stopped");
pub(in crate::console) const FAULT: Text = Text::of("Fault", "Fault");
pub(in crate::console) const WHY_ASKED: Text = Text::of("requested by the operator", "requested by the operator");
pub(in crate::console) const WHY_CONNECTED: Text = Text::of("the devices are connected", "the devices are connected");
pub(in crate::console) const WHY_DISCONNECTED: Text = Text::of("a device was lost", "a device was lost");
pub(in crate::console) const WHY_AGREED: Text =
    Text::of("the drives are on, hand and tip are aligned", "the drives are on, hand and tip are aligned");
pub(in crate::console) const WHY_CLUTCH: Text = Text::of("the clutch", "the clutch");
pub(in crate::console) const WHY_LATE: Text =
    Text::of("the drives did not switch on in time", "the drives did not switch on in time");
pub(in crate::console) const WHY_ABSENT: Text = Text::of("nobody holds the handle", "nobody holds the handle");
pub(in crate::console) const SINCE_START: Text = Text::of("since the loop started", "since the loop started");
pub(in crate::console) const INTERLOCK_HOVER: Text = Text::of(
    "Force and motion are possible in Engaged only. Stop and fault are latched: press Release stop to \
    return to Idle, then Engage. A device that reconnects returns to Idle. Nothing resumes by itself; \
    only the clutch returns to Engaged.",
    "Force and motion are possible in Engaged only. Stop and fault are latched: press Release stop to \
    return to Idle, then Engage. A device that reconnects returns to Idle. Nothing resumes by itself; \
    only the clutch returns to Engaged.",
);
pub(in crate::console) const FROM_ANY_STATE: Text = Text::of("from any state", "from any state");
pub(in crate::console) const FORCE_HOVER: Text = Text::of(
    "Size of the force that the mode asks for now, and of the force that reaches the hand after all gates (N)",
    "Size of the force that the mode asks for now, and of the force that reaches the hand after all gates (N)",
);
pub(in crate::console) const NO_DEVICE: Text = Text::of("No device", "No device");
pub(in crate::console) const WHY_FAULT: Text = Text::of("a fault", "a fault");
pub(in crate::console) const ASKED: Text = Text::of("asked", "asked");
pub(in crate::console) const HAND: Text = Text::of("hand", "hand");
pub(in crate::console) const NEVER: Text = Text::of("never", "never");

/// Addition for the side, if there are two arms.
pub(in crate::console) fn of_hand(side: &str) -> String {
    told!(", {side} hand", ", {side} hand")
}

/// When the state was entered (s on the loop's clock), and why.
pub(in crate::console) fn since(t_s: f64, why: &str) -> String {
    told!("since {t_s:.1} s: {why}", "since {t_s:.1} s: {why}")
}

/// Title of the diagram; `whose` from [`of_hand`].
pub(in crate::console) fn interlock(whose: &str, state: &str) -> String {
    told!("Interlock{whose}: {state}", "Interlock{whose}: {state}")
}

/// A gate in one sentence; `whose` from [`of_hand`].
pub(in crate::console) fn gate(name: &str, whose: &str, standing: &str, ticks: u64) -> String {
    told!(
        "Gate {name}{whose}: {standing}, acted in {ticks} ticks",
        "Gate {name}{whose}: {standing}, acted in {ticks} ticks"
    )
}
