//! Status of the recorder's thread.

use std::{
    sync::{
        OnceLock,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
    time::{Duration, Instant},
};

use super::RecordError;

/// Statistics of a recording so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RecordingProgress {
    /// Recorded ticks.
    pub ticks: u64,
    /// Entries that the loop dropped because this thread was too slow.
    pub lost: u64,
    /// Bytes in the file.
    pub bytes: u64,
    /// Endoscope images that were written.
    pub images: u64,
    /// Endoscope images that were dropped because this thread was too slow.
    pub images_dropped: u64,
    /// Time for which the disk has not responded; after two seconds, the loop drops entries.
    pub waits: Duration,
}

#[derive(Debug)]
pub(super) struct RecorderShared {
    began: Instant,
    /// Time of the thread's last check for entries, ms since its start.
    looked_ms: AtomicU64,
    pub(super) ticks: AtomicU64,
    pub(super) lost: AtomicU64,
    pub(super) bytes: AtomicU64,
    pub(super) images: AtomicU64,
    pub(super) images_dropped: AtomicU64,
    pub(super) ends: AtomicBool,
    pub(super) trouble: OnceLock<RecordError>,
}

impl RecorderShared {
    pub(super) fn new() -> Self {
        Self {
            began: Instant::now(),
            looked_ms: AtomicU64::default(),
            ticks: AtomicU64::default(),
            lost: AtomicU64::default(),
            bytes: AtomicU64::default(),
            images: AtomicU64::default(),
            images_dropped: AtomicU64::default(),
            ends: AtomicBool::default(),
            trouble: OnceLock::new(),
        }
    }

    /// Notes that the thread checks for entries now.
    pub(super) fn looked(&self) {
        self.looked_ms.store(self.ms(), Ordering::Relaxed);
    }

    pub(super) fn progress(&self) -> RecordingProgress {
        let Self { ticks, lost, bytes, images, images_dropped, looked_ms, .. } = self;
        let [ticks, lost, bytes, images, images_dropped, looked_ms] =
            [ticks, lost, bytes, images, images_dropped, looked_ms].map(|count| count.load(Ordering::Relaxed));
        let waits = Duration::from_millis(self.ms().saturating_sub(looked_ms));
        RecordingProgress { ticks, lost, bytes, images, images_dropped, waits }
    }

    fn ms(&self) -> u64 {
        self.began.elapsed().as_millis() as u64
    }
}
