//! The channels of the endoscope images: each image unmodified, and its properties.

use nima_recording::{
    messages::{
        foxglove::{self, CompressedImage, CompressedVideo, timestamp},
        json_encoding,
    },
    session::WriteError,
};
use prost::Message as _;

use crate::{
    images::{
        FIGURES_NAME, FIGURES_SCHEMA, IMAGE_FIGURES_TOPIC, IMAGE_TOPIC, ImageCoding, ImageFigures, PendingImage,
        RecordedImageSource, VIDEO_TOPIC,
    },
    sinks::{FileChannel, SessionSinks, SinkChannel},
};

/// The frame of the images: its axes are the image axes.
const FRAME: &str = "endoscope";

/// Maximum rate of recorded images, and how many may come at once: more than an endoscope sends, and few enough that a
/// wrong setting of a camera does not fill the disk.
const RATE_MAX_HZ: f64 = 120.0;
const AT_ONCE_MAX: f64 = 12.0;

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
    /// Images that may be written now, and that were left out because too many came.
    room: f64,
    left_out: u64,
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
            left_out: 0,
        }
    }

    /// Returns the numbers of written and dropped images.
    pub(crate) fn counts(&self) -> [u64; 2] {
        [self.number, self.source.dropped() + self.left_out]
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
            self.room = (self.room + (self.last_s - before_s) * RATE_MAX_HZ).min(AT_ONCE_MAX);
            // The frames of a video refer to each other, so none is left out.
            if self.room < 1.0 && taken.coding == ImageCoding::Jpeg {
                self.left_out += 1;
                continue;
            }
            self.room -= 1.0;
            self.write(out, time_ns(self.last_s), taken)?;
        }
        Ok(())
    }

    fn write(&mut self, out: &mut SessionSinks, time_ns: u64, taken: PendingImage) -> Result<(), WriteError> {
        let PendingImage { arrived: _, camera_s, coding, data } = taken;
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

    use nima_recording::session::SessionWriter;

    use super::*;

    /// Sends two thousand images in a second.
    #[derive(Debug)]
    struct Fast(u32, ImageCoding);

    impl RecordedImageSource for Fast {
        fn image(&mut self) -> Option<PendingImage> {
            let number = self.0;
            self.0 += 1;
            let camera_s = Some(f64::from(number) * 5e-4);
            let image = PendingImage { arrived: Instant::now(), camera_s, coding: self.1, data: vec![1; 10] };
            (number < 2000).then_some(image)
        }

        fn dropped(&self) -> u64 {
            0
        }
    }

    #[test]
    fn a_camera_that_sends_too_much_does_not_fill_the_disk() {
        let folder = tempfile::tempdir().unwrap();
        for (coding, written) in [(ImageCoding::Jpeg, 120..=133), (ImageCoding::H264, 2000..=2000)] {
            let file = SessionWriter::create(&folder.path().join(coding.name()), "test").unwrap();
            let mut out = SessionSinks::of(file);
            let mut channel = ImageChannel::new(Box::new(Fast(0, coding)));
            channel.until(&mut out, 2.0, |taken| taken.camera_s, |t_s| (t_s * 1e9) as u64).unwrap();
            let [number, left_out] = channel.counts();
            assert!(written.contains(&number) && number + left_out == 2000, "{number}, {left_out}");
        }
    }
}
