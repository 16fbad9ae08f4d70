//! State that the two machines of a teleoperation over a network exchange.

use nima_core::impedance::{IdentificationReport, LinkPacket, Mode};

use super::{Fault, ForceSource, LoopState};
use crate::rig::Side;

/// State of a pair that is sent to the other machine after a tick.
#[derive(Clone, Copy, Debug)]
pub struct PeerStatus<'a> {
    pub side: Side,
    pub state: LoopState,
    pub mode: Mode,
    pub compares: bool,
    /// Delay over which the force is rendered, s.
    pub delay_s: f64,
    /// Number of times that the operator has released a stop here; wraps from 255 to 0.
    pub releases: u8,
    pub source: ForceSource,
    /// Packet identified from the newest sample.
    pub parcel: &'a LinkPacket,
    pub report: &'a IdentificationReport,
}

/// Reason why the machine at the other end of the network is stopped: its fault without the details, which its own
/// screen shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FarStop {
    /// The operator stopped the pair.
    Stopped,
    SourceSilent,
    LoopStalled,
    ForceUnknown,
    DeviceLost,
    DrivesOff,
    SamplesLost,
    LinkSilent,
    ClockJumped,
    Implausible,
    /// Other arm has a fault, or the other machine of that arm does.
    Other,
}

impl FarStop {
    /// Every reason; its index is its number in the protocol.
    pub const ALL: [Self; 11] = [
        Self::Stopped,
        Self::SourceSilent,
        Self::LoopStalled,
        Self::ForceUnknown,
        Self::DeviceLost,
        Self::DrivesOff,
        Self::SamplesLost,
        Self::LinkSilent,
        Self::ClockJumped,
        Self::Implausible,
        Self::Other,
    ];

    /// Returns the reason why a machine in this state is stopped; `None` if it is not stopped.
    pub const fn of(state: LoopState) -> Option<Self> {
        let LoopState::Faulted(fault) = state else {
            return if matches!(state, LoopState::Stopped) { Some(Self::Stopped) } else { None };
        };
        Some(match fault {
            Fault::SourceSilent => Self::SourceSilent,
            Fault::LoopStalled { .. } => Self::LoopStalled,
            Fault::ForceUnknown { .. } => Self::ForceUnknown,
            Fault::DeviceLost { .. } => Self::DeviceLost,
            Fault::DrivesOff => Self::DrivesOff,
            Fault::SamplesLost => Self::SamplesLost,
            Fault::LinkSilent => Self::LinkSilent,
            Fault::ClockJumped => Self::ClockJumped,
            Fault::Implausible { .. } => Self::Implausible,
            Fault::OtherArm | Fault::FarEnd { .. } => Self::Other,
        })
    }
}
