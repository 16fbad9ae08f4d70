//! Recorded sessions.
//!
//! | module | holds |
//! |---|---|
//! | `codec` | values of the loop as words, exact to the bit |
//! | `digest` | what a replay compares |
//! | `journal` | the messages from which the loop is replayed |
#![warn(missing_docs)]

mod codec;
pub mod digest;
pub mod journal;
