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
pub use absent::{H264Decoder, H264Encoder};
#[cfg(feature = "h264")]
pub use engine::{H264Decoder, H264Encoder};
pub(crate) use units::H264Splitter;
pub use units::{is_key, kind, nal_units};

use crate::DecodedImage;

/// Whether this program can decode and encode H.264.
pub const IS_BUILT: bool = cfg!(feature = "h264");
/// Message of a program without the feature.
#[cfg(not(feature = "h264"))]
const ABSENT: &str =
    "this program was built without H.264: use `cargo build --release --locked -p nima-console --features h264`";

/// A decoded frame.
#[derive(Debug)]
pub struct H264Image {
    /// Pixels, if requested.
    pub image: Option<DecodedImage>,
    /// Equal for equal images.
    pub hash: u64,
}
