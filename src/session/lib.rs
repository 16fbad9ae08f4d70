//! Recorded sessions.
//!
//! | module | holds |
//! |---|---|
//! | `codec` | values of the loop as 64-bit words, exact to the bit |
//! | `digest` | digests of the values that a replay compares |
//! | `journal` | the messages from which the loop is replayed |
//! | `journal_writer` | converts the events at the tap of a loop to these messages |
//! | `recorder` | the thread that writes these messages and the plots into a session file |
//! | `layouts` | initial layouts of a session for external viewers |
//! | `objects` | positions of the rings of a scene, state of its jaws, and their events |
//! | `images` | endoscope images, stored as received |
//! | `sinks` | outputs of the recorder: the file, and live viewers |
//! | `file` | the journal in a session file |
//! | `plot_channels` | the plots of a session file, tick by tick, and the part that `nima identify` needs |
//! | `recording_kind` | whether a recording is a session, a table, or another program's |
//! | `trim` | copies a time range of a session into a new session file |
//! | `anonymous` | removes from a session who recorded it, where and when |
//! | `session_store` | the folder of a user's sessions: which are kept, and space for the next |
//! | `disk_forecast` | how long the free disk space lasts for a session |
//! | `report` | figures of a session, computed from its plots |
//! | `monitor_stream` | state of a running loop for remote screens |
//! | `remote_copy` | the file of a session, written on another machine while it is recorded |
//! | `replay` | replays the loop from its messages, unchanged or with one change |

pub mod anonymous;
mod calibration_metadata;
mod codec;
pub mod completeness;
pub mod digest;
pub mod disk_forecast;
pub mod file;
pub mod images;
pub mod journal;
pub mod journal_writer;
pub mod layouts;
mod logged;
pub mod monitor_stream;
pub mod objects;
pub mod plot_channels;
pub mod recorder;
mod recording_kind;
pub mod remote_copy;
pub mod replay;
pub mod report;
pub mod session_store;
pub mod sinks;
mod topics;
pub mod trim;

pub use logged::LogValue;
pub use recording_kind::{OpenSignalsError, RecordingKind, open_signals};
pub use topics::{STATES, SentenceChannel};
