//! The objects of training scenes: rings on pegs, rigid bodies that the jaws of two instruments hold by friction; and a
//! bent wire, along which a loop is guided.
//!
//! [`Objects`] and [`Wire`] take where two [`Instrument`]s are and return what acts on them ([`InstrumentLoads`], N and
//! N m), once for each tick of the control loop. [`RingWatch`] derives events from the rings, in the terms of
//! `nima_score`; [`PegTransfer`] whether the task is done; [`WireTask`] both of a wire. This crate uses no loop,
//! device, file, thread or clock. `docs/scenes.md` has the scenes, `docs/simulated.md` the laws.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod contact;
mod geometry;
mod instrument;
mod objects;
mod peg_transfer;
mod ring;
mod setting;
#[cfg(test)]
mod tests;
mod tool;
mod watch;
mod wire;

pub use instrument::{Instrument, InstrumentContacts, InstrumentLoads, OPENING_MAX_RAD};
pub use objects::{Objects, RingActivity, RingState};
pub use peg_transfer::PegTransfer;
pub use setting::{
    BoardSettings, ContactSettings, Friction, JawSettings, ObjectSettings, Pegs, RINGS_MAX, RingShape, RingStart,
    SettingError, ViewBox,
};
pub use watch::RingWatch;
pub use wire::{LoopGeometry, SmoothCurve, Wire, WireContact, WireSetting, WireState, WireTask};
