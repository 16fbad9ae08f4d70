//! What every source of pictures is.

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::Instant,
};

use crate::{Address, Trouble, files, http};

/// One picture as it came, not decoded.
#[derive(Clone, Debug)]
pub struct Compressed {
    /// A whole JPEG, if the camera sent one.
    pub jpeg: Vec<u8>,
    /// When its last byte was here.
    pub arrived: Instant,
    /// The camera's own stamp, s since some moment of its own; `None` where it sends none.
    pub stamp_s: Option<f64>,
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
            Self::Http { host, port, path } => Ok(Box::new(http::Http::open(host, *port, path)?)),
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
