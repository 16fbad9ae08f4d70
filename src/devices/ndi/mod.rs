//! NDI's optical and electromagnetic trackers (Polaris Spectra, Vicra, Vega; Aurora) through their Combined API.
//!
//! Over a network (TCP 8765) or a serial line. The protocol uses mm; readings are in m, in the camera's frame `c`,
//! orientations `c_from_tool`, scalar first. Definition files (`.rom`) describe the tools; up to four are tracked. A
//! reading is new if its frame number is. Errors while opening are [`Trouble`](super::Trouble); for errors while
//! running, see [`Driver`]. The codecs accept any bytes and refuse unknown data.
//!
//! Source of the protocol: NDI's Combined API as implemented in its open-source clients. Not verified with a real unit.

pub mod command;
mod crc;
pub mod definition;
mod driver;
mod opening;
pub mod reply;
mod session;
mod settings;
pub mod tracking;
mod version;
pub mod words;

#[cfg(test)]
mod codec_tests;

pub use command::{
    CHUNK, COMMAND_MAX, Command, CommandLine, Filter, Form, OUTSIDE_TOO, Priority, STRAYS, TRANSFORMS, WIRELESS,
};
pub use crc::crc16;
pub use definition::{DEFINITION, Definition};
pub use driver::{DAMAGED_MAX, Driver, RESTARTED, SILENT_S, SYSTEM_FAULT};
pub use reply::{Arrival, Expected, Inbox, REPLY_MAX, block_of, finish_line};
pub use settings::{PORT, Replies, Settings};
pub use tracking::{Frames, HANDLES_MAX, HandleFrame, Malformed, Sight, Transform};
pub use version::{form_of, identity_of};
pub use words::{ErrorCode, PortStatus, SystemStatus};
