//! The channels of the endoscope images: each image unmodified, and its properties.

use nima_recording::{
    messages::{
        foxglove::{self, CompressedImage, CompressedVideo, timestamp},
        json_encoding,
    },
    session::WriteError,
};
use prost::Message as _;
use tracing::warn;

use crate::{
    images::{
        FIGURES_NAME, FIGURES_SCHEMA, IMAGE_FIGURES_TOPIC, IMAGE_TOPIC, ImageCoding, ImageFigures, PendingImage,
        RecordedImageSource, VIDEO_TOPIC,
    },
    sinks::{FileChannel, SessionSinks, SinkChannel},
};

/// The frame of the images: its axes are the image axes.
const FRAME: &str = "endoscope";

/// Maximum rate of recorded images, 1/s, and how many may come at once: more than an endoscope sends, and few enough that
/// a wrong setting of a camera does not fill the disk.
const RATE_MAX_HZ: f64 = 120.0;
const AT_ONCE_MAX: f64 = 12.0;
/// Maximum rate of recorded bytes, 1/s: 4096 x 2160 pixels at 60 Hz with 1 bit each, for which a JPEG has excellent
/// quality (0.75 to 1.5 bits per pixel: Wallace, The JPEG still picture compression standard, CACM 34(4), 1991). H.264
/// needs less.
const BYTES_MAX_HZ: f64 = 4096.0 * 2160.0 * 60.0 / 8.0;
/// As many seconds of bytes may come at once as of images.
const BYTES_AT_ONCE_MAX: f64 = BYTES_MAX_HZ * AT_ONCE_MAX / RATE_MAX_HZ;

/// Writes the images of a source as soon as the loop's tick of their time has passed.
#[derive(Debug)]
pub(crate) struct ImageChannel {
    source: Box<dyn RecordedImageSource>,
    /// The image whose time has not been reached yet.
    waiting: Option<PendingImage>,
    images: Option<FileChannel>,
    video: Option<FileChannel>,
    figures: Option<SinkChannel>,
    number: u64,
    last_s: f64,
    /// Images and bytes that may be written now, and images that were left out because too many came. The last image
    /// may exceed the bytes; the later ones wait for it.
    room: f64,
    room_bytes: f64,
    left_out: u64,
    /// Whether images are left out, of a stream until its next key frame.
    skips: bool,
    /// Time of the first image that was left out, s, until it has been reported.
    excess_s: Option<f64>,
}

impl ImageChannel {
    pub(crate) fn new(source: Box<dyn RecordedImageSource>) -> Self {
        Self {
            source,
            waiting: None,
            images: None,
            video: None,
            figures: None,
            number: 0,
            last_s: 0.0,
            room: AT_ONCE_MAX,
            room_bytes: BYTES_AT_ONCE_MAX,
            left_out: 0,
            skips: false,
            excess_s: None,
        }
    }

    /// Returns the numbers of written and dropped images.
    pub(crate) fn counts(&self) -> [u64; 2] {
        [self.number, self.source.dropped() + self.left_out]
    }

    /// Returns once when the first image was left out because too many came, s.
    pub(crate) fn take_excess(&mut self) -> Option<f64> {
        self.excess_s.take()
    }

