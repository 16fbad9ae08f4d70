//! Words of the room `desk`.

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
pub(in crate::console) const TRADE_OFF: &str = "Trade-off";
pub(in crate::console) const THE_OPERATING_FIELD_IN: &str =
    "The operating field in three dimensions, with the forces as arrows.";
pub(in crate::console) const FORCE_OVER_TIME_ALONG: &str = "Force over time along x, y and z, measured and rendered.";
pub(in crate::console) const MEASURED_AGAINST_RENDERED_FORCE: &str =
    "Measured against rendered force, the last seconds, seen in three dimensions.";
pub(in crate::console) const HOW_THE_FORCE_MEASURED: &str =
    "How the force measured at the instrument becomes the force in the hand.";
pub(in crate::console) const WHAT_THE_RIG_IS: &str = "What the rig is made of. Connected never means engaged.";
pub(in crate::console) const WHERE_THE_FORCE_AT: &str =
    "Where the force at the tip comes from, and what was calibrated for it.";
pub(in crate::console) const WHY_IS_THERE_NO: &str = "Why is there no force? A force passes these gates in this order. A closed gate stops it, a limiting gate makes it \
                 smaller.";
pub(in crate::console) const WHAT_STANDS_BETWEEN_A: &str =
    "What stands between a model and a hand: the interlock and the gates of each arm.";
pub(in crate::console) const MEAN_DISTANCE_N_3: &str = "Mean distance (N, 3-D) between the force each mode would render now and the force measured now, though it only \
                 knows data as old as the link's delay. Mean over the last four seconds, before the gates. All four modes are \
                 computed all the time.";
pub(in crate::console) const DEGREE_N_OF_THE: &str =
    "Degree N of the polynomial f = M X between motion and force, chosen anew each tick on the last 300 ms.";
pub(in crate::console) const THE_LOOP_S_OWN: &str =
    "The loop's own clock: how late it wakes for each period and how long it works in it, since the console opened.";
pub(in crate::console) const TIME_OF_ONE_TICK: &str = "Time of one tick of identification (us, on this computer) against mean error at the horizon (N): every mode, \
                 degree and window on this scene, recorded open-loop, at the rig's rate and the link's delay.";
pub(in crate::console) const ALL_CLOSED: &str = "All panels are closed. The View menu opens them again.";
pub(in crate::console) const DRAG: &str = "Drag the title to put the panel elsewhere.";

/// The button of a panel that takes it off the desk.
pub(in crate::console) fn close(panel: &str) -> String {
    format!("Close {panel}")
}

/// What closing does; `close` as from [`close`].
pub(in crate::console) fn close_meaning(close: &str) -> String {
    format!("{close}; the View menu opens it again.")
}
