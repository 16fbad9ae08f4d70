//! What the two machines of a teleoperation over a network have to know of each other.

use nima_core::impedance::{Mode, Parcel, Report};

use super::{Fault, ForceSource, LoopState};
use crate::rig::Side;

/// What a pair tells the other machine after a tick.
#[derive(Clone, Copy, Debug)]
pub struct Bulletin<'a> {
    /// Its side.
    pub side: Side,
    /// Its state.
    pub state: LoopState,
    /// The mode that is rendered.
    pub mode: Mode,
    /// Every mode is computed beside it.
    pub compares: bool,
    /// Delay over which the force is rendered, s.
    pub delay_s: f64,
    /// How often the operator has released a stop here; counts on from 255 to 0.
    pub releases: u8,
    /// Where the tip force comes from.
    pub source: ForceSource,
    /// What was identified from the newest sample.
    pub parcel: &'a Parcel,
    /// What is known of the identification.
    pub report: &'a Report,
}

/// Why the machine at the other end of the network is stopped: its fault without the details, which its own screen shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FarStop {
    /// Somebody stopped it there.
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
    /// Its other arm has a fault, or the other machine of this one does.
    Other,
}

impl FarStop {
    /// Each of them; its index is its number on the wire.
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

    /// Why a machine in this state is stopped; `None` if it is not.
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
