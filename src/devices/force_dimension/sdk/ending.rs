//! No device stays without brakes when the program ends by itself.

use std::{
    sync::atomic::{AtomicBool, AtomicUsize, Ordering},
    time::{Duration, Instant},
};

/// Devices that are open in this program.
static OPEN_DEVICES: AtomicUsize = AtomicUsize::new(0);
/// The program ends: threads that hold a device let go of it.
static ENDING: AtomicBool = AtomicBool::new(false);
/// How long the end of the program waits for that.
const END_MAX: Duration = Duration::from_millis(300);

/// One device more is open.
pub(super) fn opened() {
    OPEN_DEVICES.fetch_add(1, Ordering::AcqRel);
}

/// One device less is open.
pub(super) fn closed() {
    OPEN_DEVICES.fetch_sub(1, Ordering::AcqRel);
}

/// The program ends.
pub(in crate::force_dimension) fn is_ending() -> bool {
    ENDING.load(Ordering::Acquire)
}

/// Has brakes engaged also when the program ends without dropping its devices (`exit` somewhere). The threads that hold them do it
/// themselves; the end only waits for them.
pub(super) fn call_before_exit() {
    extern "C" fn release_all() {
        ENDING.store(true, Ordering::Release);
        let begin = Instant::now();
        while OPEN_DEVICES.load(Ordering::Acquire) > 0 && begin.elapsed() < END_MAX {
            std::thread::sleep(Duration::from_millis(1));
        }
    }
    #[cfg(unix)]
    {
        static ONCE: std::sync::Once = std::sync::Once::new();
        // SAFETY: a function that lives for ever, does not unwind and touches statics without destructors only.
        ONCE.call_once(|| unsafe {
            libc::atexit(release_all);
        });
    }
    #[cfg(not(unix))]
    let _ = release_all;
}
