//! Judges incoming images: frozen, black, unreadable, of the wrong size, or late. Time is passed in as an argument.

use std::{
    collections::VecDeque,
    hash::{DefaultHasher, Hash as _, Hasher as _},
    time::{Duration, Instant},
};

use crate::{CompressedFrame, Damage, DecodedImage, Format};

/// An image that does not change for this long is frozen. Six images at 30 Hz: longer than a network pauses, and short
/// enough that an operator has not moved far on an old image.
pub const FROZEN: Duration = Duration::from_millis(200);
/// An image that is this old on arrival is late.
pub const LATE: Duration = Duration::from_millis(200);
/// A damaged image is reported for this long. A single damaged image would otherwise vanish from the screen before it
/// can be read.
const DAMAGE_REPORTED: Duration = Duration::from_millis(500);
/// Period over which the rate is counted, and maximum number of arrivals stored.
const RATE_OVER: Duration = Duration::from_secs(1);
/// More than a second of the fastest camera, so that only a fault reaches it.
const ARRIVALS_MAX: usize = 512;
/// The camera's clock may be slower than ours by this factor: 200 parts in a million. Crystals differ by at most 100
/// parts in a million each; without this allowance a slow clock would be reported as a growing delay.
const DRIFT: f64 = 2e-4;

/// A fault of the images.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FrameFault {
    /// For this long, no image has arrived, or always the same one.
    Frozen(Duration),
    /// The last image could not be shown.
    Damaged(Damage),
    /// The size differs from that of the rig's camera, or from the first image: actual and expected size.
    Size([usize; 2], [usize; 2]),
    /// The image is black.
    Black,
    /// Age on arrival.
    Late(Duration),
}

/// Status of the images.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FrameHealth {
    /// Not available yet, for the first time.
    Opening,
    /// Images are arriving.
    Live,
    /// A single image; no more are expected.
    Still,
    /// Images are or were arriving, with a fault.
    Wrong(FrameFault),
    /// There are no images: the reason, with its remedy.
    Lost(crate::EndoscopeError),
}

/// Monitors the images of one source.
#[derive(Debug)]
pub(crate) struct FrameWatch {
    /// Known in advance, or the size of the first image.
    expected_px: Option<[usize; 2]>,
    is_still: bool,
    hash: Option<u64>,
    /// When an image last arrived that differed from the previous one.
    changed: Option<Instant>,
    arrivals: VecDeque<Instant>,
    damage: Option<(Instant, Damage)>,
    shown: Option<DisplayedFrame>,
    delay: Delay,
}

#[derive(Clone, Copy, Debug)]
struct DisplayedFrame {
    size_px: [usize; 2],
    is_black: bool,
}

impl FrameWatch {
    /// `expected_px`: the size of the rig's camera, if known.
    pub(crate) fn new(expected_px: Option<[usize; 2]>) -> Self {
        Self {
            expected_px,
            is_still: false,
            hash: None,
            changed: None,
            arrivals: VecDeque::new(),
            damage: None,
            shown: None,
            delay: Delay::default(),
        }
    }

    /// Called when the source was opened, for the first time or again.
    pub(crate) fn opened(&mut self, is_still: bool) {
        self.is_still = is_still;
        // A camera that was restarted counts from another zero.
        self.delay = Delay::default();
        self.damage = None;
    }

    /// Called for an image that has arrived and is not decoded yet.
    pub(crate) fn arrived(&mut self, compressed: &CompressedFrame) {
        let at = compressed.arrived;
        // Only for images without reference to others: a stream that repeats a still view sends different bytes.
        if compressed.stands_alone() {
            self.looks(at, hash(compressed));
        }
        self.arrivals.push_back(at);
        let begin = at.checked_sub(RATE_OVER);
        while self.arrivals.len() > ARRIVALS_MAX || self.arrivals.front().is_some_and(|first| Some(*first) < begin) {
            self.arrivals.pop_front();
        }
        self.delay.take(compressed);
    }

    /// Stores the hash of an image that arrived now; equal images have equal hashes. A stream, whose frames refer to
    /// each other, never repeats its bytes.
    pub(crate) fn looks(&mut self, at: Instant, hash: u64) {
        if self.hash != Some(hash) {
            self.hash = Some(hash);
            self.changed = Some(at);
        }
    }

    /// Called when the image that arrived at this time has been decoded.
    pub(crate) fn decoded(&mut self, at: Instant, decoded: Result<&DecodedImage, &Damage>) {
        match decoded {
            Ok(image) => {
                self.expected_px.get_or_insert(image.size_px);
                self.shown = Some(DisplayedFrame { size_px: image.size_px, is_black: image.is_black() });
            }
            Err(damage) => self.damage = Some((at, damage.clone())),
        }
    }

    /// Returns the age of the newest image on arrival, beyond the observed minimum; `None` if the camera sends no time
    /// stamps.
    pub(crate) fn late(&self) -> Option<Duration> {
        self.delay.late()
    }

