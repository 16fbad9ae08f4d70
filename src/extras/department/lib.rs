//! The rigs of a department: their identities, their watchers, and their published data.
//!
//! Everything other than the stream of the loop: finding rigs, any number of display-only screens, and recordings on
//! another machine. The transport is zenoh over TLS with a certificate on both sides. A rig accepts connections
//! and publishes; a watcher can only subscribe and query, so that nothing from outside reaches the loop. All of it runs
//! on the recorder's thread and on zenoh's; data that they cannot send in time are dropped.
//!
//! | module | holds |
//! |---|---|
//! | `extra` | what it adds to the console: commands, and the option `--share` |
//! | `arguments`, `commands` | `nima department` |
//! | `identity` | certificates: the department, its rigs and its watchers |
//! | `config` | zenoh's configuration and permissions at each end |
//! | `keys` | the names under which a rig publishes |
//! | `feed` | published data, from the rig's recorder |
//! | `retention` | the last minutes of its session, for watchers that join late |
//! | `shared_rig` | publishing side, on the rig |
//! | `watch` | receiving side: discovery of rigs, their screens |
//! | `record` | records a rig's session on another machine |

mod arguments;
mod commands;
mod config;
mod error;
mod extra;
mod feed;
pub mod identity;
mod keys;
mod record;
mod retention;
mod shared_rig;
mod watch;

#[cfg(test)]
mod peers_tests;

pub use error::DepartmentError;
pub use extra::Department;
pub use identity::{Authority, MachineIdentity, MachineRole};
pub use record::{RecordStep, RigRecording};
pub use shared_rig::SharedRig;
pub use watch::{FoundRig, RemoteRig, RigInfo, RigWatcher, find, find_at};
