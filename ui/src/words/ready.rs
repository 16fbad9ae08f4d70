//! Texts about the ready check: its points, and their instructions to the person at the arm.

use nima_machine::{
    messages::Watchdog,
    ready::{Ask, Check, Figure, Lacks, Unit},
    rig::Side,
};

use super::{Words as _, side_word};
use crate::language::{told, word};

pub(crate) fn check_name(check: Check) -> String {
    let of_arm = |side: Side, words: &str| told!("{} arm: {words}", "{}: {words}", capital(side_word(side)));
    match check {
        Check::Devices => word("Devices present and steady", "Geräte vorhanden und stabil").to_owned(),
        Check::Rates => word("Rates and losses of the devices", "Raten und Verluste der Geräte").to_owned(),
        Check::Clocks => word("Clocks and deadlines", "Uhren und Fristen").to_owned(),
        Check::Own(side) => of_arm(side, word("arm and marker belong together", "Arm und Marker gehören zusammen")),
        Check::Bias(side) => of_arm(side, word("drift of the bias", "Drift des Nullpunkts")),
        Check::Push(side) => of_arm(side, word("direction of the force", "Richtung der Kraft")),
        Check::Handle(side) => of_arm(side, word("handle free", "Handgerät frei")),
        Check::Trocar(side) => of_arm(side, word("trocar in its place", "Trokar am alten Ort")),
        Check::Ceiling => word("Force ceiling as in the rig file", "Höchstkraft wie in der Aufbaudatei").to_owned(),
        Check::Stop => word("Stop", "Halt").to_owned(),
        Check::Watchdog(Watchdog::Loop) => word("Watchdog of the loop", "Watchdog der Regelung").to_owned(),
        Check::Watchdog(Watchdog::Source) => word("Watchdog of the measurements", "Watchdog der Messwerte").to_owned(),
        Check::Watchdog(Watchdog::Link) => word("Watchdog of the link", "Watchdog der Verbindung").to_owned(),
    }
}

pub(super) fn capital(word: &str) -> String {
    let mut letters = word.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// Instruction to the person; empty if there is none.
pub(crate) fn ask_words(ask: &Ask) -> String {
    match ask {
        Ask::Nothing => String::new(),
        Ask::Move(side) => {
            told!(
                "Take the {} instrument out of its trocar; if it is already out, move it by 10 cm",
                "Instrument {} aus dem Trokar nehmen; ist es draußen, um 10 cm bewegen",
                side_word(*side)
            )
        }
        Ask::TakeOut(side) => {
            told!(
                "Take the {} instrument out of its trocar, so that nothing touches it",
                "Instrument {} aus dem Trokar nehmen, sodass nichts es berührt",
                side_word(*side)
            )
        }
        Ask::LeaveAlone(side) => told!(
            "Do not touch the {} arm and its instrument",
            "Arm {} und sein Instrument nicht berühren",
            side_word(*side)
        ),
        Ask::Push(side, direction) => {
            told!(
                "Push the tip of the {} instrument {}, for half a second",
                "Instrument {}: Spitze {} drücken, eine halbe Sekunde lang",
                side_word(*side),
                way(&direction.into_inner())
            )
        }
        Ask::LetGo(side) => told!("Release the {} handle", "Handgerät {} loslassen", side_word(*side)),
        Ask::MoveHandle(side, way) => {
            told!(
                "Hold the {} handle and {}, by 2 cm",
                "Handgerät {} fassen und {}, um 2 cm",
                side_word(*side),
                way.words()
            )
        }
        Ask::PutBack(side) => told!(
            "Insert the {} instrument through its trocar and leave it there",
            "Instrument {} durch den Trokar führen und dort lassen",
            side_word(*side)
        ),
        Ask::PressStop => word("Press Stop", "Halt drücken").to_owned(),
        Ask::Release => word("Press Release stop", "Halt lösen drücken").to_owned(),
    }
}

/// Workspace axis nearest to a direction.
fn way(direction: &nalgebra::Vector3<f64>) -> &'static str {
    let axis = direction.iamax();
    match (axis, direction[axis] < 0.0) {
        (0, false) => word("to the right", "nach rechts"),
        (0, true) => word("to the left", "nach links"),
        (1, false) => word("away from you", "von sich weg"),
        (1, true) => word("towards you", "zu sich hin"),
        (_, false) => word("up", "nach oben"),
        (_, true) => word("down", "nach unten"),
    }
}

/// Symbol of a unit; empty for a count.
pub(crate) fn unit(unit: Unit) -> &'static str {
    match unit {
        Unit::Count => "",
        Unit::Newton => "N",
        Unit::Millimetre => "mm",
        Unit::Degree => word("degrees", "Grad"),
        Unit::Percent => "%",
        Unit::Second => "s",
    }
}

pub(crate) fn figure_words(figure: &Figure) -> String {
    let Figure { value, limit, unit: of } = figure;
    match of {
        Unit::Count => told!("{value:.0} of {limit:.0}", "{value:.0} von {limit:.0}"),
        Unit::Newton | Unit::Millimetre | Unit::Percent => {
            told!("{value:.2} {}, limit {limit:.2}", "{value:.2} {}, Grenze {limit:.2}", unit(*of))
        }
        Unit::Degree => told!("{value:.0} {}, limit {limit:.0}", "{value:.0} {}, Grenze {limit:.0}", unit(*of)),
        Unit::Second => told!("{value:.3} {}, limit {limit:.2}", "{value:.3} {}, Grenze {limit:.2}", unit(*of)),
    }
}

pub(crate) fn lacks_words(lacks: Lacks) -> &'static str {
    match lacks {
        Lacks::Devices => word(
            "this rig is simulated and has no devices",
            "dieser Aufbau ist simuliert und hat keine \
         Geräte",
        ),
        Lacks::WristSensor => word("the force is measured at the tip", "die Kraft wird an der Spitze gemessen"),
        Lacks::OtherArm => word("this rig has only one arm", "dieser Aufbau hat nur einen Arm"),
        Lacks::Person => word(
            "no simulated person is at the arm in this scene",
            "in dieser Szene ist keine simulierte Person am Arm",
        ),
    }
}

pub(super) fn with(cause: String, cure: &str) -> [String; 2] {
    [cause, cure.to_owned()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_push_is_asked_for_in_words_of_the_room() {
        let ask = Ask::Push(Side::Left, nalgebra::Vector3::x_axis());
        assert_eq!(ask_words(&ask), "Push the tip of the left instrument to the right, for half a second");
    }
}
