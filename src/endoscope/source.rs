//! The interface of every image source.

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::Instant,
};

use crate::{Address, Damage, DecodedImage, EndoscopeError, RawLayout, files, http, jpeg};

/// One image as received, not decoded.
#[derive(Clone, Debug)]
pub struct CompressedFrame {
    pub format: Format,
    /// Bytes as sent by the camera.
    pub bytes: Vec<u8>,
    /// Arrival of its last byte.
    pub arrived: Instant,
    /// Time stamp of the camera, s, from an arbitrary origin; `None` if it sends none.
    pub stamp_s: Option<f64>,
    /// Time of exposure, if the camera uses this computer's clock.
    pub taken: Option<Instant>,
}

/// Format of an image's bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// A whole JPEG, if the camera sent one.
    Jpeg,
    /// Uncompressed.
    Raw(RawLayout),
    /// A frame of an H.264 stream (an access unit, annex B), which refers to earlier ones.
    H264 {
        /// Whether it refers to no other frame, so that a decoder can begin with it.
        is_key: bool,
    },
}

impl CompressedFrame {
    /// Creates a JPEG that arrived at this moment, with the camera's time stamp.
    pub(crate) const fn jpeg(bytes: Vec<u8>, arrived: Instant, stamp_s: Option<f64>) -> Self {
        Self { format: Format::Jpeg, bytes, arrived, stamp_s, taken: None }
    }

    /// Returns whether it can be decoded without earlier images.
    pub const fn stands_alone(&self) -> bool {
        !matches!(self.format, Format::H264 { .. })
    }

    /// Decodes an independent image on the calling thread.
    ///
    /// # Errors
    /// The fault of the image.
    pub fn decode(&self) -> Result<DecodedImage, Damage> {
        match self.format {
            Format::Jpeg => jpeg::decode(&self.bytes),
            Format::Raw(raw) => raw.image(&self.bytes),
            Format::H264 { .. } => Err(Damage::Undecodable { reason: "it depends on other images".to_owned() }),
        }
    }
}

/// Delivers a sequence of images. Runs on its own thread, which it may block until it is stopped.
pub trait ImageSource: Send {
    /// Returns the next image; `None` if none arrived within about 0.1 s.
    ///
    /// # Errors
    /// Why no more images will arrive: the source is then reopened.
    fn next(&mut self) -> Result<Option<CompressedFrame>, EndoscopeError>;

    /// Returns whether the source has only a single image, which may remain unchanged without a fault.
    fn is_still(&self) -> bool {
        false
    }
}

impl Address {
    /// Opens the source at this address. May take some seconds.
    ///
    /// # Errors
    /// Why there is no image.
    pub fn open(&self) -> Result<Box<dyn ImageSource>, EndoscopeError> {
        match self {
            Self::Http(endpoint) => Ok(Box::new(http::Http::open(endpoint)?)),
            #[cfg(feature = "h264")]
            Self::Rtsp(endpoint) => crate::rtsp::open(endpoint),
            #[cfg(not(feature = "h264"))]
            Self::Rtsp(_) => Err(EndoscopeError::NotBuilt { what: "RTSP and H.264" }),
            #[cfg(all(target_os = "linux", target_pointer_width = "64"))]
            Self::Camera { path, capture } => crate::v4l2::open(path, *capture),
            #[cfg(not(all(target_os = "linux", target_pointer_width = "64")))]
            Self::Camera { .. } => {
                Err(EndoscopeError::NotBuilt { what: "cameras of this computer (64-bit Linux only)" })
            }
            Self::File(path) => files::open(path),
        }
    }
}

/// Whether images are still needed.
#[derive(Clone, Debug, Default)]
pub(crate) struct ImageDemand(Arc<AtomicBool>);

impl ImageDemand {
    pub(crate) fn end(&self) {
        self.0.store(true, Ordering::Release);
    }

    pub(crate) fn has_ended(&self) -> bool {
        self.0.load(Ordering::Acquire)
    }
}
