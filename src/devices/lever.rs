//! The emergency lever of a device: what another thread may do to it when the loop no longer runs.

use std::{
    fmt,
    sync::{Arc, Mutex, PoisonError},
};

type Pull = Box<dyn FnMut() + Send>;

/// A lever, shared by the thread that opens the device and the one that may have to pull it. The loop never touches it.
#[derive(Clone, Default)]
pub struct Lever(Arc<Mutex<Option<Pull>>>);

impl Lever {
    /// Attaches it to a device that was opened; it replaces the one before.
    pub fn attach(&self, pull: impl FnMut() + Send + 'static) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some(Box::new(pull));
    }

    /// Force off, brakes on: as far as the device lets another thread do it. Does nothing where none is open.
    pub fn pull(&self) {
        if let Some(pull) = &mut *self.0.lock().unwrap_or_else(PoisonError::into_inner) {
            pull();
        }
    }
}

impl fmt::Debug for Lever {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Lever")
    }
}
