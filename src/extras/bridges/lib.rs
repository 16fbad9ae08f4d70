//! Bridges report the state of a running loop to other laboratory programs. They only send; received data never reach
//! the loop.
//!
//! | module | holds |
//! |---|---|
//! | [`igtl`] | `OpenIGTLink` (3D Slicer, PLUS, pyigtl): codec and server |
//! | `lsl` | Lab Streaming Layer: event markers |
//!
//! A bridge is an `Audience` of the session's recorder, like the live viewers. On the recorder's thread it only copies
//! due data into a bounded queue and never waits; its own threads do the rest. The data, names and units of each bridge
//! are in `docs/bridges.md`.

pub mod igtl;
#[cfg(feature = "loop")]
pub mod lsl;
