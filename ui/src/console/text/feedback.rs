//! Words of the room `feedback`.

pub(in crate::console) const GAIN_MEANING: &str = "Factor between the force asked for by the mode and the force in the hand, without unit: 0 to 1, or to 3 once \
                            that is allowed. 0 is no force, 1 is natural. Changes are ramped at 2 per second. The strip below tells up \
                            to which gain a gripping hand comes to rest.";
pub(in crate::console) const DELAY_MEANING: &str = "One-way delay from the follower to the hand, 0 to 500 ms, added to what the link has. The paper programs 300 \
                             ms. Every mode gets its data this late and renders this far ahead. Taken over when the slider is let go.";
pub(in crate::console) const DEAD_BAND_MEANING: &str = "Speed of the hand, 0 to 10 mm/s, below which nothing is rendered: at standstill an impedance is unknown. \
                                 The paper uses 1 mm/s; 0 is no dead band. The edge is smooth: force comes back in full at twice the \
                                 speed. While force is kept at standstill, it does nothing.";
pub(in crate::console) const HOLD_MEANING: &str = "On: the force stays when the hand rests, so that a steady push is felt. Off: it fades in the dead band below, as \
                            in the paper, and the panel of gates tells how much is not rendered (N).";
pub(in crate::console) const GAIN: &str = "Gain";
pub(in crate::console) const SECOND_DELIBERATE_ACTION_LETS: &str = "Second, deliberate action: lets the gain go up to 3, so that soft tissue feels harder than it is. The force \
                       ceiling stays. Taking the mark away brings the gain back to 1 at most.";
pub(in crate::console) const ALLOW_ABOVE_1: &str = "Allow above 1";
pub(in crate::console) const THE_GAIN_THE_LOOP: &str = "The gain the loop uses now, after its ramp.";
pub(in crate::console) const RAISE_THE_GAIN: &str = "Raise the gain";
pub(in crate::console) const LOWER_THE_GAIN: &str = "Lower the gain";
pub(in crate::console) const LINK_DELAY: &str = "Link delay";
pub(in crate::console) const DEAD_BAND: &str = "Dead band";
pub(in crate::console) const KEEP_FORCE_AT_STANDSTILL: &str = "Keep force at standstill";
pub(in crate::console) const STABLE_UP_TO_NOT: &str = "Stable up to: not known before a contact";
pub(in crate::console) const MEANING: &str = "From the map of stability, made by simulation: a hand that grips is knocked aside and must come to rest, with \
                       the force kept at standstill and without the energy gate, which is harder than the defaults. For the mode \
                       and the delay in force and the stiffness of the contact now (N/m, slope of force over way, of the last contact \
                       in between). Whole: stable. Thin: at the edge. Hatched: the hand shakes.";

/// Where the gain stands in the map of stability.
pub(in crate::console) fn stable_up_to(verdict: &str, greatest: f64, stiffness_n_m: f64) -> String {
    format!("Here {verdict}; stable up to {greatest:.2} at {stiffness_n_m:.0} N/m")
}
