//! Texts: the cause of each fault, and what the operator can do.

use nima_core::safety::{Implausible, State};
use nima_devices::Loss;
use nima_machine::messages::{FarStop, Fault, LoopState};

use super::Remedy;

/// What is wrong in a state, and what to do, beside a code for another program; nothing in a state in which all is well.
pub(crate) fn trouble_of(state: LoopState) -> String {
    match state {
        State::Faulted(fault) => format!("{}. {}", fault.cause(), fault.cure()),
        State::Stopped => "Stopped. Release the stop, then engage again".to_owned(),
        State::Disconnected => "A device is missing or sends nothing. See Devices".to_owned(),
        State::Idle | State::Ready | State::Engaged | State::Clutched => String::new(),
    }
}

impl Remedy for Fault {
    fn cause(self) -> &'static str {
        match self {
            Self::SourceSilent => "The rig sent no valid data for 20 ms",
            Self::LoopStalled { .. } => "The control loop was blocked: drives and force were switched off",
            Self::ForceUnknown => "The force at the tip is not known: the wrist sensor is not calibrated for this tool",
            Self::DeviceLost { loss, .. } => match loss {
                Loss::Disconnected => "A device was lost: its connection is gone",
                Loss::Silent => "A device was lost: it sends no data",
                Loss::Corrupt => "A device was lost: its data are damaged",
                Loss::Implausible => "A device was lost: it sends impossible values",
                Loss::Device { .. } => "A device was lost: it reports a fault",
            },
            Self::DrivesOff => "The arm does not follow its commands, or the handle has switched its motors off",
            Self::OtherArm => "The other arm has a fault",
            Self::SamplesLost => "Too many samples of the rig are lost or damaged",
            Self::LinkSilent => "No data came over the link for 0.1 s",
            Self::ClockJumped => "The clock of the control loop jumped or stopped",
            Self::Implausible { what } => what.cause(),
            Self::FarEnd { stop } => stop.cause(),
        }
    }

    fn cure(self) -> &'static str {
        match self {
            Self::SourceSilent => "Check the force sensor and the handle, then release the stop and engage again",
            Self::LoopStalled { .. } => {
                "Close other programs or grant real-time priority, then release the stop and engage again"
            }
            Self::ForceUnknown => "Calibrate gravity (Calibration panel), then release the stop and engage again",
            Self::DeviceLost { .. } => {
                "See Devices: the device reconnects automatically; then release the stop and engage again"
            }
            Self::DrivesOff => {
                "Check the lights and buttons on the arm and on the handle, then release the stop and engage again"
            }
            Self::OtherArm => "Clear the other arm's fault, then release the stop and engage again",
            Self::SamplesLost => {
                "Check the numbers of lost samples in Devices, and the cables; then release the stop and engage again"
            }
            Self::LinkSilent => "Check the link to the follower, then release the stop and engage again",
            Self::ClockJumped => "Find out what changes this computer's clock, then release the stop and engage again",
            Self::Implausible { what } => what.cure(),
            Self::FarEnd { stop } => stop.cure(),
        }
    }
}

impl Remedy for FarStop {
    fn cause(self) -> &'static str {
        match self {
            Self::Stopped => "Somebody stopped the follower's machine",
            Self::SourceSilent => "The follower's machine gets no data, from its devices or from here",
            Self::LoopStalled => "The control loop of the follower's machine was blocked",
            Self::ForceUnknown => "The follower's machine does not know the force at the tip",
            Self::DeviceLost => "A device of the follower's machine was lost",
            Self::DrivesOff => "The arm at the follower's machine does not follow its commands",
            Self::SamplesLost => {
                "The follower's machine loses too many samples of its devices, or of what is sent from here"
            }
            Self::LinkSilent => "No data came over a link within the follower's machine",
            Self::ClockJumped => "The clock of the follower's machine jumped or stopped",
            Self::Implausible => "A measurement at the follower's machine is not plausible",
            Self::Other => "The other arm of the follower's machine has a fault",
        }
    }

    fn cure(self) -> &'static str {
        match self {
            Self::Stopped => "Ask there whether it is safe, then release the stop and engage again",
            _ => {
                "See the screen or the output of the follower's machine for the cause; then release the stop and engage again"
            }
        }
    }
}

impl Remedy for Implausible {
    fn cause(self) -> &'static str {
        match self {
            Self::ForceFrozen => "The force sensor repeats one reading, or is at the end of its range",
            Self::ForceJumped => "The measured force jumped by more than any contact can cause",
            Self::ForceAlong => "The measured force pulls the tip into the tissue: its sign or its frame is wrong",
            Self::LinkFrozen => "The link repeats one message with new time stamps",
            Self::HandleJumped => "The handle's position jumped by more than a hand can move it",
            Self::HandleFrozen => "The handle's position does not change although its force does",
            Self::TipJumped => "The arm's position jumped by more than the arm can move",
            Self::ArmAstray => "The arm does not follow its command",
        }
    }

    fn cure(self) -> &'static str {
        match self {
            Self::ForceFrozen => {
                "Unload the force sensor, or switch it off and on again; then release the stop and engage again"
            }
            Self::ForceJumped => {
                "Check whether something hit the instrument, and check the sensor's plug and zero; then release the stop and engage \
                 again"
            }
            Self::ForceAlong => {
                "Calibrate gravity and the correspondence of the force sensor again, then release the stop and engage again"
            }
            Self::LinkFrozen => "Check the follower's computer and the link, then release the stop and engage again",
            Self::HandleJumped | Self::HandleFrozen => {
                "Put the handle in its rest position and calibrate it (button on the device), then release the stop and engage again"
            }
            Self::TipJumped => {
                "Check the arm's connection and its joint readings, then release the stop and engage again"
            }
            Self::ArmAstray => {
                "Check what blocks the arm, its lights and its reach; then release the stop and engage again"
            }
        }
    }
}
