//! Recorded sessions.
//!
//! | module | holds |
//! |---|---|
//! | `codec` | values of the loop as words, exact to the bit |
//! | `digest` | what a replay compares |
//! | `journal` | the messages from which the loop is replayed |
//! | `scribe` | what passes the tap of a loop, as these messages |
//! | `recorder` | the thread that writes them, and what is plotted, into a session file |
//! | `layouts` | what a viewer shows of a session at first |
//! | `objects` | where the rings of a scene are, what its jaws do, and what happens to them |
//! | `pictures` | the endoscope's pictures, as they came |
//! | `outlet` | where that goes: into the file, and to those who watch while it happens |
//! | `file` | the journal in a session file |
//! | `plotted` | the plots of a session file, tick by tick, and what `nima identify` needs of them |
//! | `cut` | a stretch of a session as a session file of its own |
//! | `anonymous` | a session without what tells who recorded it, where and when |
//! | `shelf` | the folder of a user's sessions: which are kept, and room for the next |
//! | `outlook` | how long the disk has room for a session |
//! | `report` | the figures of a session, from what is plotted of it |
//! | `watched` | what a screen elsewhere is told of a loop while it runs |
//! | `copied` | the file of a session, written elsewhere while it happens |
//! | `replay` | the same loop, fed from them; and with one thing changed |

pub mod anonymous;
mod codec;
pub mod copied;
pub mod cut;
pub mod digest;
pub mod file;
pub mod journal;
mod kept;
pub mod layouts;
mod logged;
pub mod objects;
pub mod outlet;
pub mod outlook;
pub mod pictures;
pub mod plotted;
pub mod recorder;
pub mod replay;
pub mod report;
pub mod scribe;
pub mod shelf;
mod topics;
pub mod watched;

pub use logged::Logged;
pub use topics::{STATES, Words};
