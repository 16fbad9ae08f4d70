//! The messages in a session that other programs can read: their bytes and their descriptions.
//!
//! Foxglove, `PlotJuggler` and Rerun show them without configuration. A [`JointState`](JointStateEncoder) is plotted by
//! the names in it, [`foxglove::FrameTransforms`] give the poses of frames, [`foxglove::Log`] is text with a level,
//! [`foxglove::SceneUpdate`] has arrows, and JSON has its own schema. The time in a message, like that of its record,
//! is the time of its sample.

pub mod foxglove;
mod joint_state;
mod joint_state_decoder;
mod json;

pub use joint_state::{JointStateEncoder, WrongLength};
pub use joint_state_decoder::JointStateDecoder;
pub use json::json_encoding;
