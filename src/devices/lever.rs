//! The emergency release of a device: makes the device safe from another thread when the loop no longer runs.

use std::{
    fmt,
    sync::{Arc, Mutex, PoisonError},
};

type Pull = Box<dyn FnMut() + Send>;

/// Emergency release of a device, shared by the thread that opens the device and the supervisor, which may trigger it.
/// The loop never uses it.
#[derive(Clone, Default)]
pub struct Lever(Arc<Mutex<Option<Pull>>>);

impl Lever {
    /// Connects the lever to an open device, replacing the previous one.
    pub fn attach(&self, pull: impl FnMut() + Send + 'static) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some(Box::new(pull));
    }

    /// Switches the force off and the brakes on, as far as the device allows this from another thread. Does nothing if
    /// no device is open.
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
