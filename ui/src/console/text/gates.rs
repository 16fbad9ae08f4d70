//! The panel "Why no force?": each gate, and the summary above them.

pub(in crate::console) const FREE_MOTION: &str = "Free motion: no contact, so there is no force to render";
pub(in crate::console) const NONE_DEVICE_MISSING: &str = "No force: a device is missing (see Devices)";
pub(in crate::console) const NONE_IDLE: &str = "No force: the loop is idle, press Engage";
pub(in crate::console) const NONE_GETTING_READY: &str = "No force yet: the drives are switching on";
pub(in crate::console) const NONE_CLUTCH: &str = "No force: the clutch is pressed, the hand moves freely";
pub(in crate::console) const NONE_STOPPED: &str = "No force: stopped by the operator";
pub(in crate::console) const NONE_OTHER_ARM: &str = "No force: the other arm has a fault";
pub(in crate::console) const NONE_FAULT: &str = "No force: stopped by a fault";
pub(in crate::console) const NONE_INVALID: &str = "No force: the mode has no valid result";
pub(in crate::console) const NONE_STALE: &str = "No force: the data are too old";
pub(in crate::console) const NONE_GAIN: &str = "No force: the gain is zero";
pub(in crate::console) const LESS_ENERGY: &str = "Reduced force: the hand would get back more energy than it put in";
pub(in crate::console) const DEAD_BAND_OFF: &str = "off: force is kept";
pub(in crate::console) const LESS_GOVERNED: &str =
    "Reduced force: the handle runs away and no hand holds it. The force returns when a hand takes hold.";
pub(in crate::console) const GOVERNOR_OFF: &str = "off: handle's mass unknown";
pub(in crate::console) const NEVER_ACTED: &str = "It has not acted so far";
pub(in crate::console) const OPEN: &str = "open";
pub(in crate::console) const CLOSED: &str = "closed";
pub(in crate::console) const LIMITING: &str = "limiting";
pub(in crate::console) const ENERGY_OFF: &str = "off";

/// Switch: gates of which side.
pub(in crate::console) fn gates_of(side: &str) -> String {
    format!("Shows why there is no force in the {side} hand")
}

/// Summary: a force is rendered.
pub(in crate::console) fn rendered(rendered_n: f64) -> String {
    format!("Force in the hand: {rendered_n:.1} N")
}

/// Summary: the dead band reduces the force.
pub(in crate::console) fn withheld_by_dead_band(withheld_n: f64) -> String {
    format!("{withheld_n:.1} N not rendered: the hand is slower than the dead band")
}

/// Summary: a gate reduces the force.
pub(in crate::console) fn withheld(withheld_n: f64) -> String {
    format!("{withheld_n:.1} N not rendered")
}

/// Summary: the force is still under way over the link.
pub(in crate::console) fn on_its_way(delay_ms: f64) -> String {
    format!("No force yet: the link delays it by {delay_ms:.0} ms")
}

/// Age at which a force has faded to zero.
pub(in crate::console) fn zero_after(age_ms: f64) -> String {
    format!("zero after {age_ms:.0} ms")
}

/// How much of the force the governor keeps back.
pub(in crate::console) fn governed(percent: f64) -> String {
    format!("{percent:.0} % withheld")
}

/// Energy that the hand may still get back.
pub(in crate::console) fn energy_left(stored_mj: f64) -> String {
    format!("{stored_mj:.0} mJ left")
}

/// How often a gate acted, and why it acted last.
pub(in crate::console) fn acted(ticks: u64, percent: f64, why: &str) -> String {
    format!("Acted in {ticks} ticks ({percent:.1} %); last reason: {why}")
}
