//! Runs an image source on its own threads: one reads, one decodes, and the display takes the newest image.

use std::{
    io,
    sync::{Arc, Condvar, Mutex, MutexGuard, OnceLock, PoisonError},
    thread::Builder,
    time::{Duration, Instant},
};

use tracing::warn;

use crate::{
    Address, CompressedFrame, DecodedImage, EndoscopeError, Format, FrameHealth, FrameQueue, Tone,
    frame_health::FrameWatch,
    h264,
    source::{ImageDemand, ImageSource},
    waiting_frames::WaitingFrames,
};

/// Time from a failure to the next attempt. Together with the connection time it stays below a second.
const RETRY: Duration = Duration::from_millis(400);
/// Time to the first attempt after images have arrived.
const RETRY_FIRST: Duration = Duration::from_millis(50);
/// A display that has not taken an image for this long is inactive. Only some images are then decoded, so that faults
/// are still detected.
const LOOKED: Duration = Duration::from_millis(500);
const UNSEEN: Duration = Duration::from_millis(500);
/// Interval at which a waiting thread checks whether it is still needed.
const NAP: Duration = Duration::from_millis(50);

/// Reads and decodes images until it is dropped. Dropping does not wait for its threads.
#[derive(Debug)]
pub struct EndoscopeFeed {
    shared: Arc<FeedShared>,
}

/// The state of the source at one moment.
#[derive(Clone, Debug)]
pub struct FeedSnapshot<T> {
    /// The newest prepared image and its number; `None` before the first one.
    pub image: Option<(u64, T)>,
    /// Status of the source.
    pub standing: FrameHealth,
    /// Time since its last byte arrived, plus its delay beyond the minimum if the camera sends time stamps.
    pub age: Option<Duration>,
    /// Frames per second.
    pub rate_hz: f64,
    /// Time from the last byte of the newest image until it was available.
    pub work: Duration,
}

#[derive(Debug)]
struct FeedShared {
    wanted: ImageDemand,
    state: Mutex<FeedState>,
    /// Images that are not decoded yet.
    waiting: Mutex<WaitingFrames>,
    came: Condvar,
    /// Also receives compressed images, unmodified.
    reel: OnceLock<FrameQueue>,
    /// Tone applied to the images.
    tone: Mutex<Tone>,
}

#[derive(Debug)]
struct FeedState {
    watch: FrameWatch,
    trouble: Option<EndoscopeError>,
    is_still: bool,
    /// Whether the source has been open before.
    opened: bool,
    /// Format of the last image.
    format: Option<Format>,
    newest: Option<NewestImage>,
    shown: u64,
    /// When the image was last taken, and when one was last decoded.
    looked: Option<Instant>,
    decoded: Option<Instant>,
}

#[derive(Debug)]
struct NewestImage {
    number: u64,
    image: Arc<DecodedImage>,
    arrived: Instant,
    work: Duration,
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl EndoscopeFeed {
    /// Starts to read images from an address. `expected_px` is their expected size, if known; `wake` is called after
    /// every image and every failure.
    ///
    /// # Errors
    /// If the operating system cannot start a thread.
    pub fn start(
        address: Address,
        expected_px: Option<[usize; 2]>,
        wake: impl Fn() + Send + Sync + 'static,
    ) -> io::Result<Self> {
        let state = FeedState {
            watch: FrameWatch::new(expected_px),
            trouble: None,
            is_still: false,
            opened: false,
            format: None,
            newest: None,
            shown: 0,
            looked: None,
            decoded: None,
        };
        let shared = Arc::new(FeedShared {
            wanted: ImageDemand::default(),
            state: Mutex::new(state),
            waiting: Mutex::default(),
            came: Condvar::new(),
            reel: OnceLock::new(),
            tone: Mutex::default(),
        });
        let feed = Self { shared: Arc::clone(&shared) };
        let wake = Arc::new(wake);
        let reads = Arc::clone(&shared);
        let wakes = Arc::clone(&wake);
        Builder::new().name("endoscope".to_owned()).spawn(move || reads.read(&address, &*wakes))?;
        Builder::new().name("picture".to_owned()).spawn(move || shared.decode(&*wake))?;
        Ok(feed)
    }

    /// Also sends every JPEG and every H.264 frame from now on to this reel. Only the first reel is used.
    pub fn record_to(&self, reel: FrameQueue) {
        self.shared.reel.set(reel).ok();
    }

    /// Applies this tone to all images from now on, including the newest.
    pub fn set_tone(&self, tone: Tone) {
        *locked(&self.shared.tone) = tone;
    }

    /// Returns whether the images can go into a reel, which accepts only compressed ones.
    pub fn is_recordable(&self) -> bool {
        !matches!(locked(&self.shared.state).format, Some(Format::Raw(_)))
    }

    /// Returns the current status, for a caller that does not display the images.
    pub fn standing(&self, now: Instant) -> FrameHealth {
        locked(&self.shared.state).standing(now)
    }

    /// Returns the newest image and the current status. If it is not called, only two images per second are decoded.
    pub fn look(&self, now: Instant) -> FeedSnapshot<Arc<DecodedImage>> {
        let mut state = locked(&self.shared.state);
        state.looked = Some(now);
        let newest = state.newest.as_ref();
        let on_its_way = state.watch.late().unwrap_or_default();
        FeedSnapshot {
            image: newest.map(|newest| (newest.number, Arc::clone(&newest.image))),
            standing: state.standing(now),
            age: newest.map(|newest| now.saturating_duration_since(newest.arrived) + on_its_way),
            rate_hz: state.watch.rate_hz(now),
            work: newest.map(|newest| newest.work).unwrap_or_default(),
        }
    }
}

impl Drop for EndoscopeFeed {
    fn drop(&mut self) {
        self.shared.wanted.end();
        self.shared.came.notify_all();
    }
}

impl FeedState {
    fn standing(&self, now: Instant) -> FrameHealth {
        if let Some(trouble) = &self.trouble {
            return FrameHealth::Lost(trouble.clone());
        }
        match self.watch.wrong(now) {
            Some(wrong) => FrameHealth::Wrong(wrong),
            None if self.newest.is_none() => FrameHealth::Opening,
            None if self.is_still => FrameHealth::Still,
            None => FrameHealth::Live,
        }
    }
}

impl FeedState {
    /// Returns whether an image must be decoded now.
    fn wants(&self, now: Instant) -> bool {
        let within = |at: Option<Instant>, time| at.is_some_and(|at| now.saturating_duration_since(at) < time);
        self.is_still || within(self.looked, LOOKED) || !within(self.decoded, UNSEEN)
    }
}

impl FeedShared {
    /// Opens the source again and again.
    fn read(&self, address: &Address, wake: &dyn Fn()) {
        while !self.wanted.has_ended() {
            let begin = Instant::now();
            let trouble = match address.open() {
                Ok(source) => self.read_from(source),
                Err(trouble) => Some(trouble),
            };
            let Some(trouble) = trouble else { return };
            let was_good = {
                let mut state = locked(&self.state);
                let was_good = state.trouble.is_none() && state.opened;
                // Log the same error, which recurs twice a second, only once.
                if state.trouble.as_ref() != Some(&trouble) {
                    warn!(%trouble, "no picture");
                }
                state.trouble = Some(trouble);
                was_good
            };
            wake();
            // Retries at once only if the source worked for a while, so that a camera that keeps disconnecting is not
            // polled continuously.
            let soon = was_good && begin.elapsed() > RETRY;
            self.rest(if soon { RETRY_FIRST } else { RETRY });
        }
    }