    /// Writes the images that arrived up to this time of the loop, s; `t_s_of` computes the time of an image, and
    /// `time_ns` the time of its message.
    pub(crate) fn until(
        &mut self,
        out: &mut SessionSinks,
        t_s: f64,
        t_s_of: impl Fn(&PendingImage) -> Option<f64>,
        time_ns: impl Fn(f64) -> u64,
    ) -> Result<(), WriteError> {
        while let Some(taken) = self.waiting.take().or_else(|| self.source.image()) {
            // Images from before the loop's first tick do not belong to the session.
            let Some(at_s) = t_s_of(&taken).filter(|at_s| *at_s >= 0.0) else { continue };
            if at_s > t_s {
                self.waiting = Some(taken);
                return Ok(());
            }
            // The estimated clock may be corrected slightly backwards.
            let before_s = self.last_s;
            self.last_s = self.last_s.max(at_s);
            let passed_s = self.last_s - before_s;
            self.room = (self.room + passed_s * RATE_MAX_HZ).min(AT_ONCE_MAX);
            self.room_bytes = (self.room_bytes + passed_s * BYTES_MAX_HZ).min(BYTES_AT_ONCE_MAX);
            let has_room = self.room >= 1.0 && self.room_bytes > 0.0;
            // The frames of a stream refer to earlier ones, so it continues only at a key frame.
            self.skips = !has_room || (self.skips && !taken.is_key);
            if self.skips {
                if self.left_out == 0 {
                    warn!("images are left out of the session: the camera sends too many or too large ones");
                    self.excess_s = Some(self.last_s);
                }
                self.left_out += 1;
                continue;
            }
            self.room -= 1.0;
            self.room_bytes -= taken.data.len() as f64;
            self.write(out, time_ns(self.last_s), taken)?;
        }
        Ok(())
    }

    fn write(&mut self, out: &mut SessionSinks, time_ns: u64, taken: PendingImage) -> Result<(), WriteError> {
        let PendingImage { arrived: _, camera_s, coding, is_key: _, data } = taken;
        let [number, dropped] = self.counts();
        let report =
            ImageFigures { number, bytes: data.len() as u64, dropped, camera_s: camera_s.filter(|s| s.is_finite()) };
        let timestamp = Some(timestamp(time_ns));
        let format = coding.name().to_owned();
        let frame_id = FRAME.to_owned();
        let data = data.into();
        match coding {
            ImageCoding::Jpeg => {
                let open = || out.file_channel(IMAGE_TOPIC, foxglove::encoding::<CompressedImage>());
                let channel = opened(&mut self.images, open)?;
                let image = CompressedImage { timestamp, data, format, frame_id };
                out.file_message(channel, time_ns, &image.encode_to_vec())?;
            }
            ImageCoding::H264 => {
                let open = || out.file_channel(VIDEO_TOPIC, foxglove::encoding::<CompressedVideo>());
                let channel = opened(&mut self.video, open)?;
                let frame = CompressedVideo { timestamp, frame_id, data, format };
                out.file_message(channel, time_ns, &frame.encode_to_vec())?;
            }
        }
        let open = || out.channel(IMAGE_FIGURES_TOPIC, json_encoding(FIGURES_NAME, FIGURES_SCHEMA));
        let figures = opened(&mut self.figures, open)?;
        self.number += 1;
        // Numbers and field names can always be serialised as JSON.
        let report = serde_json::to_vec(&report).unwrap_or_default();
        out.message(figures, time_ns, &report)
    }
}

