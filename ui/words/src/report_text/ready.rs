//! Texts about the ready check: its points, and their instructions to the person at the arm.

use nima_machine::{
    messages::Watchdog,
    ready::{FigureUnit, Lacks, PersonRequest, ReadyFigure, ReadyPoint},
    rig::Side,
};

use super::{ShortText as _, sentence, side_word};
use crate::language::{text_format, word};

pub fn check_name(check: ReadyPoint) -> String {
    let of_arm = |side: Side, words: &str| text_format!("{} arm: {words}", "{}: {words}", sentence(side_word(side)));
    match check {
        ReadyPoint::Devices => word("Devices present and steady", "Geräte vorhanden und stabil").to_owned(),
        ReadyPoint::Rates => word("Rates and losses of the devices", "Raten und Verluste der Geräte").to_owned(),
        ReadyPoint::Clocks => word("Clocks and deadlines", "Uhren und Fristen").to_owned(),
        ReadyPoint::Own(side) => {
            of_arm(side, word("arm and marker belong together", "Arm und Marker gehören zusammen"))
        }
        ReadyPoint::Bias(side) => of_arm(side, word("drift of the bias", "Drift des Nullpunkts")),
        ReadyPoint::Push(side) => of_arm(side, word("direction of the force", "Richtung der Kraft")),
        ReadyPoint::Handle(side) => of_arm(side, word("handle free", "Handgerät frei")),
        ReadyPoint::Trocar(side) => of_arm(side, word("trocar in its place", "Trokar am alten Ort")),
        ReadyPoint::Ceiling => {
            word("Force ceiling as in the rig file", "Höchstkraft wie in der Aufbaudatei").to_owned()
        }
        ReadyPoint::Stop => word("Stop", "Halt").to_owned(),
        ReadyPoint::Watchdog(Watchdog::Loop) => word("Watchdog of the loop", "Watchdog der Regelung").to_owned(),
        ReadyPoint::Watchdog(Watchdog::Source) => {
            word("Watchdog of the measurements", "Watchdog der Messwerte").to_owned()
        }
        ReadyPoint::Watchdog(Watchdog::Link) => word("Watchdog of the link", "Watchdog der Verbindung").to_owned(),
    }
}

/// Returns the instruction to the person; empty if there is none.
pub fn ask_text(ask: &PersonRequest) -> String {
    match ask {
        PersonRequest::Nothing => String::new(),
        PersonRequest::Move(side) => {
            text_format!(
                "Take the {} instrument out of its trocar; if it is already out, move it by 10 cm",
                "Instrument {} aus dem Trokar nehmen; ist es draußen, um 10 cm bewegen",
                side_word(*side)
            )
        }
        PersonRequest::TakeOut(side) => {
            text_format!(
                "Take the {} instrument out of its trocar, so that nothing touches it",
                "Instrument {} aus dem Trokar nehmen, sodass nichts es berührt",
                side_word(*side)
            )
        }
        PersonRequest::LeaveAlone(side) => text_format!(
            "Do not touch the {} arm and its instrument",
            "Arm {} und sein Instrument nicht berühren",
            side_word(*side)
        ),
        PersonRequest::Push(side, direction) => {
            text_format!(
                "Push the tip of the {} instrument {}, for half a second",
                "Instrument {}: Spitze {} drücken, eine halbe Sekunde lang",
                side_word(*side),
                way(&direction.into_inner())
            )
        }
        PersonRequest::LetGo(side) => text_format!("Release the {} handle", "Handgerät {} loslassen", side_word(*side)),
        PersonRequest::MoveHandle(side, way) => {
            text_format!(
                "Hold the {} handle and {}, by 2 cm",
                "Handgerät {} fassen und {}, um 2 cm",
                side_word(*side),
                way.words()
            )
        }
        PersonRequest::PutBack(side) => text_format!(
            "Insert the {} instrument through its trocar and leave it there",
            "Instrument {} durch den Trokar führen und dort lassen",
            side_word(*side)
        ),
        PersonRequest::PressStop => word("Press Stop", "Halt drücken").to_owned(),
        PersonRequest::Release => word("Press Release stop", "Halt lösen drücken").to_owned(),
    }
}

/// Returns the workspace axis nearest to a direction.
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

/// Returns the symbol of a unit; empty for a count.
pub fn unit(unit: FigureUnit) -> &'static str {
    match unit {
        FigureUnit::Count => "",
        FigureUnit::Newton => "N",
        FigureUnit::Millimetre => "mm",
        FigureUnit::Degree => word("degrees", "Grad"),
        FigureUnit::Percent => "%",
        FigureUnit::Second => "s",
    }
}

pub fn figure_text(figure: &ReadyFigure) -> String {
    let ReadyFigure { value, limit, unit: of } = figure;
    match of {
        FigureUnit::Count => text_format!("{value:.0} of {limit:.0}", "{value:.0} von {limit:.0}"),
        FigureUnit::Newton | FigureUnit::Millimetre | FigureUnit::Percent => {
            text_format!("{value:.2} {}, limit {limit:.2}", "{value:.2} {}, Grenze {limit:.2}", unit(*of))
        }
        FigureUnit::Degree => {
            text_format!("{value:.0} {}, limit {limit:.0}", "{value:.0} {}, Grenze {limit:.0}", unit(*of))
        }
        FigureUnit::Second => {
            text_format!("{value:.3} {}, limit {limit:.2}", "{value:.3} {}, Grenze {limit:.2}", unit(*of))
        }
    }
}

pub fn lacks_text(lacks: Lacks) -> &'static str {
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
        let ask = PersonRequest::Push(Side::Left, nalgebra::Vector3::x_axis());
        assert_eq!(ask_text(&ask), "Push the tip of the left instrument to the right, for half a second");
    }
}
