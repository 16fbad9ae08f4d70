//! Recorded sessions.
//!
//! | module | holds |
//! |---|---|
//! | `codec` | values of the loop as words, exact to the bit |
//! | `digest` | what a replay compares |
//! | `journal` | the messages from which the loop is replayed |
//! | `scribe` | what passes the tap of a loop, as these messages |
//! | `replay` | the same loop, fed from them; and with one thing changed |
#![warn(missing_docs)]

mod codec;
pub mod digest;
pub mod journal;
pub mod recorder;
pub mod replay;
pub mod scribe;
