//! The endoscope images in a session: recorded unmodified, at the loop's time of their arrival. They must not disturb
//! an excerpt, and must not be in an anonymous session.

use std::{
    path::Path,
    sync::atomic::AtomicBool,
    thread,
    time::{Duration, Instant, SystemTime, UNIX_EPOCH},
};

use nima_endoscope::{jpeg, time_code};
use nima_machine::runtime::{self, Assembly, tap};
use nima_recording::session::SessionReader;
use nima_session::{
    anonymous,
    images::{
        IMAGE_FIGURES_TOPIC, IMAGE_TOPIC, ImageCoding, ImageFigures, PendingImage, RecordedImage, RecordedImageSource,
        SessionImages, VIDEO_TOPIC,
    },
    plot_channels::beginning_ns,
    recorder::{RecordingProgress, SessionRecorder},
    report::SessionFigures,
    sinks::Destination,
    trim,
};
use nima_testing::real_time;
use nima_tests::plan;

use crate::file::about;

const SQUARE_PX: usize = 8;
const SIZE_PX: [usize; 2] = [256, 24];
const PERIOD: Duration = Duration::from_millis(33);

/// Delivers a current image every 33 ms, like a camera's reader, and also old ones from before the loop began.
#[derive(Debug)]
struct Camera {
    due: Instant,
    waiting: Vec<PendingImage>,
}

impl Camera {
    fn new() -> Self {
        // An image from a minute ago does not belong to this session.
        let before = Instant::now().checked_sub(Duration::from_mins(1)).map(|at| taken(at, 1));
        Self { due: Instant::now(), waiting: before.into_iter().collect() }
    }
}

fn taken(arrived: Instant, time_us: u64) -> PendingImage {
    let mut rgb = vec![90; 3 * SIZE_PX[0] * SIZE_PX[1]];
    time_code::draw(time_us, SQUARE_PX, &mut rgb, SIZE_PX[0]);
    let data = jpeg::encode(&rgb, SIZE_PX, 90);
    PendingImage { arrived, camera_s: Some(time_us as f64 * 1e-6), coding: ImageCoding::Jpeg, is_key: true, data }
}

impl RecordedImageSource for Camera {
    fn image(&mut self) -> Option<PendingImage> {
        if let Some(before) = self.waiting.pop() {
            return Some(before);
        }
        let now = Instant::now();
        if now < self.due {
            return None;
        }
        self.due = now + PERIOD;
        let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap();
        Some(taken(now, since.as_micros() as u64))
    }

    fn dropped(&self) -> u64 {
        3
    }
}

/// A camera that sends a stream: every tenth frame is a key frame.
#[derive(Debug)]
struct Streaming {
    due: Instant,
    number: u8,
}

const KEY_EVERY: u8 = 10;

fn is_key(data: &[u8]) -> bool {
    data[0].is_multiple_of(KEY_EVERY)
}

impl RecordedImageSource for Streaming {
    fn image(&mut self) -> Option<PendingImage> {
        let now = Instant::now();
        if now < self.due {
            return None;
        }
        self.due = now + PERIOD;
        self.number += 1;
        let data = vec![self.number - 1; 100];
        Some(PendingImage { arrived: now, camera_s: None, coding: ImageCoding::H264, is_key: is_key(&data), data })
    }

    fn dropped(&self) -> u64 {
        0
    }
}

/// Some seconds of a simulated rig on the real clock, with images.
fn record(path: &Path, camera: impl RecordedImageSource + 'static, seconds: u64) -> RecordingProgress {
    let _alone = real_time::alone();
    let plan = plan("peg_transfer");
    let (tap, end) = tap();
    let recorder = SessionRecorder::start(Destination::file(path), about(), plan.origin(), end).unwrap();
    recorder.film(Box::new(camera));
    let handle = runtime::start(Assembly { tap: Some(tap), ..plan.assembly().unwrap() }).unwrap();
    thread::sleep(Duration::from_secs(seconds));
    handle.stop_and_join().unwrap();
    recorder.finish().unwrap()
}

