//! Texts: the gates between a model and the hand.

use nima_core::safety::Gate;

use crate::language::word;

/// Name and meaning of a gate.
pub(crate) fn gate_words(gate: Gate) -> [&'static str; 2] {
    match gate {
        Gate::Permission => [
            word("Engaged", "Engaged"),
            word(
                "Closed unless the loop is engaged. Stop closes it at once.",
                "Closed unless the loop is engaged. Stop closes it at once.",
            ),
        ],
        Gate::Validity => [
            word("Valid", "Valid"),
            word(
                "Closed when the mode has no result, when the result is not a finite number, or when it is above 1000 \
                 N",
                "Closed when the mode has no result, when the result is not a finite number, or when it is above 1000 \
                 N",
            ),
        ],
        Gate::Age => [
            word("Age", "Age"),
            word(
                "Fades the force out when the data are older than the link's own delay, down to zero after this time",
                "Fades the force out when the data are older than the link's own delay, down to zero after this time",
            ),
        ],
        Gate::DeadBand => [
            word("Dead band", "Dead band"),
            word(
                "Closed while the hand moves slower than this. At standstill an impedance cannot be distinguished \
    from a constant force.",
                "Closed while the hand moves slower than this. At standstill an impedance cannot be distinguished \
    from a constant force.",
            ),
        ],
        Gate::Gain => {
            [word("Gain", "Gain"), word("The operator's gain. Closed at zero.", "The operator's gain. Closed at zero.")]
        }
        Gate::Slew => [
            word("Slew", "Slew"),
            word(
                "Limits how fast the force may change, so that no step jerks the hand",
                "Limits how fast the force may change, so that no step jerks the hand",
            ),
        ],
        Gate::Energy => [
            word("Energy", "Energy"),
            word(
                "Lets the hand get back the energy that it put in and a little more. When that is used up, it removes \
    the part of the force along the hand's motion.",
                "Lets the hand get back the energy that it put in and a little more. When that is used up, it removes \
    the part of the force along the hand's motion.",
            ),
        ],
        Gate::Ceiling => [
            word("Ceiling", "Ceiling"),
            word(
                "The largest force that can reach the hand, never above what the device can give",
                "The largest force that can reach the hand, never above what the device can give",
            ),
        ],
        Gate::Governor => [
            word("Governor", "Governor"),
            word(
                "Brakes a handle that runs away under the force while no hand holds it. The force returns when a hand \
                 takes hold; if none does, the loop goes to idle.",
                "Brakes a handle that runs away under the force while no hand holds it. The force returns when a hand \
                 takes hold; if none does, the loop goes to idle.",
            ),
        ],
    }
}
