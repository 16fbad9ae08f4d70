//! Texts: why a command was refused, and what the operator can do.

use nima_machine::{
    messages::{Fault, LoopState, Refusal},
    rig::Obstacle,
};

use super::Remedy as _;

/// The reason, a clause without a full stop.
pub(crate) fn refused_because(why: Refusal) -> String {
    match why {
        Refusal::State(state) => in_state(state).to_owned(),
        Refusal::StillPresent(fault) => format!("the cause of a fault is still present: {}", lower(fault.cause())),
        Refusal::ForceUnknown => "the force at the tip is not known".to_owned(),
        Refusal::Implausible(what) => format!("a measurement is not plausible: {}", lower(what.cause())),
        Refusal::Obstacle(waiting @ Obstacle::Waiting(_)) => waiting.to_string(),
        Refusal::Obstacle(obstacle @ Obstacle::FarEnd) => obstacle.to_string(),
        Refusal::Obstacle(Obstacle::Exchanged(exchange)) => exchange.words().to_owned(),
        Refusal::Obstacle(obstacle) => format!("the arm cannot start from where it is: {obstacle}"),
        Refusal::EndoscopeUnseen => "the tracker does not see the endoscope".to_owned(),
        Refusal::DrivesOff => "the drives did not obey in time".to_owned(),
        Refusal::Moving => "the arm was not at rest".to_owned(),
        Refusal::HandAbsent => "nobody holds the handle".to_owned(),
        Refusal::ClutchPressed => "the clutch is pressed".to_owned(),
        Refusal::NotChecked => "this rig requires a ready check, and none of the last 12 hours has passed".to_owned(),
        Refusal::OutOfRange => "the value is outside its range".to_owned(),
        Refusal::DelayIsMeasured => "the delay is that of the network, which is measured and not set".to_owned(),
        Refusal::SimulatedOnly => "a person may hold the handle of this rig".to_owned(),
        Refusal::NoSuchArm => "this rig has no arm on that side".to_owned(),
    }
}

/// What the operator can do, a clause without a full stop.
pub(crate) const fn cure_of_refusal(why: Refusal) -> &'static str {
    match why {
        Refusal::State(LoopState::Stopped) => "release the stop first",
        Refusal::State(LoopState::Faulted(_)) => "remove its cause, then release the stop",
        Refusal::State(LoopState::Disconnected) => "see the devices for what is missing and why",
        Refusal::State(_) => "see the state of the loop",
        Refusal::StillPresent(Fault::FarEnd { .. }) => {
            "remove its cause there, then press Stop and Release stop here: that releases both machines"
        }
        Refusal::StillPresent(_) => "remove the cause first",
        Refusal::ForceUnknown => "calibrate gravity for this sensor and tool",
        Refusal::Implausible(_) => "see the sensor and its cable",
        Refusal::Obstacle(Obstacle::Exchanged(_)) => {
            "put what is exchanged back, in the room or in the rig file; the ready check tells which it is"
        }
        Refusal::Obstacle(Obstacle::Waiting(_)) => "wait a moment, clear the tracker's view, then engage again",
        Refusal::Obstacle(Obstacle::FarEnd) => "remove the reason at the follower's machine, then engage again",
        Refusal::Obstacle(_) => "move the arm, then engage again",
        Refusal::EndoscopeUnseen => "clear the tracker's view of the endoscope and of the arm, then engage again",
        Refusal::DrivesOff => "look at the arm's and the handle's own lamps and buttons, then engage again",
        Refusal::Moving => "let the arm come to rest, then engage again",
        Refusal::HandAbsent => "hold the handle, then engage again",
        Refusal::ClutchPressed => "release the clutch, then engage again",
        Refusal::NotChecked => "press Ready check in the panel Calibration",
        Refusal::OutOfRange => "choose a value within the range",
        Refusal::DelayIsMeasured => "see the link for what the network takes",
        Refusal::SimulatedOnly => "choose a simulated rig",
        Refusal::NoSuchArm => "choose another arm",
    }
}

const fn in_state(state: LoopState) -> &'static str {
    match state {
        LoopState::Disconnected => "a device is missing",
        LoopState::Idle => "nothing is engaged or stopped",
        LoopState::Ready => "an engagement has already begun",
        LoopState::Engaged | LoopState::Clutched => "it is already engaged",
        LoopState::Stopped => "the stop is latched",
        LoopState::Faulted(_) => "a fault is latched",
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
