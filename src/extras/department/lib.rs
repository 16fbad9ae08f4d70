//! The rigs of a department: who they are, who may watch them, and what they show.
//!
//! Everything that is not the stream of the loop: finding rigs, any number of screens that only show, and recordings on another machine.
//! The transport is zenoh over TLS with a certificate on both sides. A rig listens and publishes; who watches can subscribe and ask, and
//! nothing else, so that nothing from outside reaches the loop. All of it runs on the recorder's thread and on zenoh's; what they cannot
//! send in time is dropped.
//!
//! | module | holds |
//! |---|---|
//! | `identity` | certificates: the department, its rigs and its watchers |
//! | `config` | what zenoh may do at each end |
//! | `keys` | the names under which a rig publishes |
//! | `feed` | what a rig publishes, from its recorder |
//! | `kept` | the last minutes of its session, for those who come late |
//! | `share` | the rig's end |
//! | `watch` | the other end: finding rigs, their screens |
//! | `record` | a rig's session in a file elsewhere |
#![cfg(feature = "engine")]

mod config;
mod error;
mod feed;
pub mod identity;
mod kept;
mod keys;
mod record;
mod share;
mod watch;

#[cfg(test)]
mod tests;

pub use error::DepartmentError;
pub use identity::{Authority, Identity, Role};
pub use record::{Recording, Step};
pub use share::Share;
pub use watch::{About, Found, Rig, Watching, find, find_at};
