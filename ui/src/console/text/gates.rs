//! The panel "Why no force?": each gate, and the summary above them.

use crate::language::{Text, told};

pub(in crate::console) const FREE_MOTION: Text = Text::of(
    "Free motion: no contact, so there is no force to render",
    "Free motion: no contact, so there is no force to render",
);
pub(in crate::console) const NONE_DEVICE_MISSING: Text =
    Text::of("No force: a device is missing (see Devices)", "No force: a device is missing (see Devices)");
pub(in crate::console) const NONE_IDLE: Text =
    Text::of("No force: the loop is idle, press Engage", "No force: the loop is idle, press Engage");
pub(in crate::console) const NONE_GETTING_READY: Text =
    Text::of("No force yet: the drives are switching on", "No force yet: the drives are switching on");
pub(in crate::console) const NONE_CLUTCH: Text = Text::of(
    "No force: the clutch is pressed, the hand moves freely",
    "No force: the clutch is pressed, the hand moves freely",
);
pub(in crate::console) const NONE_STOPPED: Text =
    Text::of("No force: stopped by the operator", "No force: stopped by the operator");
pub(in crate::console) const NONE_OTHER_ARM: Text =
    Text::of("No force: the other arm has a fault", "No force: the other arm has a fault");
pub(in crate::console) const NONE_FAULT: Text =
    Text::of("No force: stopped by a fault", "No force: stopped by a fault");
pub(in crate::console) const NONE_INVALID: Text =
    Text::of("No force: the mode has no valid result", "No force: the mode has no valid result");
pub(in crate::console) const NONE_STALE: Text =
    Text::of("No force: the data are too old", "No force: the data are too old");
pub(in crate::console) const NONE_GAIN: Text = Text::of("No force: the gain is zero", "No force: the gain is zero");
pub(in crate::console) const LESS_ENERGY: Text = Text::of(
    "Reduced force: the hand would get back more energy than it put in",
    "Reduced force: the hand would get back more energy than it put in",
);
pub(in crate::console) const DEAD_BAND_OFF: Text = Text::of("off: force is kept", "off: force is kept");
pub(in crate::console) const LESS_GOVERNED: Text = Text::of(
    "Reduced force: the handle runs away and no hand holds it. The force returns when a hand takes hold.",
    "Reduced force: the handle runs away and no hand holds it. The force returns when a hand takes hold.",
);
pub(in crate::console) const GOVERNOR_OFF: Text = Text::of("off: handle's mass unknown", "off: handle's mass unknown");
pub(in crate::console) const NEVER_ACTED: Text = Text::of("It has not acted so far", "It has not acted so far");
pub(in crate::console) const OPEN: Text = Text::of("open", "open");
pub(in crate::console) const CLOSED: Text = Text::of("closed", "closed");
pub(in crate::console) const LIMITING: Text = Text::of("limiting", "limiting");
pub(in crate::console) const ENERGY_OFF: Text = Text::of("off", "off");

/// Switch: gates of which side.
pub(in crate::console) fn gates_of(side: &str) -> String {
    told!("Shows why there is no force in the {side} hand", "Shows why there is no force in the {side} hand")
}

/// Summary: a force is rendered.
pub(in crate::console) fn rendered(rendered_n: f64) -> String {
    told!("Force in the hand: {rendered_n:.1} N", "Force in the hand: {rendered_n:.1} N")
}

/// Summary: the dead band reduces the force.
pub(in crate::console) fn withheld_by_dead_band(withheld_n: f64) -> String {
    told!(
        "{withheld_n:.1} N not rendered: the hand is slower than the dead band",
        "{withheld_n:.1} N not rendered: the hand is slower than the dead band"
    )
}

/// Summary: a gate reduces the force.
pub(in crate::console) fn withheld(withheld_n: f64) -> String {
    told!("{withheld_n:.1} N not rendered", "{withheld_n:.1} N not rendered")
}

/// Summary: the force is still under way over the link.
pub(in crate::console) fn on_its_way(delay_ms: f64) -> String {
    told!(
        "No force yet: the link delays it by {delay_ms:.0} ms",
        "No force yet: the link delays it by {delay_ms:.0} ms"
    )
}

/// Age at which a force has faded to zero.
pub(in crate::console) fn zero_after(age_ms: f64) -> String {
    told!("zero after {age_ms:.0} ms", "zero after {age_ms:.0} ms")
}

/// How much of the force the governor keeps back.
pub(in crate::console) fn governed(percent: f64) -> String {
    told!("{percent:.0} % withheld", "{percent:.0} % withheld")
}

/// Energy that the hand may still get back.
pub(in crate::console) fn energy_left(stored_mj: f64) -> String {
    told!("{stored_mj:.0} mJ left", "{stored_mj:.0} mJ left")
}

/// How often a gate acted, and why it acted last.
pub(in crate::console) fn acted(ticks: u64, percent: f64, why: &str) -> String {
    told!(
        "Acted in {ticks} ticks ({percent:.1} %); last reason: {why}",
        "Acted in {ticks} ticks ({percent:.1} %); last reason: {why}"
    )
}
