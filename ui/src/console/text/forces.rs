//! The traces of force over time.

pub(in crate::console) const HOVER: &str = "Force in N along the world axes x, y and z as drawn in the view, z up. Measured: at the instrument, \
    now. Rendered: to the hand, after all gates. Drag to pan, wheel to zoom, double-click to show the \
    last 10 s. E marks a moment.";
pub(in crate::console) const HEADING: &str = "Force at the tip and in the hand";
pub(in crate::console) const MEASURED: &str = "measured";
pub(in crate::console) const RENDERED: &str = "rendered";
pub(in crate::console) const PAUSE: &str = "Pause";
pub(in crate::console) const PAUSE_HOVER: &str =
    "Freezes the picture; data are still recorded, and the control loop is not affected";
pub(in crate::console) const GO_ON: &str = "Go on";
pub(in crate::console) const GO_ON_HOVER: &str = "Shows new data again";
pub(in crate::console) const MARK: &str = "Mark (E)";
pub(in crate::console) const MARK_HOVER: &str = "Marks this moment in all traces, even while they are paused";
pub(in crate::console) const LAST_TEN_SECONDS: &str = "Last 10 s";
pub(in crate::console) const LAST_TEN_SECONDS_HOVER: &str = "Shows the last ten seconds again";
pub(in crate::console) const TIME_AXIS: &str = "Time before now (s)";

/// Both forces of an axis (signed, N) at the cursor of another plot.
pub(in crate::console) fn at_cursor(axis: &str, measured_n: &str, rendered_n: &str) -> String {
    format!("At the cursor, {axis}: measured {measured_n} N, rendered {rendered_n} N")
}

/// Name of the plot of an axis.
pub(in crate::console) fn plot(axis: &str, side: &str) -> String {
    format!("Force along {axis}, {side} hand")
}

/// What that plot shows: the force now (signed) and the largest in this time, N, measured and rendered.
pub(in crate::console) fn summary([measured, rendered]: [(String, f64); 2], seconds: f64) -> String {
    let told = |(now_n, most_n): (String, f64)| format!("{now_n} N now, {most_n:.1} N at most in {seconds:.0} s");
    format!("Measured {}; rendered {}", told(measured), told(rendered))
}

/// Switch: forces of which side.
pub(in crate::console) fn forces_of(side: &str) -> String {
    format!("Shows the forces of the {side} hand")
}

/// Both forces of an axis (signed, N) this many seconds ago.
pub(in crate::console) fn before_now(ago_s: f64, axis: &str, measured_n: &str, rendered_n: &str) -> String {
    format!("{ago_s:.2} s before now\nmeasured {axis} {measured_n} N\nrendered {axis} {rendered_n} N")
}

pub(in crate::console) const TWIST_HOVER: &str = "Torque about the shaft of the instrument, against the clock as seen from the trocar: of what the jaws hold or touch, \
    and on the wrist sensor as it reads it, with its bias. A ring that is held off its centre causes it. It is not rendered to the hand.";

/// The torque about the shaft (mNm): of what the jaws hold, and at the wrist sensor, each where it is known.
pub(in crate::console) fn twist([jaws_mnm, wrist_mnm]: [Option<f64>; 2]) -> String {
    // Not `-0.0`.
    let told = |mnm: f64, whose: &str| format!("{:+.2} mNm {whose}", (mnm * 100.0).round() / 100.0 + 0.0);
    let both = [jaws_mnm.map(|mnm| told(mnm, "at the jaws")), wrist_mnm.map(|mnm| told(mnm, "at the wrist sensor"))];
    let both: Vec<String> = both.into_iter().flatten().collect();
    format!("Torque about the shaft: {}", both.join(", "))
}
