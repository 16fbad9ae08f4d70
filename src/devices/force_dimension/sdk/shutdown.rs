//! Ensures that no device is left without brakes when the program ends through `exit`.

use std::{
    sync::atomic::{AtomicBool, AtomicUsize, Ordering},
    time::{Duration, Instant},
};

/// Number of devices that are open in this program.
static OPEN_DEVICES: AtomicUsize = AtomicUsize::new(0);
/// Set when the program ends: a thread that owns a device must then close it.
static ENDING: AtomicBool = AtomicBool::new(false);
/// Maximum time for which the end of the program waits for that.
const END_MAX: Duration = Duration::from_millis(300);

pub(super) fn opened() {
    OPEN_DEVICES.fetch_add(1, Ordering::AcqRel);
}

pub(super) fn closed() {
    OPEN_DEVICES.fetch_sub(1, Ordering::AcqRel);
}

pub(in crate::force_dimension) fn is_ending() -> bool {
    ENDING.load(Ordering::Acquire)
}

/// Ensures that brakes are engaged even if the program ends without dropping its devices (a call of `exit`). The
/// threads that own the devices do this themselves; the exit handler only waits for them. On Windows it is called when
/// `main` has returned, but not by [`std::process::exit`], which ends all threads first: a program with devices must
/// not call that function.
pub(super) fn call_before_exit() {
    extern "C" fn release_all() {
        ENDING.store(true, Ordering::Release);
        let begin = Instant::now();
        while OPEN_DEVICES.load(Ordering::Acquire) > 0 && begin.elapsed() < END_MAX {
            std::thread::sleep(Duration::from_millis(1));
        }
    }
    #[cfg(any(unix, windows))]
    {
        static ONCE: std::sync::Once = std::sync::Once::new();
        // SAFETY: the function is static, does not unwind, and uses only statics without destructors.
        ONCE.call_once(|| unsafe {
            libc::atexit(release_all);
        });
    }
    #[cfg(not(any(unix, windows)))]
    let _ = release_all;
}
