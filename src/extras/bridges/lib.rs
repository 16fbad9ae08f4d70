//! Bridges: what a loop does, told to the programs that laboratories use, while it happens. They only tell; nothing that they hear reaches the loop.
//!
//! | module | holds |
//! |---|---|
//! | [`igtl`] | `OpenIGTLink` (3D Slicer, PLUS, pyigtl): codec and server |
//! | `lsl` | Lab Streaming Layer: marks of what happened |
//!
//! A bridge is an `Audience` of the session's recorder, as the live viewers are. On the recorder's thread it only
//! copies what is due into a bounded queue and never waits; threads of its own do the rest. What each of them sends, under which names and
//! in which units, is in `docs/bridges.md`.

pub mod igtl;
#[cfg(feature = "loop")]
pub mod lsl;
