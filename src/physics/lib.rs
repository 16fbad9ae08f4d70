//! The objects of a training scene that move as rigid bodies: rings on pegs, and the jaws of two instruments that hold them by friction.
//!
//! [`Objects`] takes where two [`Instrument`]s are and returns what acts on them ([`Loads`], N and N m), once for each tick of the control loop.
//! [`Watch`] tells from the rings what happens, in the words of `nima_score`; [`PegTransfer`] whether the task is done. This crate
//! knows no loop, device, file, thread or clock. `docs/scenes.md` has the laws and the figures.
#![warn(missing_docs)]
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

pub use instrument::{Instrument, Loads, OPENING_MOST_RAD, Touching};
pub use objects::{Doing, Objects, RingState};
pub use peg_transfer::PegTransfer;
pub use setting::{Board, Contact, Friction, Jaws, Pegs, Setting, SettingError, Shape, Start, View};
pub use watch::Watch;
