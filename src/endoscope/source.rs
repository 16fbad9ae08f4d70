//! What every source of pictures is.

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::Instant,
};

use crate::{Address, Damage, Picture, Raw, Trouble, files, http, jpeg};

/// One picture as it came, not decoded.
#[derive(Clone, Debug)]
pub struct Compressed {
    /// What it is.
    pub format: Format,
    /// As the camera sent it.
    pub bytes: Vec<u8>,
    /// When its last byte was here.
    pub arrived: Instant,
    /// The camera's own stamp, s since some moment of its own; `None` where it sends none.
    pub stamp_s: Option<f64>,
    /// When it was taken, where the camera's clock is this computer's.
    pub taken: Option<Instant>,
}

/// What the bytes of a picture are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// A whole JPEG, if the camera sent one.
    Jpeg,
    /// Not compressed.
    Raw(Raw),
    /// A picture of a stream of H.264 (an access unit, annex B), which refers to those before it.
    H264 {
        /// It refers to no other: a decoder can begin with it.
        is_key: bool,
    },
}

impl Compressed {
    /// A JPEG that came at this moment, with the stamp of its camera.
    pub(crate) const fn jpeg(bytes: Vec<u8>, arrived: Instant, stamp_s: Option<f64>) -> Self {
        Self { format: Format::Jpeg, bytes, arrived, stamp_s, taken: None }
    }

    /// It refers to no picture before it.
    pub const fn stands_alone(&self) -> bool {
        !matches!(self.format, Format::H264 { .. })
    }

    /// Pixels of a picture that stands alone, on the thread that calls.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn decode(&self) -> Result<Picture, Damage> {
        match self.format {
            Format::Jpeg => jpeg::decode(&self.bytes),
            Format::Raw(raw) => raw.picture(&self.bytes),
            Format::H264 { .. } => Err(Damage::Undecodable { reason: "it refers to other pictures".to_owned() }),
        }
    }
}

/// Gives pictures one after the other. It lives on one thread, which it may hold up until it is told to stop.
pub trait Source: Send {
    /// The next picture; `None` where none came within about 0.1 s.
    ///
    /// # Errors
    /// Why there will be no more: the source is then opened again.
    fn next(&mut self) -> Result<Option<Compressed>, Trouble>;

    /// It has one picture only: that nothing moves is no fault.
    fn is_still(&self) -> bool {
        false
    }
}

impl Address {
    /// Opens the source at this address. Takes up to some seconds.
    ///
    /// # Errors
    /// Why there is no picture.
    pub fn open(&self) -> Result<Box<dyn Source>, Trouble> {
        match self {
            Self::Http(endpoint) => Ok(Box::new(http::Http::open(endpoint)?)),
            #[cfg(feature = "h264")]
            Self::Rtsp(endpoint) => crate::rtsp::open(endpoint),
            #[cfg(not(feature = "h264"))]
            Self::Rtsp(_) => Err(Trouble::NotBuilt { what: "RTSP and H.264" }),
            #[cfg(all(target_os = "linux", target_pointer_width = "64"))]
            Self::Camera { path, capture } => crate::v4l2::open(path, *capture),
            #[cfg(not(all(target_os = "linux", target_pointer_width = "64")))]
            Self::Camera { .. } => Err(Trouble::NotBuilt { what: "cameras of this computer (64-bit Linux only)" }),
            Self::File(path) => files::open(path),
        }
    }
}

/// Whether somebody still wants pictures.
#[derive(Clone, Debug, Default)]
pub(crate) struct Wanted(Arc<AtomicBool>);

impl Wanted {
    pub(crate) fn end(&self) {
        self.0.store(true, Ordering::Release);
    }

    pub(crate) fn has_ended(&self) -> bool {
        self.0.load(Ordering::Acquire)
    }
}