    /// Returns the frames per second.
    pub(crate) fn rate_hz(&self, now: Instant) -> f64 {
        let begin = now.checked_sub(RATE_OVER);
        self.arrivals.iter().filter(|at| Some(**at) >= begin).count() as f64 / RATE_OVER.as_secs_f64()
    }

    /// Returns the current fault; the one that hides most of the image comes first.
    pub(crate) fn wrong(&self, now: Instant) -> Option<FrameFault> {
        // A single image cannot freeze, be late or stop.
        if self.is_still {
            return self.damage.as_ref().map(|(_, damage)| FrameFault::Damaged(damage.clone()));
        }
        let since = |at: Instant| now.saturating_duration_since(at);
        let arrived = self.arrivals.back().copied();
        let comes = arrived.is_some_and(|at| since(at) < FROZEN);
        if let Some((_, damage)) = self.damage.as_ref().filter(|(at, _)| comes && since(*at) < DAMAGE_REPORTED) {
            return Some(FrameFault::Damaged(damage.clone()));
        }
        // Black images are all equal: if they keep arriving, the light is off; the camera is not frozen.
        if comes && self.shown.is_some_and(|shown| shown.is_black) {
            return Some(FrameFault::Black);
        }
        if let Some(stood) = self.changed.map(since).filter(|stood| *stood >= FROZEN) {
            return Some(FrameFault::Frozen(stood));
        }
        let shown = self.shown?;
        let expected_px = self.expected_px?;
        if shown.size_px != expected_px {
            return Some(FrameFault::Size(shown.size_px, expected_px));
        }
        self.late().filter(|late| *late >= LATE).map(FrameFault::Late)
    }
}

/// For uncompressed pixels, only one of several runs of this many bytes is hashed, because sensor noise is everywhere.
const RUN_BYTES: usize = 256;
const RUN_OF: usize = 16;

/// Returns a hash that is equal for equal images.
fn hash(compressed: &CompressedFrame) -> u64 {
    let mut hasher = DefaultHasher::new();
    match compressed.format {
        // In compressed data one changed pixel may change few bytes, so all of them are hashed.
        Format::Jpeg | Format::H264 { .. } => compressed.bytes.hash(&mut hasher),
        Format::Raw(_) => compressed.bytes.chunks(RUN_BYTES).step_by(RUN_OF).for_each(|run| run.hash(&mut hasher)),
    }
    hasher.finish()
}

/// Delay of images from the camera's time stamps: an image without delay has the minimum difference between the two
/// clocks.
#[derive(Debug, Default)]
struct Delay {
    begin: Option<Instant>,
    min_s: f64,
    late_s: Option<f64>,
    last_s: f64,
}

impl Delay {
    fn take(&mut self, compressed: &CompressedFrame) {
        let at = compressed.arrived;
        // On a common clock no estimate is needed.
        if let Some(taken) = compressed.taken {
            self.late_s = Some(at.saturating_duration_since(taken).as_secs_f64());
            return;
        }
        let Some(stamp_s) = compressed.stamp_s else {
            self.late_s = None;
            return;
        };
        let at_s = at.saturating_duration_since(*self.begin.get_or_insert(at)).as_secs_f64();
        let difference_s = at_s - stamp_s;
        self.min_s = match self.late_s {
            Some(_) => difference_s.min(self.min_s + DRIFT * (at_s - self.last_s)),
            None => difference_s,
        };
        self.late_s = Some(difference_s - self.min_s);
        self.last_s = at_s;
    }

