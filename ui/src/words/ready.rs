//! Texts about the ready check: its points, and what they ask of a person.

use nima_machine::{
    messages::Watchdog,
    ready::{Ask, Check, Figure, Lacks, Unit},
    rig::Side,
};

use super::Words as _;
use crate::language::{told, word};

/// Name of a point.
pub(crate) fn check_name(check: Check) -> String {
    let of_arm = |side: Side, words: &str| told!("{} arm: {words}", "{} arm: {words}", capital(side.word()));
    match check {
        Check::Devices => word("Devices present and steady", "Devices present and steady").to_owned(),
        Check::Rates => word("Rates and losses of the devices", "Rates and losses of the devices").to_owned(),
        Check::Clocks => word("Clocks and deadlines", "Clocks and deadlines").to_owned(),
        Check::Own(side) => of_arm(side, word("arm and marker are its own", "arm and marker are its own")),
        Check::Bias(side) => of_arm(side, word("drift of the bias", "drift of the bias")),
        Check::Push(side) => of_arm(side, word("direction of the force", "direction of the force")),
        Check::Handle(side) => of_arm(side, word("handle free", "handle free")),
        Check::Trocar(side) => of_arm(side, word("trocar where it was", "trocar where it was")),
        Check::Ceiling => word("Largest force as in the rig file", "Largest force as in the rig file").to_owned(),
        Check::Stop => word("Stop", "Stop").to_owned(),
        Check::Watchdog(Watchdog::Loop) => word("Watchdog over the loop", "Watchdog over the loop").to_owned(),
        Check::Watchdog(Watchdog::Source) => {
            word("Watchdog over the measurements", "Watchdog over the measurements").to_owned()
        }
        Check::Watchdog(Watchdog::Link) => word("Watchdog over the link", "Watchdog over the link").to_owned(),
    }
}

pub(super) fn capital(word: &str) -> String {
    let mut letters = word.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// What a person is to do; empty if nothing.
pub(crate) fn ask_words(ask: &Ask) -> String {
    match ask {
        Ask::Nothing => String::new(),
        Ask::Move(side) => {
            told!(
                "Take the {} instrument out of its trocar; if it is out, move it by 10 cm",
                "Take the {} instrument out of its trocar; if it is out, move it by 10 cm",
                side.word()
            )
        }
        Ask::TakeOut(side) => {
            told!(
                "Take the {} instrument out of its trocar, so that nothing touches it",
                "Take the {} instrument out of its trocar, so that nothing touches it",
                side.word()
            )
        }
        Ask::LeaveAlone(side) => told!(
            "Do not touch the {} arm and its instrument",
            "Do not touch the {} arm and its instrument",
            side.word()
        ),
        Ask::Push(side, direction) => {
            told!(
                "Push the tip of the {} instrument {}, for half a second",
                "Push the tip of the {} instrument {}, for half a second",
                side.word(),
                way(&direction.into_inner())
            )
        }
        Ask::LetGo(side) => told!("Let the {} handle go", "Let the {} handle go", side.word()),
        Ask::MoveHandle(side, way) => {
            told!("Take the {} handle and {}, by 2 cm", "Take the {} handle and {}, by 2 cm", side.word(), way.words())
        }
        Ask::PutBack(side) => told!(
            "Put the {} instrument through its trocar and leave it there",
            "Put the {} instrument through its trocar and leave it there",
            side.word()
        ),
        Ask::PressStop => word("Press the stop", "Press the stop").to_owned(),
        Ask::Release => word("Press Release stop", "Press Release stop").to_owned(),
    }
}

/// The workspace's axis that is nearest to a direction.
fn way(direction: &nalgebra::Vector3<f64>) -> &'static str {
    let axis = direction.iamax();
    match (axis, direction[axis] < 0.0) {
        (0, false) => word("to the right", "to the right"),
        (0, true) => word("to the left", "to the left"),
        (1, false) => word("away from you", "away from you"),
        (1, true) => word("towards you", "towards you"),
        (_, false) => word("up", "up"),
        (_, true) => word("down", "down"),
    }
}

/// Symbol of a unit; empty for a number of things.
pub(crate) fn unit(unit: Unit) -> &'static str {
    match unit {
        Unit::Count => "",
        Unit::Newton => "N",
        Unit::Millimetre => "mm",
        Unit::Degree => word("degrees", "degrees"),
        Unit::Percent => "%",
        Unit::Second => "s",
    }
}

/// What was measured, and its limit.
pub(crate) fn figure_words(figure: &Figure) -> String {
    let Figure { value, limit, unit: of } = figure;
    match of {
        Unit::Count => told!("{value:.0} of {limit:.0}", "{value:.0} of {limit:.0}"),
        Unit::Newton | Unit::Millimetre | Unit::Percent => {
            told!("{value:.2} {}, limit {limit:.2}", "{value:.2} {}, limit {limit:.2}", unit(*of))
        }
        Unit::Degree => told!("{value:.0} {}, limit {limit:.0}", "{value:.0} {}, limit {limit:.0}", unit(*of)),
        Unit::Second => told!("{value:.3} {}, limit {limit:.2}", "{value:.3} {}, limit {limit:.2}", unit(*of)),
    }
}

/// Why a point is left out.
pub(crate) fn lacks_words(lacks: Lacks) -> &'static str {
    match lacks {
        Lacks::Devices => word("this rig is simulated and has no devices", "this rig is simulated and has no devices"),
        Lacks::WristSensor => word("the force is measured at the tip", "the force is measured at the tip"),
        Lacks::OtherArm => word("there is one arm only", "there is one arm only"),
        Lacks::Person => {
            word("nobody is at the simulated arm in this scene", "nobody is at the simulated arm in this scene")
        }
    }
}

/// A cause with its cure.
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
