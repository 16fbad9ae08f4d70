//! Pictures of the endoscope for the clients that ask for them.

use std::{
    fmt::Debug,
    sync::{Mutex, MutexGuard, PoisonError},
    thread::sleep,
    time::Duration,
};

use super::{
    super::{Content, Image, Message},
    IMAGE_DEVICE, Shared,
    client::now_ns,
};

/// How often is looked whether somebody wants a picture, and whether there is one.
const LOOK_EVERY: Duration = Duration::from_millis(10);

/// Where pictures come from. Asked on a thread of the server's own.
pub trait Pictures: Send + Debug {
    /// The newest picture, if it was not taken yet, and its age. `is_wanted` tells whether anybody looks: without, nothing need be kept.
    fn newest(&mut self, is_wanted: bool) -> Option<(Image, Duration)>;
}

/// Where the source lies, once there is one.
#[derive(Debug, Default)]
pub(super) struct Desk(Mutex<Option<Box<dyn Pictures>>>);

impl Desk {
    fn source(&self) -> MutexGuard<'_, Option<Box<dyn Pictures>>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn put(&self, source: Option<Box<dyn Pictures>>) {
        *self.source() = source;
    }

    /// Whether there can be pictures.
    pub(super) fn is_taken(&self) -> bool {
        self.source().is_some()
    }
}

/// Hands pictures over until the server ends.
pub(super) fn serve(shared: &Shared) {
    while !shared.is_ending() {
        sleep(LOOK_EVERY);
        let looking: Vec<_> =
            shared.clients().iter().filter(|client| !client.is_gone() && client.wants().looks()).cloned().collect();
        // Who has not taken the last one yet needs no other.
        let is_wanted = looking.iter().any(|client| !client.mailbox.has_picture());
        let newest = shared.pictures.source().as_mut().and_then(|source| source.newest(is_wanted));
        let Some((image, age)) = newest.filter(|_| is_wanted) else { continue };
        let time_ns = now_ns().saturating_sub(age.as_nanos() as u64);
        let bytes = Message::new(IMAGE_DEVICE, time_ns, Content::Image(image)).encode();
        for client in looking {
            client.mailbox.picture(bytes.clone());
            client.wants().has_seen();
        }
    }
}
