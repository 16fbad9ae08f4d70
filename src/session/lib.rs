//! Recorded sessions.
//!
//! | module | holds |
//! |---|---|
//! | `codec` | values of the loop as 64-bit words, exact to the bit |
//! | `digest` | digests of the values that a replay compares |
//! | `journal` | the messages from which the loop is replayed |
//! | `scribe` | converts the events at the tap of a loop to these messages |
//! | `recorder` | the thread that writes these messages and the plots into a session file |
//! | `layouts` | initial layouts of a session for external viewers |
//! | `objects` | positions of the rings of a scene, state of its jaws, and their events |
//! | `pictures` | endoscope images, stored as received |
//! | `outlet` | outputs of the recorder: the file, and live viewers |
//! | `file` | the journal in a session file |
//! | `plotted` | the plots of a session file, tick by tick, and the part that `nima identify` needs |
//! | `cut` | copies a time range of a session into a new session file |
//! | `anonymous` | removes from a session who recorded it, where and when |
//! | `shelf` | the folder of a user's sessions: which are kept, and space for the next |
//! | `outlook` | how long the free disk space lasts for a session |
//! | `report` | figures of a session, computed from its plots |
//! | `watched` | state of a running loop for remote screens |
//! | `copied` | the file of a session, written on another machine while it is recorded |
//! | `replay` | replays the loop from its messages, unchanged or with one change |

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
