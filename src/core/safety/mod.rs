//! Between every model and the hand: a fixed chain of gates that no force bypasses.
//!
//! Takes the force (N) that a mode requests, its age (s), the hand's speed (m/s) and position (m); returns a force that
//! is finite, recent, permitted, passive and bounded, and reports which gates acted, why, and how often. One file per
//! gate; [`Chain`] defines their order. Bad input (NaN, infinite, too old) gives zero, never a panic. Uses no devices,
//! files or threads.

mod chain;
mod governor;
mod interlock;
mod plausibility;
mod report;
mod settings;

pub use chain::{
    ALLOWANCE_J, Age, Ceiling, Chain, DeadBand, Energy, Gain, GripperChain, LEAK_S, MOST_J, PLAUSIBLE_N, Request, Slew,
    TorqueChain, admitted,
};
pub use governor::{Governed, Governor, Handle, Reading};
pub use interlock::{Change, Interlock, Permits, READY_WITHIN_S, Refused, Seen, State, Why, Wish};
pub use plausibility::{
    ARM_CHANNELS, Admitted, CHANNELS, Fall, HANDLE_CHANNELS, Implausible, Leap, Observed, Opposed, Plausibility, Raw,
    RawReadings, Release,
};
pub use report::{GATES, Gate, GateCounts, GateReport, Reason};
pub use settings::{ChainSettings, EnergyMode};
