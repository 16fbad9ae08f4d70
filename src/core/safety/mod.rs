//! Between every model and the hand: a fixed chain of gates that no force bypasses.
//!
//! Takes the force (N) that a mode requests, its age (s), the hand's speed (m/s) and position (m); returns a force that
//! is finite, recent, permitted, passive and bounded, and reports which gates acted, why, and how often. One file per
//! gate; [`Chain`] defines their order. Bad input (NaN, infinite, too old) gives zero, never a panic. Uses no devices,
//! files or threads.

mod age;
mod ceiling;
mod chain;
mod dead_band;
mod energy;
mod gain;
mod governor;
mod interlock;
mod plausibility;
mod report;
mod settings;
mod slew;
mod validity;

pub use age::Age;
pub use ceiling::Ceiling;
pub use chain::{Chain, GripperChain, Request, TorqueChain};
pub use dead_band::DeadBand;
pub use energy::{ALLOWANCE_J, Energy, LEAK_S, MOST_J};
pub use gain::Gain;
pub use governor::{Governed, Governor, Handle, Reading};
pub use interlock::{Change, Interlock, Permits, READY_WITHIN_S, Refused, Seen, State, Why, Wish};
pub use plausibility::{
    ARM_CHANNELS, Admitted, CHANNELS, Fall, HANDLE_CHANNELS, Implausible, Leap, Observed, Opposed, Plausibility, Raw,
    RawReadings, Release,
};
pub use report::{GATES, Gate, GateCounts, GateReport, Reason};
pub use settings::{ChainSettings, EnergyMode};
pub use slew::Slew;
pub use validity::{PLAUSIBLE_N, admitted};
