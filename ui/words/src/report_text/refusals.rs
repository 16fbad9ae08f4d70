//! Reasons and remedies of refused commands.

use nima_machine::{
    messages::{Fault, LoopState, Refusal},
    rig::EngageBlocker,
};

use super::{Remedy as _, ShortText as _, exchange_text, force::cure_of_unknown, obstacle_text};
use crate::language::{text_format, word};

/// Returns the reason, a clause without a full stop.
pub fn refused_because(why: Refusal) -> String {
    match why {
        Refusal::State(state) => in_state(state).to_owned(),
        Refusal::StillPresent(fault) => text_format!(
            "the cause of a fault is still present: {}",
            "die Ursache einer Störung besteht noch: {}",
            lower(fault.cause())
        ),
        Refusal::ForceUnknown(source) => {
            text_format!("the force at the tip is {}", "die Kraft an der Spitze ist {}", source.words())
        }
        Refusal::Implausible(what) => {
            text_format!(
                "a measurement is not plausible: {}",
                "eine Messung ist nicht plausibel: {}",
                lower(what.cause())
            )
        }
        Refusal::Obstacle(waiting @ EngageBlocker::Waiting(_)) => obstacle_text(&waiting),
        Refusal::Obstacle(
            obstacle @ (EngageBlocker::FarEnd
            | EngageBlocker::OneHandle
            | EngageBlocker::OneArm
            | EngageBlocker::OneSensor),
        ) => obstacle_text(&obstacle),
        Refusal::Obstacle(EngageBlocker::Exchanged(exchange)) => exchange_text(exchange).to_owned(),
        Refusal::Obstacle(obstacle) => text_format!(
            "the arm cannot start from its current position: {}",
            "der Arm kann von hier nicht starten: {}",
            obstacle_text(&obstacle)
        ),
        Refusal::EndoscopeUnseen => {
            word("the tracker does not see the endoscope", "der Tracker sieht das Endoskop nicht").to_owned()
        }
        Refusal::DrivesOff => {
            word("the drives did not respond in time", "die Antriebe reagierten nicht rechtzeitig").to_owned()
        }
        Refusal::Moving => word("the arm was not at rest", "der Arm war nicht in Ruhe").to_owned(),
        Refusal::HandAbsent => word("no hand holds the handle", "keine Hand hält das Handgerät").to_owned(),
        Refusal::ClutchPressed => word("the clutch is pressed", "die Kupplung ist gedrückt").to_owned(),
        Refusal::NotChecked => word(
            "this rig requires a ready check, and none has passed in the last 12 hours",
            "dieser Aufbau verlangt eine Startprüfung, und in den letzten 12 Stunden wurde keine bestanden",
        )
        .to_owned(),
        Refusal::OutOfRange => {
            word("the value is outside its range", "der Wert liegt außerhalb seines Bereichs").to_owned()
        }
        Refusal::DelayIsMeasured => word(
            "the delay is the measured network delay and cannot be set",
            "die Verzögerung ist die gemessene Netzwerkverzögerung und nicht einstellbar",
        )
        .to_owned(),
        Refusal::SimulatedOnly => word(
            "this command is for simulated rigs only: a person may hold the handle of this rig",
            "dieser Befehl gilt nur für simulierte Aufbauten: hier kann ein Mensch das Handgerät halten",
        )
        .to_owned(),
        Refusal::NoSuchArm => {
            word("this rig has no arm on that side", "dieser Aufbau hat auf dieser Seite keinen Arm").to_owned()
        }
    }
}

