//! Words of the room `forces`.

pub(in crate::console) const MEANING: &str = "Newtons in the workspace frame: x, y and z as drawn in the view, z up. Measured at the instrument now; rendered to the \
                       hand after all gates. Drag to pan, wheel to zoom, double click for the last 10 s. E marks a moment.";
pub(in crate::console) const HEADING: &str = "Force at the tip and in the hand";
pub(in crate::console) const MEASURED: &str = "measured";
pub(in crate::console) const RENDERED: &str = "rendered";
pub(in crate::console) const PAUSE: &str = "Pause";
pub(in crate::console) const PAUSE_MEANING: &str =
    "Holds the picture; data go on being kept, and the loop does not notice.";
pub(in crate::console) const GO_ON: &str = "Go on";
pub(in crate::console) const GO_ON_MEANING: &str = "Shows what comes in again.";
pub(in crate::console) const MARK: &str = "Mark (E)";
pub(in crate::console) const MARK_MEANING: &str = "Marks this moment in all traces, also while they are paused.";
pub(in crate::console) const LAST_TEN_SECONDS: &str = "Last 10 s";
pub(in crate::console) const LAST_TEN_SECONDS_MEANING: &str = "Back to the last ten seconds.";
pub(in crate::console) const TIME_AXIS: &str = "Time before now (s)";

/// Both forces of an axis (signed figures, N) where another plot is pointed at.
pub(in crate::console) fn at_cursor(axis: &str, measured_n: &str, rendered_n: &str) -> String {
    format!("At the cursor, {axis}: measured {measured_n} N, rendered {rendered_n} N")
}

/// Whose forces a switch shows.
pub(in crate::console) fn forces_of(side: &str) -> String {
    format!("Shows the forces of the {side} hand.")
}

/// Both forces of an axis (signed figures, N) so many seconds ago.
pub(in crate::console) fn before_now(ago_s: f64, axis: &str, measured_n: &str, rendered_n: &str) -> String {
    format!("{ago_s:.2} s before now\nmeasured {axis} {measured_n} N\nrendered {axis} {rendered_n} N")
}
