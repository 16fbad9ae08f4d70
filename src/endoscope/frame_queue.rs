//! Queue of images to be recorded: bounded, and never blocks.

use std::{
    collections::VecDeque,
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
};

use crate::{CompressedFrame, Format};

/// Maximum bytes and images in the queue: some seconds of a usual camera. When it is full, new images are dropped and
/// counted.
const BYTES_MAX: usize = 32 << 20;
const IMAGES_MAX: usize = 256;

/// Receives every JPEG and every frame of an H.264 stream of a [`crate::EndoscopeFeed`], unmodified; the other end is a
/// [`ReelEnd`]. Without one, nothing is kept.
#[derive(Clone, Debug, Default)]
pub struct FrameQueue(Arc<ReelShared>);

/// Takes the newest JPEG at intervals, independent of a recording.
#[derive(Clone, Debug)]
pub struct LatestFrame(Arc<ReelShared>);

/// Receiving end of the queue. Dropping it closes the queue.
#[derive(Debug)]
pub struct ReelEnd {
    shared: Arc<ReelShared>,
    number: u64,
}

#[derive(Debug, Default)]
struct ReelShared {
    waiting: Mutex<QueuedFrames>,
    dropped: AtomicU64,
    /// Whether a temporary view is active, and the newest image since its last look.
    looked_at: AtomicBool,
    newest: Mutex<Option<CompressedFrame>>,
}

#[derive(Debug, Default)]
struct QueuedFrames {
    /// The current taker; earlier takers get no more images.
    taker: Option<u64>,
    takers: u64,
    images: VecDeque<CompressedFrame>,
    bytes: usize,
    rests: bool,
    /// Set until a key frame of the stream arrives.
    skips: bool,
}

