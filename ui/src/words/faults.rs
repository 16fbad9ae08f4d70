//! Texts: the cause of each fault, and what the operator can do.

use nima_core::safety::{Implausible, State};
use nima_devices::Loss;
use nima_machine::messages::{FarStop, Fault, LoopState};

use super::Remedy;
use crate::language::word;

/// What is wrong in a state, and what to do, beside a code for another program; nothing in a state in which all is well.
pub(crate) fn trouble_of(state: LoopState) -> String {
    match state {
        State::Faulted(fault) => format!("{}. {}", fault.cause(), fault.cure()),
        State::Stopped => {
            word("Stopped. Release the stop, then engage again", "Stopped. Release the stop, then engage again")
                .to_owned()
        }
        State::Disconnected => word(
            "A device is missing or sends nothing. See Devices",
            "A device is missing or sends nothing. See Devices",
        )
        .to_owned(),
        State::Idle | State::Ready | State::Engaged | State::Clutched => String::new(),
    }
}

impl Remedy for Fault {
    fn cause(self) -> &'static str {
        match self {
            Self::SourceSilent => word("The rig sent no valid data for 20 ms", "The rig sent no valid data for 20 ms"),
            Self::LoopStalled { .. } => word(
                "The control loop was blocked: drives and force were switched off",
                "The control loop was blocked: drives and force were switched off",
            ),
            Self::ForceUnknown => word(
                "The force at the tip is not known: the wrist sensor is not calibrated for this tool",
                "The force at the tip is not known: the wrist sensor is not calibrated for this tool",
            ),
            Self::DeviceLost { loss, .. } => match loss {
                Loss::Disconnected => {
                    word("A device was lost: its connection is gone", "A device was lost: its connection is gone")
                }
                Loss::Silent => word("A device was lost: it sends no data", "A device was lost: it sends no data"),
                Loss::Corrupt => {
                    word("A device was lost: its data are damaged", "A device was lost: its data are damaged")
                }
                Loss::Implausible => word(
                    "A device was lost: it sends impossible values",
                    "A device was lost: it sends impossible values",
                ),
                Loss::Device { .. } => {
                    word("A device was lost: it reports a fault", "A device was lost: it reports a fault")
                }
            },
            Self::DrivesOff => word(
                "The arm does not follow its commands, or the handle has switched its motors off",
                "The arm does not follow its commands, or the handle has switched its motors off",
            ),
            Self::OtherArm => word("The other arm has a fault", "The other arm has a fault"),
            Self::SamplesLost => word(
                "Too many samples of the rig are lost or damaged",
                "Too many samples of the rig are lost or damaged",
            ),
            Self::LinkSilent => word("No data came over the link for 0.1 s", "No data came over the link for 0.1 s"),
            Self::ClockJumped => word(
                "The clock of the control loop jumped or stopped",
                "The clock of the control loop jumped or stopped",
            ),
            Self::Implausible { what } => what.cause(),
            Self::FarEnd { stop } => stop.cause(),
        }
    }

    fn cure(self) -> &'static str {
        match self {
            Self::SourceSilent => word(
                "Check the force sensor and the handle, then release the stop and engage again",
                "Check the force sensor and the handle, then release the stop and engage again",
            ),
            Self::LoopStalled { .. } => word(
                "Close other programs or grant real-time priority, then release the stop and engage again",
                "Close other programs or grant real-time priority, then release the stop and engage again",
            ),
            Self::ForceUnknown => word(
                "Calibrate gravity (Calibration panel), then release the stop and engage again",
                "Calibrate gravity (Calibration panel), then release the stop and engage again",
            ),
            Self::DeviceLost { .. } => word(
                "See Devices: the device reconnects automatically; then release the stop and engage again",
                "See Devices: the device reconnects automatically; then release the stop and engage again",
            ),
            Self::DrivesOff => word(
                "Check the lights and buttons on the arm and on the handle, then release the stop and engage again",
                "Check the lights and buttons on the arm and on the handle, then release the stop and engage again",
            ),
            Self::OtherArm => word(
                "Clear the other arm's fault, then release the stop and engage again",
                "Clear the other arm's fault, then release the stop and engage again",
            ),
            Self::SamplesLost => word(
                "Check the numbers of lost samples in Devices, and the cables; then release the stop and engage again",
                "Check the numbers of lost samples in Devices, and the cables; then release the stop and engage again",
            ),
            Self::LinkSilent => word(
                "Check the link to the follower, then release the stop and engage again",
                "Check the link to the follower, then release the stop and engage again",
            ),
            Self::ClockJumped => word(
                "Find out what changes this computer's clock, then release the stop and engage again",
                "Find out what changes this computer's clock, then release the stop and engage again",
            ),
            Self::Implausible { what } => what.cure(),
            Self::FarEnd { stop } => stop.cure(),
        }
    }
}

