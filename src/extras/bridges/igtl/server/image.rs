//! Endoscope images for the clients that request them.

use std::{
    fmt::Debug,
    sync::{Mutex, MutexGuard, PoisonError},
    thread::sleep,
    time::Duration,
};

use super::{
    super::{Content, IgtlMessage, Image},
    IMAGE_DEVICE, IgtlShared,
    client::now_ns,
};

/// Interval of the checks for requests and new images.
const LOOK_EVERY: Duration = Duration::from_millis(10);

/// A source of images. Called on the server's own thread.
pub trait ImageProvider: Send + Debug {
    /// Returns the newest image, if it has not been taken yet, and its age. Without `is_wanted`, the source does not
    /// need to keep images.
    fn newest(&mut self, is_wanted: bool) -> Option<(Image, Duration)>;
}

/// Holds the source, once there is one.
#[derive(Debug, Default)]
pub(super) struct ImageSlot(Mutex<Option<Box<dyn ImageProvider>>>);

impl ImageSlot {
    fn source(&self) -> MutexGuard<'_, Option<Box<dyn ImageProvider>>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn put(&self, source: Option<Box<dyn ImageProvider>>) {
        *self.source() = source;
    }

    /// Returns whether there is a source.
    pub(super) fn is_taken(&self) -> bool {
        self.source().is_some()
    }
}

/// Delivers images until the server ends.
pub(super) fn serve(shared: &IgtlShared) {
    while !shared.is_ending() {
        sleep(LOOK_EVERY);
        let looking: Vec<_> =
            shared.clients().iter().filter(|client| !client.is_gone() && client.wants().looks()).cloned().collect();
        // A client that has not taken the last image yet needs no newer one.
        let is_wanted = looking.iter().any(|client| !client.mailbox.has_image());
        let newest = shared.images.source().as_mut().and_then(|source| source.newest(is_wanted));
        let Some((image, age)) = newest.filter(|_| is_wanted) else { continue };
        let time_ns = now_ns().saturating_sub(age.as_nanos() as u64);
        let bytes = IgtlMessage::new(IMAGE_DEVICE, time_ns, Content::Image(image)).encode();
        for client in looking {
            client.mailbox.image(bytes.clone());
            client.wants().has_seen();
        }
    }
}
