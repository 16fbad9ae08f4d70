//! NDI's optical and electromagnetic trackers (Polaris Spectra, Vicra, Vega; Aurora) by their Combined API.
//!
//! Over a network (TCP 8765) or a serial line. The wire speaks mm; readings are in m, in the camera's frame `c`, orientations
//! `c_from_tool`, scalar first. Which tools there are is told by definition files (`.rom`); up to four are read. A frame number
//! makes a reading new. Errors while opening are [`Trouble`](super::Trouble); while running, see [`Driver`]. Any bytes on the wire are
//! survived: the codecs refuse what they do not know.
//!
//! Source of the wire's facts: NDI's Combined API as its open clients show it; nothing here was tried on a real unit.

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