impl Remedy for FarStop {
    fn cause(self) -> &'static str {
        match self {
            Self::Stopped => word("Somebody stopped the follower's machine", "Somebody stopped the follower's machine"),
            Self::SourceSilent => word(
                "The follower's machine gets no data, from its devices or from here",
                "The follower's machine gets no data, from its devices or from here",
            ),
            Self::LoopStalled => word(
                "The control loop of the follower's machine was blocked",
                "The control loop of the follower's machine was blocked",
            ),
            Self::ForceUnknown => word(
                "The follower's machine does not know the force at the tip",
                "The follower's machine does not know the force at the tip",
            ),
            Self::DeviceLost => {
                word("A device of the follower's machine was lost", "A device of the follower's machine was lost")
            }
            Self::DrivesOff => word(
                "The arm at the follower's machine does not follow its commands",
                "The arm at the follower's machine does not follow its commands",
            ),
            Self::SamplesLost => word(
                "The follower's machine loses too many samples of its devices, or of what is sent from here",
                "The follower's machine loses too many samples of its devices, or of what is sent from here",
            ),
            Self::LinkSilent => word(
                "No data came over a link within the follower's machine",
                "No data came over a link within the follower's machine",
            ),
            Self::ClockJumped => word(
                "The clock of the follower's machine jumped or stopped",
                "The clock of the follower's machine jumped or stopped",
            ),
            Self::Implausible => word(
                "A measurement at the follower's machine is not plausible",
                "A measurement at the follower's machine is not plausible",
            ),
            Self::Other => word(
                "The other arm of the follower's machine has a fault",
                "The other arm of the follower's machine has a fault",
            ),
        }
    }

    fn cure(self) -> &'static str {
        match self {
            Self::Stopped => word(
                "Ask there whether it is safe, then release the stop and engage again",
                "Ask there whether it is safe, then release the stop and engage again",
            ),
            _ => word(
                "See the screen or the output of the follower's machine for the cause; then release the stop and \
                 engage again",
                "See the screen or the output of the follower's machine for the cause; then release the stop and \
                 engage again",
            ),
        }
    }
}

impl Remedy for Implausible {
    fn cause(self) -> &'static str {
        match self {
            Self::ForceFrozen => word(
                "The force sensor repeats one reading, or is at the end of its range",
                "The force sensor repeats one reading, or is at the end of its range",
            ),
            Self::ForceJumped => word(
                "The measured force jumped by more than any contact can cause",
                "The measured force jumped by more than any contact can cause",
            ),
            Self::ForceAlong => word(
                "The measured force pulls the tip into the tissue: its sign or its frame is wrong",
                "The measured force pulls the tip into the tissue: its sign or its frame is wrong",
            ),
            Self::LinkFrozen => word(
                "The link repeats one message with new time stamps",
                "The link repeats one message with new time stamps",
            ),
            Self::HandleJumped => word(
                "The handle's position jumped by more than a hand can move it",
                "The handle's position jumped by more than a hand can move it",
            ),
            Self::HandleFrozen => word(
                "The handle's position does not change although its force does",
                "The handle's position does not change although its force does",
            ),
            Self::TipJumped => word(
                "The arm's position jumped by more than the arm can move",
                "The arm's position jumped by more than the arm can move",
            ),
            Self::ArmAstray => word("The arm does not follow its command", "The arm does not follow its command"),
        }
    }

    fn cure(self) -> &'static str {
        match self {
            Self::ForceFrozen => word(
                "Unload the force sensor, or switch it off and on again; then release the stop and engage again",
                "Unload the force sensor, or switch it off and on again; then release the stop and engage again",
            ),
            Self::ForceJumped => word(
                "Check whether something hit the instrument, and check the sensor's plug and zero; then release the \
                 stop and engage again",
                "Check whether something hit the instrument, and check the sensor's plug and zero; then release the \
                 stop and engage again",
            ),
            Self::ForceAlong => word(
                "Calibrate gravity and the correspondence of the force sensor again, then release the stop and engage \
                 again",
                "Calibrate gravity and the correspondence of the force sensor again, then release the stop and engage \
                 again",
            ),
            Self::LinkFrozen => word(
                "Check the follower's computer and the link, then release the stop and engage again",
                "Check the follower's computer and the link, then release the stop and engage again",
            ),
            Self::HandleJumped | Self::HandleFrozen => word(
                "Put the handle in its rest position and calibrate it (button on the device), then release the stop \
                 and engage again",
                "Put the handle in its rest position and calibrate it (button on the device), then release the stop \
                 and engage again",
            ),
            Self::TipJumped => word(
                "Check the arm's connection and its joint readings, then release the stop and engage again",
                "Check the arm's connection and its joint readings, then release the stop and engage again",
            ),
            Self::ArmAstray => word(
                "Check what blocks the arm, its lights and its reach; then release the stop and engage again",
                "Check what blocks the arm, its lights and its reach; then release the stop and engage again",
            ),
        }
    }
}
