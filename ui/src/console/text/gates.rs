//! Words of the room `gates`.

pub(in crate::console) const FREE_MOTION_NO_CONTACT: &str = "Free motion: no contact, nothing to render.";
pub(in crate::console) const NO_FORCE_A_DEVICE: &str = "No force: a device is missing (see the devices).";
pub(in crate::console) const NO_FORCE_THE_LOOP: &str = "No force: the loop is idle. Press Engage.";
pub(in crate::console) const NO_FORCE_YET_THE: &str = "No force yet: the drives are coming on.";
pub(in crate::console) const NO_FORCE_THE_CLUTCH: &str = "No force: the clutch is pressed, the hand moves freely.";
pub(in crate::console) const NO_FORCE_STOPPED_BY: &str = "No force: stopped by the operator.";
pub(in crate::console) const NO_FORCE_THE_OTHER: &str = "No force: the other arm was stopped by a fault.";
pub(in crate::console) const NO_FORCE_STOPPED_BY_A: &str = "No force: stopped by a fault.";
pub(in crate::console) const NO_FORCE_THE_HAND: &str =
    "No force: the hand has let go. It comes back when the contact has ended.";
pub(in crate::console) const NO_FORCE_THE_MODE: &str = "No force: the mode has nothing valid to render.";
pub(in crate::console) const NO_FORCE_THE_DATA: &str = "No force: the data are too old.";
pub(in crate::console) const NO_FORCE_THE_GAIN: &str = "No force: the gain is zero.";
pub(in crate::console) const LESS_FORCE_THE_HAND: &str =
    "Less force: the hand would get back more energy than it gave.";
pub(in crate::console) const DEAD_BAND: &str = "Dead band";
pub(in crate::console) const CLOSED_WHILE_THE_HAND: &str =
    "Closed while the hand is slower than this. At standstill an impedance cannot be told from a constant force.";
pub(in crate::console) const OFF_FORCE_IS_KEPT: &str = "off: force is kept";
pub(in crate::console) const ENGAGED: &str = "Engaged";
pub(in crate::console) const CLOSED_UNLESS_THE_LOOP: &str =
    "Closed unless the loop is engaged. Stop closes it at once.";
pub(in crate::console) const HAND: &str = "Hand";
pub(in crate::console) const OFF_HANDLE_S_MASS: &str = "off: handle's mass unknown";
pub(in crate::console) const CLOSED_WHEN_THE_HANDLE: &str = "Closed when the handle flies off as it does without a hand, until the contact has ended or the loop is engaged anew.";
pub(in crate::console) const VALID: &str = "Valid";
pub(in crate::console) const CLOSED_WHEN_THE_MODE: &str =
    "Closed when the mode asks for nothing, for something not finite, or for more than 1000 N.";
pub(in crate::console) const AGE: &str = "Age";
pub(in crate::console) const FADES_THE_FORCE_WHEN: &str =
    "Fades the force when data are older than the link's own delay, to zero after this time.";
pub(in crate::console) const GAIN: &str = "Gain";
pub(in crate::console) const THE_OPERATOR_S_FACTOR: &str = "The operator's factor. Closed at zero.";
pub(in crate::console) const SLEW: &str = "Slew";
pub(in crate::console) const LIMITS_HOW_FAST_THE: &str =
    "Limits how fast the force may change, so that no step kicks the hand.";
pub(in crate::console) const ENERGY: &str = "Energy";
pub(in crate::console) const LETS_THE_HAND_GET: &str = "Lets the hand get back what it gave and a little more: takes the force along its motion away when that is used up.";
pub(in crate::console) const CEILING: &str = "Ceiling";
pub(in crate::console) const THE_LARGEST_FORCE_THAT: &str =
    "The largest force that ever reaches the hand, never above what the device can give.";
pub(in crate::console) const IT_HAS_NOT_ACTED: &str = "It has not acted so far.";

/// Whose gates a switch tells.
pub(in crate::console) fn gates_of(side: &str) -> String {
    format!("Tells why there is no force in the {side} hand.")
}

/// There is force.
pub(in crate::console) fn there_is(rendered_n: f64) -> String {
    format!("There is: {rendered_n:.1} N in the hand.")
}

/// The dead band takes force away.
pub(in crate::console) fn withheld_by_dead_band(withheld_n: f64) -> String {
    format!("{withheld_n:.1} N not rendered (dead band)")
}

/// A gate takes force away.
pub(in crate::console) fn withheld(withheld_n: f64) -> String {
    format!("{withheld_n:.1} N not rendered")
}

/// The force has not come yet.
pub(in crate::console) fn on_its_way(delay_ms: f64) -> String {
    format!("On its way: the link is {delay_ms:.0} ms late.")
}

/// Age at which nothing is left of a force.
pub(in crate::console) fn zero_after(age_ms: f64) -> String {
    format!("zero after {age_ms:.0} ms")
}

/// What the hand may still get back.
pub(in crate::console) fn energy_left(stored_mj: f64) -> String {
    format!("{stored_mj:.0} mJ left")
}

/// How often a gate acted, and why it last did.
pub(in crate::console) fn acted(ticks: u64, percent: f64, why: &str) -> String {
    format!("Acted on {ticks} ticks ({percent:.1} %); the last time: {why}.")
}
