//! H.264 as cameras send it: pictures as "access units" of NAL units behind start codes (ITU-T H.264, annex B). Decoder and encoder are Cisco's
//! (feature `h264`); without them both say so.

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

/// This program can decode and encode H.264.
pub const IS_BUILT: bool = cfg!(feature = "h264");
/// What is said where it cannot.
#[cfg(not(feature = "h264"))]
const ABSENT: &str =
    "this program was built without H.264: use `cargo build --release --locked -p nima-console --features h264`";

/// A picture that was decoded.
#[derive(Debug)]
pub struct Taken {
    /// Its pixels, where somebody wants them.
    pub picture: Option<Picture>,
    /// The same for the same picture.
    pub hash: u64,
}
