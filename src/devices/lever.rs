//! The emergency release of a device: makes the device safe from another thread when the loop no longer runs.

use std::{
    fmt,
    sync::{Arc, Mutex, PoisonError, TryLockError},
};

type Pull = Box<dyn FnMut() + Send>;

/// Emergency release of a device, shared by the thread that opens the device and the supervisor, which may trigger it.
/// The loop never uses it.
#[derive(Clone, Default)]
pub struct Lever(Arc<Mutex<Option<Pull>>>);

impl Lever {
    /// Connects the lever to an open device, replacing the previous one.
    pub fn attach(&self, pull: impl FnMut() + Send + 'static) {
        let previous = self.0.lock().unwrap_or_else(PoisonError::into_inner).replace(Box::new(pull));
        // Freed without the lock, which the supervisor needs.
        drop(previous);
    }

    /// Switches the force off and the brakes on, as far as the device allows this from another thread. Does nothing if
    /// no device is open. Returns false if a device is being attached: the supervisor must not wait for that thread,
    /// which has a lower priority, so call it again.
    pub fn pull(&self) -> bool {
        let mut held = match self.0.try_lock() {
            Ok(held) => held,
            Err(TryLockError::Poisoned(held)) => held.into_inner(),
            Err(TryLockError::WouldBlock) => return false,
        };
        if let Some(pull) = &mut *held {
            pull();
        }
        true
    }
}

impl fmt::Debug for Lever {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Lever")
    }
}
