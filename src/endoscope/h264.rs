//! H.264 as sent by cameras: frames as "access units" of NAL units after start codes (ITU-T H.264, annex B). Decoder
//! and encoder are Cisco's (feature `h264`); without the feature both return an error.

#[cfg(not(feature = "h264"))]
mod absent;
#[cfg(feature = "h264")]
mod engine;
#[cfg(feature = "h264")]
#[cfg(test)]
mod tests;
mod units;

#[cfg(not(feature = "h264"))]
pub use absent::{Decoder, Encoder};
#[cfg(feature = "h264")]
pub use engine::{Decoder, Encoder};
pub(crate) use units::Splitter;
pub use units::{is_key, kind, nal_units};

use crate::Picture;

/// Whether this program can decode and encode H.264.
pub const IS_BUILT: bool = cfg!(feature = "h264");
/// Message of a program without the feature.
#[cfg(not(feature = "h264"))]
const ABSENT: &str =
    "this program was built without H.264: use `cargo build --release --locked -p nima-console --features h264`";

/// A decoded frame.
#[derive(Debug)]
pub struct Taken {
    /// Its pixels, if requested.
    pub picture: Option<Picture>,
    /// Equal for equal images.
    pub hash: u64,
}