/// Returns the remedy, a clause without a full stop.
pub fn cure_of_refusal(why: Refusal) -> &'static str {
    match why {
        Refusal::State(LoopState::Stopped) => word("press Release stop first", "erst Halt lösen drücken"),
        Refusal::State(LoopState::Faulted(_)) => word(
            "remove the cause of the fault, then press Release stop",
            "Ursache der Störung beseitigen, dann Halt lösen drücken",
        ),
        Refusal::State(LoopState::Disconnected) => word(
            "see the Devices panel (F2) for the missing device and the cause",
            "siehe Panel Geräte (F2): welches Gerät fehlt und warum",
        ),
        Refusal::State(_) => word("see the state of the loop", "siehe Zustand der Regelung"),
        Refusal::StillPresent(Fault::FarEnd { .. }) => word(
            "remove the cause there, then press Stop and Release stop here: this releases both machines",
            "Ursache dort beseitigen, dann hier Halt und Halt lösen drücken: das gibt beide Rechner frei",
        ),
        Refusal::StillPresent(_) => word("remove the cause first", "erst die Ursache beseitigen"),
        Refusal::ForceUnknown(source) => cure_of_unknown(source),
        Refusal::Implausible(_) => word("check the sensor and its cable", "Sensor und sein Kabel prüfen"),
        Refusal::Obstacle(EngageBlocker::Exchanged(_)) => word(
            "undo the swap, on the rig or in the rig file; the ready check shows which parts are swapped",
            "Vertauschtes zurücktauschen, am Aufbau oder in der Aufbaudatei; die Startprüfung zeigt, was \
             vertauscht ist",
        ),
        Refusal::Obstacle(EngageBlocker::OneHandle | EngageBlocker::OneArm | EngageBlocker::OneSensor) => word(
            "correct the address or port of one of the two in the rig file; both lead to one device",
            "Adresse oder Anschluss eines der beiden in der Aufbaudatei berichtigen; beide führen zu einem Gerät",
        ),
        Refusal::Obstacle(EngageBlocker::Waiting(_)) => word(
            "wait a moment, clear the tracker's view, then engage again",
            "kurz warten, Sicht des Trackers freimachen, dann neu koppeln",
        ),
        Refusal::Obstacle(EngageBlocker::FarEnd) => word(
            "remove the cause on the follower's machine, then engage again",
            "Grund am Rechner des Folgearms beseitigen, dann neu koppeln",
        ),
        Refusal::Obstacle(_) => word("move the arm, then engage again", "Arm bewegen, dann neu koppeln"),
        Refusal::EndoscopeUnseen => word(
            "clear the tracker's view of the endoscope and of the arm, then engage again",
            "Sicht des Trackers auf Endoskop und Arm freimachen, dann neu koppeln",
        ),
        Refusal::DrivesOff => word(
            "check the lamps and buttons on the arm and the handle, then engage again",
            "Lampen und Tasten an Arm und Handgerät ansehen, dann neu koppeln",
        ),
        Refusal::Moving => {
            word("let the arm come to rest, then engage again", "Arm zur Ruhe kommen lassen, dann neu koppeln")
        }
        Refusal::HandAbsent => word("hold the handle, then engage again", "Handgerät halten, dann neu koppeln"),
        Refusal::ClutchPressed => word("release the clutch, then engage again", "Kupplung loslassen, dann neu koppeln"),
        Refusal::NotChecked => {
            word("press Ready check in the Calibration panel (F2)", "im Panel Kalibrierung (F2) Startprüfung drücken")
        }
        Refusal::OutOfRange => word("choose a value within the range", "einen Wert im Bereich wählen"),
        Refusal::DelayIsMeasured => word(
            "see the Link panel (F2) for the network delay",
            "siehe Panel Verbindung (F2): Verzögerung des Netzwerks",
        ),
        Refusal::SimulatedOnly => word("choose a simulated rig", "einen simulierten Aufbau wählen"),
        Refusal::NoSuchArm => word("choose another arm", "einen anderen Arm wählen"),
    }
}

fn in_state(state: LoopState) -> &'static str {
    match state {
        LoopState::Disconnected => word("a device is missing", "ein Gerät fehlt"),
        LoopState::Idle => {
            word("the loop is not engaged and not stopped", "die Regelung ist weder gekoppelt noch angehalten")
        }
        LoopState::Ready => word("an engagement has already begun", "eine Kopplung hat schon begonnen"),
        LoopState::Engaged | LoopState::Clutched => {
            word("the loop is already engaged", "die Regelung ist schon gekoppelt")
        }
        LoopState::Stopped => word("the stop is latched", "der Halt ist verriegelt"),
        LoopState::Faulted(_) => word("a fault is latched", "eine Störung ist verriegelt"),
    }
}

/// Returns the same text with a lower-case first letter, for use within a sentence.
fn lower(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or_else(String::new, |first| first.to_lowercase().chain(letters).collect())
}

#[cfg(test)]
mod tests {
    use nima_machine::{messages::ForceSource, rig::SideSwap};

    use super::*;

    /// Refusals whose text depends on no other data.
    const REFUSALS: [Refusal; 15] = [
        Refusal::ForceUnknown(ForceSource::Uncalibrated),
        Refusal::ForceUnknown(ForceSource::NoOrientation),
        Refusal::ForceUnknown(ForceSource::Poisoned),
        Refusal::ForceUnknown(ForceSource::NoSample),
        Refusal::ForceUnknown(ForceSource::Unidentified),
        Refusal::EndoscopeUnseen,
        Refusal::DrivesOff,
        Refusal::Moving,
        Refusal::HandAbsent,
        Refusal::ClutchPressed,
        Refusal::NotChecked,
        Refusal::OutOfRange,
        Refusal::DelayIsMeasured,
        Refusal::SimulatedOnly,
        Refusal::NoSuchArm,
    ];

    #[test]
    fn no_two_refusals_say_the_same() {
        let fault = Fault::SourceSilent;
        let more = [
            Refusal::State(LoopState::Stopped),
            Refusal::State(LoopState::Faulted(fault)),
            Refusal::State(LoopState::Disconnected),
            Refusal::State(LoopState::Engaged),
            Refusal::StillPresent(fault),
            Refusal::Obstacle(EngageBlocker::Exchanged(SideSwap::Arms)),
        ];
        let all = REFUSALS.into_iter().chain(more);
        let mut report: Vec<_> = all.map(|why| (refused_because(why), cure_of_refusal(why))).collect();
        report.sort();
        report.dedup();
        assert_eq!(report.len(), REFUSALS.len() + more.len(), "{report:?}");
        assert!(report.iter().all(|(cause, cure)| !cause.ends_with('.') && !cure.ends_with('.')), "{report:?}");
    }
}
