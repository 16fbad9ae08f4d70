//! NDI's optical and electromagnetic trackers (Polaris Spectra, Vicra, Vega; Aurora) through their Combined API.
//!
//! Over a network (TCP 8765) or a serial line. The protocol uses mm; readings are in m, in the camera's frame `c`,
//! orientations `c_from_tool`, scalar first. Definition files (`.rom`) describe the tools; up to four are tracked. A
//! reading is new if its frame number is. Errors while opening are [`DeviceError`](super::DeviceError); for errors while
//! running, see [`NdiDriver`]. The codecs accept any bytes and refuse unknown data.
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
pub mod text;
pub mod tracking;
mod version;

#[cfg(test)]
mod codec_tests;

pub use command::{
    CHUNK, COMMAND_MAX, CommandLine, Filter, NdiCommand, NdiPriority, OUTSIDE_TOO, ReplyForm, STRAYS, TRANSFORMS,
    WIRELESS,
};
pub use crc::crc16;
pub use definition::{DEFINITION, NdiDefinition};
pub use driver::{DAMAGED_MAX, NdiDriver, RESTARTED, SILENT_S, SYSTEM_FAULT};
pub use reply::{ExpectedReply, Inbox, NdiArrival, REPLY_MAX, block_of, finish_line};
pub use settings::{NdiSettings, PORT, Replies};
pub use text::{ErrorCode, PortStatus, SystemStatus};
pub use tracking::{HANDLES_MAX, HandleFrame, MalformedReply, ToolVisibility, TrackingReply, Transform};
pub use version::{form_of, identity_of};