    fn late(&self) -> Option<Duration> {
        self.late_s.and_then(|late_s| Duration::try_from_secs_f64(late_s).ok())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD: Duration = Duration::from_millis(33);

    fn image(value: u8, size_px: [usize; 2]) -> DecodedImage {
        DecodedImage { size_px, rgba: vec![value; 4 * size_px[0] * size_px[1]] }
    }

    /// A camera with its own clock.
    struct Fixture {
        watch: FrameWatch,
        now: Instant,
        count: u8,
    }

    impl Fixture {
        fn new() -> Self {
            let mut watch = FrameWatch::new(None);
            watch.opened(false);
            Self { watch, now: Instant::now(), count: 0 }
        }

        fn frame(&mut self, value: u8, size_px: [usize; 2]) {
            self.count = self.count.wrapping_add(1);
            self.come(&[self.count], Ok(&image(value, size_px)));
        }

        fn come(&mut self, jpeg: &[u8], decoded: Result<&DecodedImage, &Damage>) {
            self.now += PERIOD;
            self.watch.arrived(&CompressedFrame::jpeg(jpeg.to_vec(), self.now, None));
            self.watch.decoded(self.now, decoded);
        }
    }

    #[test]
    fn a_picture_that_moves_is_fine_and_its_rate_is_counted() {
        let mut bench = Fixture::new();
        for _ in 0..90 {
            bench.frame(100, [64, 48]);
            assert_eq!(bench.watch.wrong(bench.now), None);
        }
        assert!((bench.watch.rate_hz(bench.now) - 30.0).abs() <= 1.0);
        assert!(bench.watch.rate_hz(bench.now + Duration::from_secs(2)) < 0.5);
    }

    #[test]
    fn a_frozen_picture_is_told_at_200_ms_whether_none_comes_or_always_the_same() {
        let mut bench = Fixture::new();
        bench.frame(100, [64, 48]);
        let frozen =
            |bench: &Fixture, after| matches!(bench.watch.wrong(bench.now + after), Some(FrameFault::Frozen(_)));
        assert!(!frozen(&bench, Duration::from_millis(199)) && frozen(&bench, Duration::from_millis(200)));
        for _ in 0..6 {
            bench.come(b"the same", Ok(&image(100, [64, 48])));
        }
        assert!(!frozen(&bench, Duration::ZERO), "it stands for 5 periods of 33 ms");
        bench.come(b"the same", Ok(&image(100, [64, 48])));
        bench.come(b"the same", Ok(&image(100, [64, 48])));
        assert!(frozen(&bench, Duration::ZERO));
        bench.frame(100, [64, 48]);
        assert!(!frozen(&bench, Duration::ZERO));
    }

    #[test]
    fn black_another_size_and_damage_are_told_with_the_first_picture_that_has_them() {
        let mut bench = Fixture::new();
        bench.frame(100, [64, 48]);
        bench.frame(0, [64, 48]);
        assert_eq!(bench.watch.wrong(bench.now), Some(FrameFault::Black));
        bench.frame(100, [32, 48]);
        assert_eq!(bench.watch.wrong(bench.now), Some(FrameFault::Size([32, 48], [64, 48])));
        bench.come(b"half", Err(&Damage::Torn));
        assert_eq!(bench.watch.wrong(bench.now), Some(FrameFault::Damaged(Damage::Torn)));
        for _ in 0..16 {
            bench.frame(100, [64, 48]);
        }
        assert_eq!(bench.watch.wrong(bench.now), None);
    }

    #[test]
    fn pictures_that_are_all_black_are_black_and_frozen_only_when_none_comes() {
        let mut bench = Fixture::new();
        bench.frame(100, [64, 48]);
        for _ in 0..30 {
            bench.come(b"dark", Ok(&image(0, [64, 48])));
            assert_eq!(bench.watch.wrong(bench.now), Some(FrameFault::Black));
        }
        let wrong = bench.watch.wrong(bench.now + FROZEN);
        assert!(matches!(wrong, Some(FrameFault::Frozen(_))), "{wrong:?}");
    }

    #[test]
    fn a_late_picture_is_told_by_the_cameras_own_stamps() {
        let mut bench = Fixture::new();
        let mut come = |late_ms: u64, stamp_s: f64| {
            bench.now += PERIOD;
            bench.count = bench.count.wrapping_add(1);
            let arrived = bench.now + Duration::from_millis(late_ms);
            bench.watch.arrived(&CompressedFrame::jpeg(vec![bench.count], arrived, Some(stamp_s)));
            bench.watch.decoded(bench.now, Ok(&image(100, [64, 48])));
            bench.watch.wrong(bench.now + Duration::from_millis(late_ms))
        };
        let stamp_s = |number: u32| 1e6 + 0.033 * f64::from(number);
        for number in 0..100 {
            assert_eq!(come(u64::from(number % 3), stamp_s(number)), None);
        }
        let report = come(300, stamp_s(100));
        assert!(matches!(report, Some(FrameFault::Late(late)) if late.as_millis().abs_diff(300) < 5), "{report:?}");
    }

    #[test]
    fn on_one_clock_a_picture_is_late_from_the_first_one_on() {
        let mut watch = FrameWatch::new(None);
        watch.opened(false);
        let now = Instant::now();
        let mut compressed = CompressedFrame::jpeg(b"one".to_vec(), now + Duration::from_millis(250), None);
        compressed.taken = Some(now);
        watch.arrived(&compressed);
        watch.decoded(compressed.arrived, Ok(&image(100, [8, 8])));
        assert_eq!(watch.wrong(compressed.arrived), Some(FrameFault::Late(Duration::from_millis(250))));
    }

    #[test]
    fn pictures_that_are_not_compressed_differ_by_the_noise_of_their_sensor() {
        let size_px = [64, 64];
        let layout = crate::PixelLayout::Yuyv;
        let raw = crate::RawLayout { layout, colours: crate::Colours::usual(size_px), size_px, stride: 128 };
        let mut compressed = CompressedFrame::jpeg(vec![90; raw.bytes()], Instant::now(), None);
        compressed.format = Format::Raw(raw);
        let before = hash(&compressed);
        assert_eq!(hash(&compressed.clone()), before);
        let mut random = fastrand::Rng::with_seed(3);
        compressed.bytes.iter_mut().for_each(|byte| *byte += random.u8(..2));
        assert_ne!(hash(&compressed), before);
    }

    #[test]
    fn a_still_picture_is_not_frozen() {
        let mut watch = FrameWatch::new(None);
        watch.opened(true);
        let now = Instant::now();
        watch.arrived(&CompressedFrame::jpeg(b"one".to_vec(), now, None));
        watch.decoded(now, Ok(&image(100, [8, 8])));
        assert_eq!(watch.wrong(now + Duration::from_mins(1)), None);
    }
}
