//! The feedback panel: mode, gain, delay, dead band, highest stable gain.

use crate::language::{Text, told};

pub(in crate::console) const GAIN_HOVER: Text = Text::of(
    "Ratio of the force in the hand to the force that the mode asks for, no unit: 0 to 1, or up to 3 if \
    allowed below. 0 is no force, 1 is natural. The gain changes by at most 2 per second. The strip \
    below shows up to which gain a gripping hand comes to rest.",
    "Ratio of the force in the hand to the force that the mode asks for, no unit: 0 to 1, or up to 3 if \
    allowed below. 0 is no force, 1 is natural. The gain changes by at most 2 per second. The strip \
    below shows up to which gain a gripping hand comes to rest.",
);
pub(in crate::console) const DELAY_HOVER: Text = Text::of(
    "One-way delay from the follower to the hand, 0 to 500 ms, added to the link's own. The paper uses \
    300 ms. Every mode gets its data this late and predicts this far ahead. Applied when you release the \
    slider.",
    "One-way delay from the follower to the hand, 0 to 500 ms, added to the link's own. The paper uses \
    300 ms. Every mode gets its data this late and predicts this far ahead. Applied when you release the \
    slider.",
);
pub(in crate::console) const DEAD_BAND_HOVER: Text = Text::of(
    "Speed of the hand, 0 to 10 mm/s, below which no force is rendered: at standstill an impedance cannot \
    be identified. The paper uses 1 mm/s; 0 is no dead band. The force fades in and reaches its full \
    size at twice this speed. No effect while \"Keep force at standstill\" is on.",
    "Speed of the hand, 0 to 10 mm/s, below which no force is rendered: at standstill an impedance cannot \
    be identified. The paper uses 1 mm/s; 0 is no dead band. The force fades in and reaches its full \
    size at twice this speed. No effect while \"Keep force at standstill\" is on.",
);
pub(in crate::console) const HOLD_HOVER: Text = Text::of(
    "On: the force stays when the hand stops, so that you feel a steady push. Off: it fades out in the \
    dead band, as in the paper, and \"Why no force?\" shows how much is not rendered (N).",
    "On: the force stays when the hand stops, so that you feel a steady push. Off: it fades out in the \
    dead band, as in the paper, and \"Why no force?\" shows how much is not rendered (N).",
);
pub(in crate::console) const GAIN: Text = Text::of("Gain", "Gain");
pub(in crate::console) const ALLOW_ABOVE_1_HOVER: Text = Text::of(
    "Allows a gain up to 3, so that soft tissue feels stiffer than it is. The force ceiling still \
    applies. Clearing the box brings the gain back to at most 1.",
    "Allows a gain up to 3, so that soft tissue feels stiffer than it is. The force ceiling still \
    applies. Clearing the box brings the gain back to at most 1.",
);
pub(in crate::console) const ALLOW_ABOVE_1: Text = Text::of("Allow above 1", "Allow above 1");
pub(in crate::console) const GAIN_IN_USE_HOVER: Text =
    Text::of("The gain in use now, after its ramp", "The gain in use now, after its ramp");
pub(in crate::console) const RAISE_GAIN: Text = Text::of("Raise the gain", "Raise the gain");
pub(in crate::console) const LOWER_GAIN: Text = Text::of("Lower the gain", "Lower the gain");
pub(in crate::console) const LINK_DELAY: Text = Text::of("Link delay", "Link delay");
pub(in crate::console) const DEAD_BAND: Text = Text::of("Dead band", "Dead band");
pub(in crate::console) const HOLD: Text = Text::of("Keep force at standstill", "Keep force at standstill");
pub(in crate::console) const STABLE_GAIN_UNKNOWN: Text = Text::of(
    "Highest stable gain: known after the first contact",
    "Highest stable gain: known after the first contact",
);
pub(in crate::console) const STABLE_GAIN_UNMEASURED: Text =
    Text::of("Highest stable gain: not measured in this mode", "Highest stable gain: not measured in this mode");
pub(in crate::console) const STABLE_GAIN_HOVER: Text = Text::of(
    "From simulations of a gripping hand that is pushed aside and must come to rest again, for the mode \
    and delay in use and the stiffness of the present contact (N/m; between contacts, of the last one). \
    Force is kept at standstill and the energy gate is off, which is harder than the default settings. \
    Solid: stable. Thin: at the limit. Hatched: the hand shakes.",
    "From simulations of a gripping hand that is pushed aside and must come to rest again, for the mode \
    and delay in use and the stiffness of the present contact (N/m; between contacts, of the last one). \
    Force is kept at standstill and the energy gate is off, which is harder than the default settings. \
    Solid: stable. Thin: at the limit. Hatched: the hand shakes.",
);

/// Verdict of the stability map for this gain.
pub(in crate::console) fn stable_up_to(verdict: &str, greatest: f64, stiffness_n_m: f64) -> String {
    told!(
        "This gain is {verdict}; stable up to {greatest:.2} at {stiffness_n_m:.0} N/m",
        "This gain is {verdict}; stable up to {greatest:.2} at {stiffness_n_m:.0} N/m"
    )
}

/// The present gain, while it ramps to the chosen one.
pub(in crate::console) fn gain_in_use(gain: f64) -> String {
    told!("in use {gain:.2}", "in use {gain:.2}")
}

/// Hover text of a button that changes a value by 0.1.
pub(in crate::console) fn by_a_tenth(name: &str) -> String {
    told!("{name} by 0.1", "{name} by 0.1")
}