#[test]
fn pictures_are_recorded_as_they_came_at_the_loops_time_of_their_arrival() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("session.mcap");
    let progress = record(&path, Camera::new(), 3);
    let reader = SessionReader::open(&path).unwrap();
    let begin_ns = beginning_ns(&reader).unwrap();
    let figures: Vec<ImageFigures> = reader
        .messages(&[IMAGE_FIGURES_TOPIC], 0..u64::MAX)
        .map(|message| serde_json::from_slice(message.unwrap().data()).unwrap())
        .collect();
    assert!(figures.len() > 20, "{} pictures", figures.len());
    assert_eq!((progress.images, progress.images_dropped), (figures.len() as u64, 3));
    let mut images = SessionImages::open(&path).unwrap().unwrap();
    let mut offsets_s = Vec::new();
    let times_ns: Vec<u64> =
        reader.messages(&[IMAGE_TOPIC], 0..u64::MAX).map(|message| message.unwrap().log_time_ns()).collect();
    assert_eq!(times_ns.len(), figures.len());
    for (time_ns, report) in times_ns.iter().zip(&figures) {
        let t_s = (time_ns - begin_ns) as f64 / 1e9;
        let recorded = images.at(t_s).unwrap().unwrap();
        assert_eq!((recorded.time_ns, recorded.coding), (*time_ns, ImageCoding::Jpeg));
        assert_eq!(recorded.data.len() as u64, report.bytes);
        let decoded = jpeg::decode(&recorded.data).unwrap();
        let code_us = time_code::read(SQUARE_PX, |x, y| decoded.rgba[4 * (SIZE_PX[0] * y + x)]).unwrap();
        let stamp_miss_s = report.camera_s.unwrap() - code_us as f64 * 1e-6;
        assert!(stamp_miss_s.abs() < 1e-6, "the camera's own stamp is kept");
        offsets_s.push(code_us as f64 * 1e-6 - t_s);
        assert_eq!(
            images.at(t_s - 0.001).unwrap().map(|before| before.time_ns < *time_ns),
            Some(true).filter(|_| report.number > 0)
        );
    }
    // The loop's clock and the clock in the code differ by the loop's start time.
    offsets_s.sort_by(f64::total_cmp);
    let spread_s = offsets_s[offsets_s.len() - 1] - offsets_s[0];
    assert!(spread_s < PERIOD.as_secs_f64(), "{spread_s} s");

    let read = SessionFigures::read(&path).unwrap().images.unwrap();
    assert_eq!((read.count, read.dropped), (figures.len() as u64, 3));
    assert_eq!(read.bytes, figures.iter().map(|report| report.bytes).sum::<u64>());
    assert!(read.rate_hz().is_some_and(|rate_hz| (5.0..31.0).contains(&rate_hz)), "{read:?}");

    let part = folder.path().join("part.mcap");
    let asked = AtomicBool::new(false);
    let times_ns = begin_ns + 1_000_000_000..begin_ns + 2_000_000_000;
    trim::write(&reader, "session", &times_ns, &part, &asked).unwrap();
    let mut of_part = SessionImages::open(&part).unwrap().unwrap();
    assert_eq!(of_part.at(1.9).unwrap(), images.at(1.9).unwrap());
    assert_eq!(of_part.at(0.9).unwrap(), None);

    let shared = folder.path().join("shared.mcap");
    let known = anonymous::SessionFacts { program: "test", files: &[], words: about().words, devices: &[] };
    anonymous::write(&reader, &known, &(0..u64::MAX), &shared, &asked).unwrap();
    assert!(SessionImages::open(&shared).unwrap().is_none(), "a picture shows whose it is");
    assert!(
        SessionReader::open(&shared).unwrap().channels().iter().all(|channel| !channel.topic.contains("endoscope"))
    );
}

#[test]
fn a_stream_is_recorded_and_a_picture_comes_with_those_that_it_refers_to() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("session.mcap");
    record(&path, Streaming { due: Instant::now(), number: 0 }, 2);
    let reader = SessionReader::open(&path).unwrap();
    let begin_ns = beginning_ns(&reader).unwrap();
    let times_ns: Vec<u64> =
        reader.messages(&[VIDEO_TOPIC], 0..u64::MAX).map(|message| message.unwrap().log_time_ns()).collect();
    assert!(times_ns.len() > 15, "{} pictures", times_ns.len());
    let mut images = SessionImages::open(&path).unwrap().unwrap();
    // Images from before the loop's first tick do not belong to the session.
    let first = images.at((times_ns[0] - begin_ns) as f64 / 1e9).unwrap().unwrap().data[0];
    let numbers = |found: Vec<RecordedImage>| found.iter().map(|image| image.data[0]).collect::<Vec<u8>>();
    for (number, time_ns) in (first..).zip(&times_ns) {
        let newest = images.at((time_ns - begin_ns) as f64 / 1e9).unwrap().unwrap();
        assert_eq!((newest.time_ns, newest.coding, newest.data[0]), (*time_ns, ImageCoding::H264, number));
        let key = number - number % KEY_EVERY;
        let needed: Vec<u8> = if key < first { Vec::new() } else { (key..=number).collect() };
        assert_eq!(numbers(images.leading_to(*time_ns, None, is_key).unwrap()), needed);
        // A decoder that is three frames behind continues from there; one that is ahead, or far behind, restarts.
        if let Some(three_before) = usize::from(number - first).checked_sub(3) {
            let known_ns = Some(times_ns[three_before]);
            assert_eq!(
                numbers(images.leading_to(*time_ns, known_ns, is_key).unwrap()),
                [number - 2, number - 1, number]
            );
        }
        for known_ns in [time_ns + 1, time_ns.saturating_sub(1_500_000_000)] {
            assert_eq!(numbers(images.leading_to(*time_ns, Some(known_ns), is_key).unwrap()), needed);
        }
    }
    let read = SessionFigures::read(&path).unwrap().images.unwrap();
    assert_eq!((read.count, read.bytes), (times_ns.len() as u64, 100 * times_ns.len() as u64));
}
