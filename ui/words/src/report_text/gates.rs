//! Texts: the gates between a model and the hand, and why they reduce a force.

use nima_core::safety::{Gate, Reason};

use super::ShortText;
use crate::language::word;

pub fn gate_text(gate: Gate) -> [&'static str; 2] {
    match gate {
        Gate::Permission => [
            word("Engaged", "Gekoppelt"),
            word(
                "Closed unless the loop is engaged. Stop closes it at once.",
                "Geschlossen, solange die Regelung nicht gekoppelt ist. Halt schließt sofort.",
            ),
        ],
        Gate::Validity => [
            word("Valid", "Gültig"),
            word(
                "Closed when the mode has no result, or the result is not a finite number or exceeds 1000 N",
                "Geschlossen, wenn der Modus kein Ergebnis hat, es keine endliche Zahl ist oder über 1000 N liegt",
            ),
        ],
        Gate::Age => [
            word("Age", "Alter"),
            word(
                "Fades the force out when the data are older than the link's delay; the force is zero after this \
                 time",
                "Blendet die Kraft aus, wenn die Daten älter sind als die Verzögerung der Verbindung, bis auf null \
                 nach dieser Zeit",
            ),
        ],
        Gate::DeadBand => [
            word("Dead band", "Totband"),
            word(
                "Closed while the hand moves slower than this. At standstill an impedance cannot be distinguished \
    from a constant force.",
                "Geschlossen, solange die Hand langsamer ist als dieser Wert. Im Stillstand ist eine Impedanz nicht \
                 von einer konstanten Kraft zu unterscheiden.",
            ),
        ],
        Gate::Gain => [
            word("Gain", "Verstärkung"),
            word(
                "The operator's gain. Closed at zero.",
                "Vom Bediener eingestellt. Bei \
             null geschlossen.",
            ),
        ],
        Gate::Slew => [
            word("Slew", "Anstieg"),
            word(
                "Limits how fast the force changes, so that no step jerks the hand",
                "Begrenzt, wie schnell sich die Kraft ändert, damit kein Sprung an der Hand ruckt",
            ),
        ],
        Gate::Energy => [
            word("Energy", "Energie"),
            word(
                "Limits the energy returned to the hand to the energy that the hand put in, plus a small margin. \
                 Beyond that, the gate removes the force component along the hand's motion.",
                "Begrenzt die der Hand zurückgegebene Energie auf die von ihr eingebrachte und eine kleine Reserve. \
                 Darüber entfällt der Kraftanteil entlang der Handbewegung.",
            ),
        ],
        Gate::Ceiling => [
            word("Ceiling", "Höchstkraft"),
            word(
                "The largest force that can reach the hand, never above the device's limit",
                "Größte Kraft, die die Hand erreichen kann, nie mehr, als das Gerät geben kann",
            ),
        ],
        Gate::Governor => [
            word("Governor", "Wächter"),
            word(
                "Brakes a handle that runs away under the force while no hand holds it. The force returns when a \
                 hand grips the handle; otherwise the loop goes to idle.",
                "Bremst ein Handgerät, das unter der Kraft wegläuft, ohne dass eine Hand es hält. Die Kraft kehrt \
                 zurück, wenn eine Hand zufasst; sonst geht die Regelung in den Leerlauf.",
            ),
        ],
    }
}

impl ShortText for Reason {
    fn words(self) -> &'static str {
        match self {
            Self::Open => word("open", "offen"),
            Self::NotPermitted => word("the loop is not engaged", "die Regelung ist nicht gekoppelt"),
            Self::RunsAway => word(
                "the handle moves as if no hand held it, so the force fades",
                "das Handgerät bewegt sich, als hielte es niemand, die Kraft wird ausgeblendet",
            ),
            Self::LetGo => word(
                "the hand has let go: no force, the handle is braked",
                "die Hand hat losgelassen: keine Kraft, das Handgerät wird gebremst",
            ),
            Self::HandGone => word("the hand has let go of the handle", "die Hand hat das Handgerät losgelassen"),
            Self::NothingAsked => word("the mode has no valid result", "der Modus hat kein gültiges Ergebnis"),
            Self::NotFinite => word("the mode's result is not a number", "das Ergebnis des Modus ist keine Zahl"),
            Self::Implausible => word(
                "the mode requests more force than any contact can cause",
                "der Modus verlangt mehr Kraft, als ein Kontakt geben kann",
            ),
            Self::Ageing => word(
                "the data are late, so the force fades",
                "die Daten sind verspätet, die Kraft wird \
             ausgeblendet",
            ),
            Self::TooOld => word("the data are too old", "die Daten sind zu alt"),
            Self::HandSlow => word("the hand is slower than the dead band", "die Hand ist langsamer als das Totband"),
            Self::SpeedUnknown => word(
                "the speed of the hand is not known",
                "die Geschwindigkeit der Hand ist \
             unbekannt",
            ),
            Self::GainZero => word("the gain is zero", "die Verstärkung ist null"),
            Self::GainRamping => word(
                "the gain is still changing to the chosen value",
                "die Verstärkung nähert sich noch dem gewählten Wert",
            ),
            Self::ChangeTooFast => word("the force would change too fast", "die Kraft würde sich zu schnell ändern"),
            Self::EnergySpent => word(
                "the hand would get back more energy than it put in",
                "die Hand bekäme mehr Energie zurück, als sie gab",
            ),
            Self::AboveCeiling => word("the force is above the ceiling", "die Kraft liegt über der Höchstkraft"),
            Self::AboveDeviceLimit => word(
                "the force exceeds the device's limit",
                "die Kraft liegt über dem, was das Gerät geben \
                 kann",
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use nima_core::safety::PLAUSIBLE_N;

    use super::*;
    use crate::language::{self, Language};

    #[test]
    fn the_implausible_force_is_that_of_the_gate() {
        for one in [Language::English, Language::German] {
            let [_, meaning] = language::with(one, || gate_text(Gate::Validity));
            assert!(meaning.contains(&format!("{PLAUSIBLE_N} N")), "{meaning}");
        }
    }
}
