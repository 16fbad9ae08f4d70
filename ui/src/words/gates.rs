//! Texts: the gates between a model and the hand.

use nima_core::safety::Gate;

/// Name and meaning of a gate.
pub(crate) const fn gate_words(gate: Gate) -> [&'static str; 2] {
    match gate {
        Gate::Permission => ["Engaged", "Closed unless the loop is engaged. Stop closes it at once."],
        Gate::Validity => [
            "Valid",
            "Closed when the mode has no result, when the result is not a finite number, or when it is above 1000 N",
        ],
        Gate::Age => [
            "Age",
            "Fades the force out when the data are older than the link's own delay, down to zero after this time",
        ],
        Gate::DeadBand => [
            "Dead band",
            "Closed while the hand moves slower than this. At standstill an impedance cannot be distinguished \
    from a constant force.",
        ],
        Gate::Gain => ["Gain", "The operator's gain. Closed at zero."],
        Gate::Slew => ["Slew", "Limits how fast the force may change, so that no step jerks the hand"],
        Gate::Energy => [
            "Energy",
            "Lets the hand get back the energy that it put in and a little more. When that is used up, it removes \
    the part of the force along the hand's motion.",
        ],
        Gate::Ceiling => ["Ceiling", "The largest force that can reach the hand, never above what the device can give"],
        Gate::Governor => [
            "Governor",
            "Brakes a handle that runs away under the force while no hand holds it. The force returns when a hand takes \
    hold; if none does, the loop goes to idle.",
        ],
    }
}
