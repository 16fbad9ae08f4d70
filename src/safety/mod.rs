//! Between every model and the hand: a fixed chain of gates. Nothing passes around it.
//!
//! Takes the force (N) a mode asks for, its age (s) and the hand's speed (m/s); gives a force that is finite, young,
//! wanted and bounded, and says which gates acted. Bad input (NaN, infinite, too old) gives zero, never a panic.
//! Knows no device, file or thread.

mod chain;
mod dead_band;
mod interlock;

pub use chain::{Chain, ChainSettings, GateReport, MAX_GAIN, Request};
pub use dead_band::DeadBand;
pub use interlock::{Change, Interlock, Permits, READY_WITHIN_S, Refused, Seen, State, Why, Wish};
