//! Names and purposes of the panels, and how to arrange them.

use crate::language::{Text, told};

pub(in crate::console) const FIELD: Text = Text::of("Field", "Field");
pub(in crate::console) const TRACES: Text = Text::of("Traces", "Traces");
pub(in crate::console) const FORCE_SPACE: Text = Text::of("Force space", "Force space");
pub(in crate::console) const FEEDBACK: Text = Text::of("Feedback", "Feedback");
pub(in crate::console) const DEVICES: Text = Text::of("Devices", "Devices");
pub(in crate::console) const CALIBRATION: Text = Text::of("Calibration", "Calibration");
pub(in crate::console) const WHY_NO_FORCE: Text = Text::of("Why no force?", "Why no force?");
pub(in crate::console) const SAFETY: Text = Text::of("Safety", "Safety");
pub(in crate::console) const ERROR_AT_THE_HORIZON: Text = Text::of("Error at the horizon", "Error at the horizon");
pub(in crate::console) const DEGREES: Text = Text::of("Degrees", "Degrees");
pub(in crate::console) const TIMING: Text = Text::of("Timing", "Timing");
pub(in crate::console) const LINK: Text = Text::of("Link", "Link");
pub(in crate::console) const TRADE_OFF: Text = Text::of("Trade-off", "Trade-off");
pub(in crate::console) const FIELD_HOVER: Text = Text::of(
    "The operating field in 3-D, with the forces drawn as arrows",
    "The operating field in 3-D, with the forces drawn as arrows",
);
pub(in crate::console) const TRACES_HOVER: Text = Text::of(
    "Measured and rendered force over time, along x, y and z",
    "Measured and rendered force over time, along x, y and z",
);
pub(in crate::console) const FORCE_SPACE_HOVER: Text = Text::of(
    "Measured and rendered force of the last seconds, drawn in 3-D",
    "Measured and rendered force of the last seconds, drawn in 3-D",
);
pub(in crate::console) const FEEDBACK_HOVER: Text = Text::of(
    "Sets how the force measured at the instrument becomes the force in the hand",
    "Sets how the force measured at the instrument becomes the force in the hand",
);
pub(in crate::console) const DEVICES_HOVER: Text = Text::of(
    "The devices of this rig. A connected device is not yet engaged.",
    "The devices of this rig. A connected device is not yet engaged.",
);
pub(in crate::console) const CALIBRATION_HOVER: Text = Text::of(
    "Shows how the force at the tip is obtained, and opens the calibrations that it needs",
    "Shows how the force at the tip is obtained, and opens the calibrations that it needs",
);
pub(in crate::console) const WHY_NO_FORCE_HOVER: Text = Text::of(
    "Shows why there is no force. A force passes these gates in this order: a closed gate stops it, a \
    limiting gate reduces it.",
    "Shows why there is no force. A force passes these gates in this order: a closed gate stops it, a \
    limiting gate reduces it.",
);
pub(in crate::console) const SAFETY_HOVER: Text = Text::of(
    "The safety functions between the model and the hand: the interlock and the gates of each arm",
    "The safety functions between the model and the hand: the interlock and the gates of each arm",
);
pub(in crate::console) const ERROR_AT_THE_HORIZON_HOVER: Text = Text::of(
    "Difference between the force that each mode would render now, before the gates, and the force \
    measured now (N, 3-D distance, mean of the last four seconds). Each mode only knows data as old as \
    the link's delay. All modes are computed all the time.",
    "Difference between the force that each mode would render now, before the gates, and the force \
    measured now (N, 3-D distance, mean of the last four seconds). Each mode only knows data as old as \
    the link's delay. All modes are computed all the time.",
);
pub(in crate::console) const DEGREES_HOVER: Text = Text::of(
    "Degree N of the polynomial f = M X between motion and force, chosen every tick from the last 300 ms",
    "Degree N of the polynomial f = M X between motion and force, chosen every tick from the last 300 ms",
);
pub(in crate::console) const TIMING_HOVER: Text = Text::of(
    "How late the control loop wakes for each period, and how long it works in it, since the console opened (µs)",
    "How late the control loop wakes for each period, and how long it works in it, since the console opened (µs)",
);
pub(in crate::console) const LINK_HOVER: Text = Text::of(
    "The network between this machine and the one with the arm: delay, loss, clock, and who holds the follower",
    "The network between this machine and the one with the arm: delay, loss, clock, and who holds the follower",
);
pub(in crate::console) const TRADE_OFF_HOVER: Text = Text::of(
    "Computing time of one tick of identification (µs, on this computer) against the mean prediction \
    error (N), for every mode, degree and window. Measured on a recording of this scene, at the rig's \
    rate and the link's delay.",
    "Computing time of one tick of identification (µs, on this computer) against the mean prediction \
    error (N), for every mode, degree and window. Measured on a recording of this scene, at the rig's \
    rate and the link's delay.",
);
pub(in crate::console) const ALL_CLOSED: Text =
    Text::of("All panels are closed; open them in the View menu", "All panels are closed; open them in the View menu");
pub(in crate::console) const DRAG_HOVER: Text =
    Text::of("Drag the title to move the panel", "Drag the title to move the panel");

/// Accessible name of the button that closes a panel.
pub(in crate::console) fn close(panel: &str) -> String {
    told!("Close {panel}", "Close {panel}")
}

/// Hover text of that button; `close` from [`close`].
pub(in crate::console) fn close_meaning(close: &str) -> String {
    told!("{close}; the View menu opens it again.", "{close}; the View menu opens it again.")
}
