//! Texts: why a command was refused, and what the operator can do.

use nima_machine::{
    messages::{Fault, LoopState, Refusal},
    rig::Obstacle,
};

use super::Remedy as _;
use crate::language::{told, word};

/// The reason, a clause without a full stop.
pub(crate) fn refused_because(why: Refusal) -> String {
    match why {
        Refusal::State(state) => in_state(state).to_owned(),
        Refusal::StillPresent(fault) => told!(
            "the cause of a fault is still present: {}",
            "the cause of a fault is still present: {}",
            lower(fault.cause())
        ),
        Refusal::ForceUnknown => {
            word("the force at the tip is not known", "the force at the tip is not known").to_owned()
        }
        Refusal::Implausible(what) => {
            told!("a measurement is not plausible: {}", "a measurement is not plausible: {}", lower(what.cause()))
        }
        Refusal::Obstacle(waiting @ Obstacle::Waiting(_)) => waiting.to_string(),
        Refusal::Obstacle(obstacle @ Obstacle::FarEnd) => obstacle.to_string(),
        Refusal::Obstacle(Obstacle::Exchanged(exchange)) => exchange.words().to_owned(),
        Refusal::Obstacle(obstacle) => told!(
            "the arm cannot start from where it is: {obstacle}",
            "the arm cannot start from where it is: {obstacle}"
        ),
        Refusal::EndoscopeUnseen => {
            word("the tracker does not see the endoscope", "the tracker does not see the endoscope").to_owned()
        }
        Refusal::DrivesOff => word("the drives did not obey in time", "the drives did not obey in time").to_owned(),
        Refusal::Moving => word("the arm was not at rest", "the arm was not at rest").to_owned(),
        Refusal::HandAbsent => word("nobody holds the handle", "nobody holds the handle").to_owned(),
        Refusal::ClutchPressed => word("the clutch is pressed", "the clutch is pressed").to_owned(),
        Refusal::NotChecked => word(
            "this rig requires a ready check, and none of the last 12 hours has passed",
            "this rig requires a ready check, and none of the last 12 hours has passed",
        )
        .to_owned(),
        Refusal::OutOfRange => word("the value is outside its range", "the value is outside its range").to_owned(),
        Refusal::DelayIsMeasured => word(
            "the delay is that of the network, which is measured and not set",
            "the delay is that of the network, which is measured and not set",
        )
        .to_owned(),
        Refusal::SimulatedOnly => {
            word("a person may hold the handle of this rig", "a person may hold the handle of this rig").to_owned()
        }
        Refusal::NoSuchArm => word("this rig has no arm on that side", "this rig has no arm on that side").to_owned(),
    }
}

/// What the operator can do, a clause without a full stop.
pub(crate) fn cure_of_refusal(why: Refusal) -> &'static str {
    match why {
        Refusal::State(LoopState::Stopped) => word("release the stop first", "release the stop first"),
        Refusal::State(LoopState::Faulted(_)) => {
            word("remove its cause, then release the stop", "remove its cause, then release the stop")
        }
        Refusal::State(LoopState::Disconnected) => {
            word("see the devices for what is missing and why", "see the devices for what is missing and why")
        }
        Refusal::State(_) => word("see the state of the loop", "see the state of the loop"),
        Refusal::StillPresent(Fault::FarEnd { .. }) => word(
            "remove its cause there, then press Stop and Release stop here: that releases both machines",
            "remove its cause there, then press Stop and Release stop here: that releases both machines",
        ),
        Refusal::StillPresent(_) => word("remove the cause first", "remove the cause first"),
        Refusal::ForceUnknown => {
            word("calibrate gravity for this sensor and tool", "calibrate gravity for this sensor and tool")
        }
        Refusal::Implausible(_) => word("see the sensor and its cable", "see the sensor and its cable"),
        Refusal::Obstacle(Obstacle::Exchanged(_)) => word(
            "put what is exchanged back, in the room or in the rig file; the ready check tells which it is",
            "put what is exchanged back, in the room or in the rig file; the ready check tells which it is",
        ),
        Refusal::Obstacle(Obstacle::Waiting(_)) => word(
            "wait a moment, clear the tracker's view, then engage again",
            "wait a moment, clear the tracker's view, then engage again",
        ),
        Refusal::Obstacle(Obstacle::FarEnd) => word(
            "remove the reason at the follower's machine, then engage again",
            "remove the reason at the follower's machine, then engage again",
        ),
        Refusal::Obstacle(_) => word("move the arm, then engage again", "move the arm, then engage again"),
        Refusal::EndoscopeUnseen => word(
            "clear the tracker's view of the endoscope and of the arm, then engage again",
            "clear the tracker's view of the endoscope and of the arm, then engage again",
        ),
        Refusal::DrivesOff => word(
            "look at the arm's and the handle's own lamps and buttons, then engage again",
            "look at the arm's and the handle's own lamps and buttons, then engage again",
        ),
        Refusal::Moving => {
            word("let the arm come to rest, then engage again", "let the arm come to rest, then engage again")
        }
        Refusal::HandAbsent => word("hold the handle, then engage again", "hold the handle, then engage again"),
        Refusal::ClutchPressed => {
            word("release the clutch, then engage again", "release the clutch, then engage again")
        }
        Refusal::NotChecked => {
            word("press Ready check in the panel Calibration", "press Ready check in the panel Calibration")
        }
        Refusal::OutOfRange => word("choose a value within the range", "choose a value within the range"),
        Refusal::DelayIsMeasured => {
            word("see the link for what the network takes", "see the link for what the network takes")
        }
        Refusal::SimulatedOnly => word("choose a simulated rig", "choose a simulated rig"),
        Refusal::NoSuchArm => word("choose another arm", "choose another arm"),
    }
}

fn in_state(state: LoopState) -> &'static str {
    match state {
        LoopState::Disconnected => word("a device is missing", "a device is missing"),
        LoopState::Idle => word("nothing is engaged or stopped", "nothing is engaged or stopped"),
        LoopState::Ready => word("an engagement has already begun", "an engagement has already begun"),
        LoopState::Engaged | LoopState::Clutched => word("it is already engaged", "it is already engaged"),
        LoopState::Stopped => word("the stop is latched", "the stop is latched"),
        LoopState::Faulted(_) => word("a fault is latched", "a fault is latched"),
    }
}

/// The same text with a lower-case first letter, for use within a sentence.
fn lower(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or_else(String::new, |first| first.to_lowercase().chain(letters).collect())
}

/// The refusals whose words depend on nothing else.
pub(super) const REFUSALS: [Refusal; 11] = [
    Refusal::ForceUnknown,
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

#[cfg(test)]
mod tests {
    use nima_machine::rig::Exchange;

    use super::*;

    #[test]
    fn no_two_refusals_say_the_same() {
        let fault = Fault::SourceSilent;
        let more = [
            Refusal::State(LoopState::Stopped),
            Refusal::State(LoopState::Faulted(fault)),
            Refusal::State(LoopState::Disconnected),
            Refusal::State(LoopState::Engaged),
            Refusal::StillPresent(fault),
            Refusal::Obstacle(Obstacle::Exchanged(Exchange::Arms)),
        ];
        let all = REFUSALS.into_iter().chain(more);
        let mut told: Vec<_> = all.map(|why| (refused_because(why), cure_of_refusal(why))).collect();
        told.sort();
        told.dedup();
        assert_eq!(told.len(), REFUSALS.len() + more.len(), "{told:?}");
        assert!(told.iter().all(|(cause, cure)| !cause.ends_with('.') && !cure.ends_with('.')), "{told:?}");
    }
}