/// A channel is opened by its first message.
fn opened<C: Copy>(channel: &mut Option<C>, open: impl FnOnce() -> Result<C, WriteError>) -> Result<C, WriteError> {
    match *channel {
        Some(channel) => Ok(channel),
        None => Ok(*channel.insert(open()?)),
    }
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use nima_recording::session::{SessionReader, SessionWriter};

    use super::*;

    /// Sends more than is recorded.
    #[derive(Clone, Copy, Debug)]
    struct Fast {
        coding: ImageCoding,
        rate_hz: f64,
        count: u32,
        key_every: u32,
        bytes: usize,
        sent: u32,
    }

    impl RecordedImageSource for Fast {
        fn image(&mut self) -> Option<PendingImage> {
            let Self { coding, rate_hz, count, key_every, bytes, sent } = *self;
            if sent == count {
                return None;
            }
            self.sent += 1;
            let mut data = vec![1; bytes];
            data[..4].copy_from_slice(&sent.to_le_bytes());
            let camera_s = Some(f64::from(sent) / rate_hz);
            let is_key = sent.is_multiple_of(key_every);
            Some(PendingImage { arrived: Instant::now(), camera_s, coding, is_key, data })
        }

        fn dropped(&self) -> u64 {
            0
        }
    }

    /// Records everything that the camera sends; returns the numbers of the written images.
    fn written(camera: Fast) -> Vec<u32> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("session.mcap");
        let mut out = SessionSinks::of(SessionWriter::create(&path, "test").unwrap());
        let mut channel = ImageChannel::new(Box::new(camera));
        channel.until(&mut out, 2.0, |taken| taken.camera_s, |t_s| (t_s * 1e9) as u64).unwrap();
        let [number, left_out] = channel.counts();
        assert_eq!(number + left_out, u64::from(camera.count), "{camera:?}");
        assert_eq!((channel.take_excess().is_some(), channel.take_excess()), (left_out > 0, None), "{camera:?}");
        out.finish().unwrap();
        let reader = SessionReader::open(&path).unwrap();
        let messages = reader.messages(&[IMAGE_TOPIC, VIDEO_TOPIC], 0..u64::MAX);
        let numbers: Vec<u32> = messages
            .map(|message| {
                let message = message.unwrap();
                let data = match camera.coding {
                    ImageCoding::Jpeg => CompressedImage::decode(message.data()).unwrap().data.to_vec(),
                    ImageCoding::H264 => CompressedVideo::decode(message.data()).unwrap().data.to_vec(),
                };
                u32::from_le_bytes(data[..4].try_into().unwrap())
            })
            .collect();
        assert_eq!(numbers.len() as u64, number, "{camera:?}");
        numbers
    }

    #[test]
    fn a_camera_that_sends_too_much_does_not_fill_the_disk() {
        let many = Fast { coding: ImageCoding::Jpeg, rate_hz: 2000.0, count: 2000, key_every: 1, bytes: 10, sent: 0 };
        let numbers = written(many);
        assert!((120..=133).contains(&numbers.len()), "{} images in 1 s", numbers.len());
        let large = Fast { rate_hz: 120.0, count: 30, bytes: 1_200_000, ..many };
        let bytes = written(large).len() * large.bytes;
        let seconds = f64::from(large.count) / large.rate_hz;
        let bytes_max = BYTES_AT_ONCE_MAX + BYTES_MAX_HZ * seconds + large.bytes as f64;
        assert!((bytes as f64) < bytes_max && bytes as f64 > BYTES_MAX_HZ * seconds, "{bytes} bytes in {seconds} s");
        let usual = Fast { rate_hz: 60.0, count: 30, bytes: 500_000, ..many };
        assert_eq!(written(usual).len(), 30);
    }

    #[test]
    fn a_stream_that_sends_too_much_is_continued_at_its_key_frames() {
        let many = Fast { coding: ImageCoding::H264, rate_hz: 2000.0, count: 2000, key_every: 100, bytes: 10, sent: 0 };
        let large = Fast { rate_hz: 100.0, count: 50, key_every: 10, bytes: 1_500_000, ..many };
        for camera in [many, large] {
            let numbers = written(camera);
            let seconds = f64::from(camera.count) / camera.rate_hz;
            assert!(numbers.len() as f64 <= RATE_MAX_HZ * seconds + AT_ONCE_MAX + 1.0, "{numbers:?}");
            let bytes = (numbers.len() * camera.bytes) as f64;
            assert!(bytes < BYTES_AT_ONCE_MAX + BYTES_MAX_HZ * seconds + camera.bytes as f64, "{bytes} bytes");
            // A frame without its predecessor cannot be shown.
            let continues = |pair: &[u32]| pair[1] == pair[0] + 1 || pair[1].is_multiple_of(camera.key_every);
            assert!(numbers[0] == 0 && numbers.windows(2).all(continues), "{numbers:?}");
            assert!(numbers.iter().filter(|number| number.is_multiple_of(camera.key_every)).count() > 2, "{numbers:?}");
        }
    }
}