    /// Reads until an error occurs; `None` if images are no longer needed.
    fn read_from(&self, mut source: Box<dyn ImageSource>) -> Option<EndoscopeError> {
        {
            let mut state = locked(&self.state);
            state.watch.opened(source.is_still());
            state.is_still = source.is_still();
        }
        *locked(&self.waiting) = WaitingFrames::default();
        if let Some(reel) = self.reel.get() {
            reel.begins();
        }
        while !self.wanted.has_ended() {
            match source.next() {
                Ok(None) => {}
                Ok(Some(compressed)) => {
                    {
                        let mut state = locked(&self.state);
                        state.watch.arrived(&compressed);
                        state.trouble = None;
                        state.opened = true;
                        state.format = Some(compressed.format);
                    }
                    if let Some(reel) = self.reel.get() {
                        reel.put(&compressed);
                    }
                    locked(&self.waiting).push(compressed);
                    self.came.notify_one();
                }
                Err(trouble) => return Some(trouble),
            }
        }
        None
    }

    fn rest(&self, whole: Duration) {
        let begin = Instant::now();
        while !self.wanted.has_ended() && begin.elapsed() < whole {
            std::thread::sleep(NAP.min(whole));
        }
    }

    /// Decodes the newest image again and again.
    fn decode(&self, wake: &dyn Fn()) {
        let mut decoder = h264::H264Decoder::default();
        let mut last: Option<(CompressedFrame, Tone)> = None;
        while let Some((compressed, is_newest)) = self.next(last.as_ref()) {
            let wanted = is_newest && locked(&self.state).wants(Instant::now());
            let mut decoded = match compressed.format {
                Format::H264 { is_key } => match decoder.take(&compressed.bytes, is_key, wanted) {
                    Ok(None) => continue,
                    Ok(Some(taken)) => {
                        locked(&self.state).watch.looks(compressed.arrived, taken.hash);
                        let Some(image) = taken.image else { continue };
                        Ok(image)
                    }
                    Err(damage) => Err(damage),
                },
                _ if wanted => compressed.decode(),
                _ => continue,
            };
            let tone = *locked(&self.tone);
            {
                let mut state = locked(&self.state);
                state.decoded = Some(Instant::now());
                state.watch.decoded(compressed.arrived, decoded.as_ref());
                if let Ok(image) = &mut decoded {
                    // Judge the image before the tone changes it.
                    tone.apply(image);
                }
                if let Ok(image) = decoded {
                    state.shown += 1;
                    let number = state.shown;
                    let arrived = compressed.arrived;
                    let work = arrived.elapsed();
                    state.newest = Some(NewestImage { number, image: Arc::new(image), arrived, work });
                }
            }
            wake();
            // A frame of a video stream cannot be decoded again, so the new tone applies from the next frame.
            last = Some((compressed, tone)).filter(|(compressed, _)| compressed.stands_alone());
        }
    }

    /// Waits for an image, or for another tone of the last one; also returns whether the image is the newest. `None` if
    /// images are no longer needed.
    fn next(&self, last: Option<&(CompressedFrame, Tone)>) -> Option<(CompressedFrame, bool)> {
        let mut waiting = locked(&self.waiting);
        loop {
            if self.wanted.has_ended() {
                return None;
            }
            if let Some(compressed) = waiting.pop() {
                return Some((compressed, waiting.is_empty()));
            }
            if let Some((compressed, _)) = last.filter(|(_, tone)| *tone != *locked(&self.tone)) {
                return Some((compressed.clone(), true));
            }
            // A missed notification costs one short wait, not the image.
            waiting = self.came.wait_timeout(waiting, NAP).unwrap_or_else(PoisonError::into_inner).0;
        }
    }
}

#[cfg(test)]
mod tests;
