//! The messages in a session that other programs know: their bytes and their descriptions.
//!
//! Foxglove, `PlotJuggler` and Rerun show them with no set-up. A [`JointState`](JointStateEncoder) is plotted by the names in it,
//! [`foxglove::FrameTransforms`] place what stands where, [`foxglove::Log`] is text with a level, [`foxglove::SceneUpdate`] has
//! arrows, and JSON has its own schema. The time in a message is that of its sample, as the time of the record is.

pub mod foxglove;
mod joint_state;
mod joint_state_decoder;
mod json;

pub use joint_state::{JointStateEncoder, WrongLength};
pub use joint_state_decoder::JointStateDecoder;
pub use json::json_encoding;
