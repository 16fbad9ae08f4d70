//! The objects of training scenes: rings on pegs, rigid bodies that the jaws of two instruments hold by friction; and a
//! bent wire, along which a loop is led.
//!
//! [`Objects`] and [`Wire`] take the poses of two [`Instrument`]s and return their [`Loads`] (N and N m), once for each
//! tick of the control loop. [`Watch`] detects the events of the rings, in the terms of `nima_score`; [`PegTransfer`]
//! detects the end of the task; [`WireTask`] does both for a wire. Independent of loop, devices, files, threads and
//! clocks. `docs/scenes.md` has the laws and the measurements.
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

pub use instrument::{Instrument, Loads, OPENING_MOST_RAD, Touching};
pub use objects::{Doing, Objects, RingState};
pub use peg_transfer::PegTransfer;
pub use setting::{Board, Contact, Friction, Jaws, Pegs, RINGS_MAX, Setting, SettingError, Shape, Start, View};
pub use watch::Watch;
pub use wire::{Curve, Hoop, Wire, WireContact, WireSetting, WireState, WireTask};
