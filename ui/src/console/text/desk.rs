//! Names and purposes of the panels, and how to arrange them.

pub(in crate::console) const FIELD: &str = "Field";
pub(in crate::console) const TRACES: &str = "Traces";
pub(in crate::console) const FORCE_SPACE: &str = "Force space";
pub(in crate::console) const FEEDBACK: &str = "Feedback";
pub(in crate::console) const DEVICES: &str = "Devices";
pub(in crate::console) const CALIBRATION: &str = "Calibration";
pub(in crate::console) const WHY_NO_FORCE: &str = "Why no force?";
pub(in crate::console) const SAFETY: &str = "Safety";
pub(in crate::console) const ERROR_AT_THE_HORIZON: &str = "Error at the horizon";
pub(in crate::console) const DEGREES: &str = "Degrees";
pub(in crate::console) const TIMING: &str = "Timing";
pub(in crate::console) const LINK: &str = "Link";
pub(in crate::console) const TRADE_OFF: &str = "Trade-off";
pub(in crate::console) const FIELD_HOVER: &str = "The operating field in 3-D, with the forces drawn as arrows";
pub(in crate::console) const TRACES_HOVER: &str = "Measured and rendered force over time, along x, y and z";
pub(in crate::console) const FORCE_SPACE_HOVER: &str = "Measured and rendered force of the last seconds, drawn in 3-D";
pub(in crate::console) const FEEDBACK_HOVER: &str =
    "Sets how the force measured at the instrument becomes the force in the hand";
pub(in crate::console) const DEVICES_HOVER: &str = "The devices of this rig. A connected device is not yet engaged.";
pub(in crate::console) const CALIBRATION_HOVER: &str =
    "Shows how the force at the tip is obtained, and opens the calibrations that it needs";
pub(in crate::console) const WHY_NO_FORCE_HOVER: &str = "Shows why there is no force. A force passes these gates in this order: a closed gate stops it, a \
    limiting gate reduces it.";
pub(in crate::console) const SAFETY_HOVER: &str =
    "The safety functions between the model and the hand: the interlock and the gates of each arm";
pub(in crate::console) const ERROR_AT_THE_HORIZON_HOVER: &str = "Difference between the force that each mode would render now, before the gates, and the force \
    measured now (N, 3-D distance, mean of the last four seconds). Each mode only knows data as old as \
    the link's delay. All modes are computed all the time.";
pub(in crate::console) const DEGREES_HOVER: &str =
    "Degree N of the polynomial f = M X between motion and force, chosen every tick from the last 300 ms";
pub(in crate::console) const TIMING_HOVER: &str =
    "How late the control loop wakes for each period, and how long it works in it, since the console opened (µs)";
pub(in crate::console) const LINK_HOVER: &str =
    "The network between this machine and the one with the arm: delay, loss, clock, and who holds the follower";
pub(in crate::console) const TRADE_OFF_HOVER: &str = "Computing time of one tick of identification (µs, on this computer) against the mean prediction \
    error (N), for every mode, degree and window. Measured on a recording of this scene, at the rig's \
    rate and the link's delay.";
pub(in crate::console) const ALL_CLOSED: &str = "All panels are closed; open them in the View menu";
pub(in crate::console) const DRAG_HOVER: &str = "Drag the title to move the panel";

/// Accessible name of the button that closes a panel.
pub(in crate::console) fn close(panel: &str) -> String {
    format!("Close {panel}")
}

/// Hover text of that button; `close` from [`close`].
pub(in crate::console) fn close_meaning(close: &str) -> String {
    format!("{close}; the View menu opens it again.")
}