impl ReelShared {
    fn waiting(&self) -> MutexGuard<'_, QueuedFrames> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn newest(&self) -> MutexGuard<'_, Option<CompressedFrame>> {
        self.newest.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl QueuedFrames {
    /// Returns whether a decoder could use the image: a frame of a stream only after all frames since a key frame.
    fn understands(&mut self, format: Format) -> bool {
        match format {
            Format::Raw(_) => false,
            Format::Jpeg => true,
            Format::H264 { is_key } => {
                self.skips &= !is_key;
                !self.skips
            }
        }
    }

    fn clear(&mut self) {
        self.images.clear();
        self.bytes = 0;
    }
}

impl FrameQueue {
    /// Returns the receiving end for a new recording: it gets the images from now on, and an earlier end gets none.
    pub fn end(&self) -> ReelEnd {
        let mut waiting = self.0.waiting();
        waiting.takers += 1;
        waiting.taker = Some(waiting.takers);
        waiting.clear();
        waiting.skips = true;
        self.0.dropped.store(0, Ordering::Relaxed);
        ReelEnd { shared: Arc::clone(&self.0), number: waiting.takers }
    }

    /// Sets whether images are currently discarded, because no recording needs them.
    pub fn rest(&self, rests: bool) {
        let mut waiting = self.0.waiting();
        waiting.rests = rests;
        waiting.skips |= rests;
    }

    /// Called when a new stream begins.
    pub(crate) fn begins(&self) {
        self.0.waiting().skips = true;
    }

    /// Returns a view of the newest image, which works with and without a recording.
    pub fn glimpse(&self) -> LatestFrame {
        LatestFrame(Arc::clone(&self.0))
    }

    /// Adds an image, unless the queue is full, has no receiver, or the image is not compressed. Never waits for the
    /// other end.
    pub(crate) fn put(&self, image: &CompressedFrame) {
        if self.0.looked_at.load(Ordering::Relaxed) && image.format == Format::Jpeg {
            *self.0.newest() = Some(image.clone());
        }
        let mut waiting = self.0.waiting();
        if waiting.taker.is_none() || waiting.rests || !waiting.understands(image.format) {
            return;
        }
        let length = image.bytes.len();
        if waiting.images.len() >= IMAGES_MAX || waiting.bytes + length > BYTES_MAX {
            self.0.dropped.fetch_add(1, Ordering::Relaxed);
            waiting.skips = true;
            return;
        }
        waiting.bytes += length;
        waiting.images.push_back(image.clone());
    }
}

impl LatestFrame {
    /// Returns the newest image since the last call. An image is kept for the next call only while `looks` is set.
    pub fn take(&self, looks: bool) -> Option<CompressedFrame> {
        self.0.looked_at.store(looks, Ordering::Relaxed);
        self.0.newest().take()
    }
}

impl ReelEnd {
    /// Takes the oldest image out of the queue.
    pub fn take(&self) -> Option<CompressedFrame> {
        let mut waiting = self.shared.waiting();
        if waiting.taker != Some(self.number) {
            return None;
        }
        let image = waiting.images.pop_front()?;
        waiting.bytes -= image.bytes.len();
        Some(image)
    }

    /// Returns the number of images dropped so far.
    pub fn dropped(&self) -> u64 {
        self.shared.dropped.load(Ordering::Relaxed)
    }
}

impl Drop for ReelEnd {
    fn drop(&mut self) {
        let mut waiting = self.shared.waiting();
        if waiting.taker == Some(self.number) {
            waiting.taker = None;
            waiting.clear();
        }
    }
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use super::*;
    use crate::{Colours, PixelLayout, RawLayout};

    fn image(length: usize) -> CompressedFrame {
        CompressedFrame::jpeg(vec![7; length], Instant::now(), None)
    }

    #[test]
    fn what_has_no_room_is_dropped_and_counted() {
        let reel = FrameQueue::default();
        reel.put(&image(10));
        let end = reel.end();
        assert!(end.take().is_none(), "no one took that image");
        for _ in 0..20 {
            reel.put(&image(2 << 20));
        }
        assert_eq!(end.dropped(), 4, "16 of 2 MiB fit");
        assert_eq!(std::iter::from_fn(|| end.take()).count(), 16);
        for _ in 0..2 * IMAGES_MAX {
            reel.put(&image(1));
        }
        assert_eq!(end.dropped(), 4 + IMAGES_MAX as u64);
        assert_eq!(std::iter::from_fn(|| end.take()).count(), IMAGES_MAX);
        reel.put(&image(3));
        assert_eq!(end.take().unwrap().bytes.len(), 3);
    }

    #[test]
    fn a_glimpse_is_of_the_newest_jpeg_and_takes_none_from_a_recording() {
        let reel = FrameQueue::default();
        let glimpse = reel.glimpse();
        let end = reel.end();
        reel.put(&image(1));
        assert!(glimpse.take(true).is_none(), "nobody looked");
        reel.put(&image(2));
        reel.put(&image(3));
        reel.put(&CompressedFrame { format: Format::H264 { is_key: true }, ..image(4) });
        assert_eq!(glimpse.take(true).unwrap().bytes.len(), 3);
        assert!(glimpse.take(false).is_none(), "it was taken");
        reel.put(&image(5));
        assert!(glimpse.take(false).is_none());
        assert_eq!(std::iter::from_fn(|| end.take()).count(), 5);
    }

    #[test]
    fn what_is_not_compressed_is_not_put_in() {
        let reel = FrameQueue::default();
        let end = reel.end();
        let raw =
            RawLayout { layout: PixelLayout::Nv12, colours: Colours::usual([16, 16]), size_px: [16, 16], stride: 16 };
        reel.put(&CompressedFrame { format: Format::Raw(raw), ..image(1) });
        assert!(end.take().is_none() && end.dropped() == 0);
    }

    #[test]
    fn a_stream_is_put_in_from_a_picture_on_that_refers_to_no_other() {
        let of = |length, is_key| CompressedFrame { format: Format::H264 { is_key }, ..image(length) };
        let reel = FrameQueue::default();
        let end = reel.end();
        let put = |images: &[CompressedFrame]| {
            for image in images {
                reel.put(image);
            }
        };
        let lengths = || -> Vec<usize> { std::iter::from_fn(|| end.take()).map(|taken| taken.bytes.len()).collect() };
        put(&[of(1, false), of(2, true), of(3, false)]);
        assert_eq!(lengths(), [2, 3]);
        reel.begins();
        put(&[of(4, false), of(5, true), of(6, false)]);
        assert_eq!(lengths(), [5, 6], "the camera was opened again");
        // There is no room for one frame, so the frames that refer to it are left out too.
        put(&[of(7, true), of(33 << 20, false), of(8, false), of(9, true), of(10, false)]);
        assert_eq!((lengths(), end.dropped()), (vec![7, 9, 10], 1));
        reel.rest(true);
        reel.put(&of(11, true));
        reel.rest(false);
        put(&[of(12, false), of(13, true)]);
        assert_eq!(lengths(), [13]);
    }

    #[test]
    fn a_new_recording_takes_over_and_what_rests_is_not_recorded() {
        let reel = FrameQueue::default();
        let first = reel.end();
        reel.put(&image(1));
        let second = reel.end();
        reel.put(&image(2));
        assert!(first.take().is_none());
        drop(first);
        assert_eq!(second.take().unwrap().bytes.len(), 2);
        reel.rest(true);
        reel.put(&image(4));
        assert!(second.take().is_none());
        reel.rest(false);
        reel.put(&image(5));
        assert_eq!((second.take().unwrap().bytes.len(), second.dropped()), (5, 0));
    }
}
