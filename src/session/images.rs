//! The endoscope images in a session: unmodified from the camera, with the loop's time of their arrival.
//!
//! They are not an input of the loop, so the journal and its replay do not include them. A [`RecordedImageSource`] provides
//! them for the recording; [`SessionImages`] reads them back.

use std::{fmt::Debug, ops::Range, path::Path, time::Instant};

use nima_recording::{
    messages::foxglove::{CompressedImage, CompressedVideo},
    session::{ChannelId, ReadError, SessionMessage, SessionReader},
};
use prost::Message as _;
use serde::{Deserialize, Serialize};

use crate::plot_channels::beginning_ns;

/// Topic of independent images.
pub const IMAGE_TOPIC: &str = "endoscope/picture";
/// Topic of a video stream, whose frames refer to earlier ones.
pub const VIDEO_TOPIC: &str = "endoscope/video";
/// Topic of the properties of each image.
pub const IMAGE_FIGURES_TOPIC: &str = "endoscope/figures";
/// Message type of that topic.
pub(crate) const FIGURES_NAME: &str = "nima.PictureFigures";
pub(crate) const FIGURES_SCHEMA: &str = r#"{
  "title": "nima.PictureFigures",
  "description": "A picture of the endoscope. The time of the message is that of the picture's arrival, on the loop's clock",
  "type": "object",
  "properties": {
    "number": {"type": "integer", "description": "Pictures before it in this session"},
    "bytes": {"type": "integer"},
    "dropped": {"type": "integer", "description": "Pictures that were not recorded so far, because the disk was too slow or the camera too fast"},
    "camera_s": {"type": "number", "description": "The camera's own stamp, s since some moment of its own; left out where it sends none"}
  },
  "required": ["number", "bytes", "dropped"]
}"#;

/// Images are searched this far back, ns; an older image would have been frozen for too long.
const BACK_NS: u64 = 2_000_000_000;
/// Images are read this far ahead, ns, so that playback does not search the session for every image.
const AHEAD_NS: u64 = 500_000_000;

/// Maximum distance to a key frame before the requested frame, ns. Cameras send a key frame every second or two, some
/// every ten.
const LEAD_NS: u64 = 12_000_000_000;
/// A decoder continues over at most this gap, ns, instead of restarting at a key frame.
const GOES_ON_NS: u64 = 1_000_000_000;

/// Compression of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImageCoding {
    /// JPEG: an independent image.
    Jpeg,
    /// H.264, annex B: a frame may refer to earlier ones.
    H264,
}

impl ImageCoding {
    /// Returns the name that Foxglove uses.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Jpeg => "jpeg",
            Self::H264 => "h264",
        }
    }
}

/// An image to be recorded.
#[derive(Clone, Debug)]
pub struct PendingImage {
    /// Arrival of its last byte.
    pub arrived: Instant,
    /// The camera's own time stamp, s, from an arbitrary origin.
    pub camera_s: Option<f64>,
    pub coding: ImageCoding,
    /// Whether a decoder can begin with it: a JPEG, or a key frame of a stream.
    pub is_key: bool,
    /// Unmodified from the camera.
    pub data: Vec<u8>,
}

/// Provides images for a recording. Called on the recorder's thread; must not wait, and must bound its queue.
pub trait RecordedImageSource: Send + Debug {
    /// Returns the next image, in the order of arrival.
    fn image(&mut self) -> Option<PendingImage>;

    /// Returns how many images have been dropped so far because the recording was too slow.
    fn dropped(&self) -> u64;
}

/// Properties of a recorded image.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ImageFigures {
    /// Number of earlier images in this session.
    pub number: u64,
    /// Size.
    pub bytes: u64,
    /// Images that were not recorded so far.
    pub dropped: u64,
    /// The camera's own time stamp, s, from an arbitrary origin.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub camera_s: Option<f64>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RecordedImage {
    /// Arrival, ns since 1970, like all times of a session.
    pub time_ns: u64,
    pub coding: ImageCoding,
    /// Unmodified from the camera.
    pub data: Vec<u8>,
}

/// Converts this computer's time to the loop's time. Estimated from the arrival of ticks; the smallest delay counts.
#[derive(Debug, Default)]
pub(crate) struct ImageLoopClock {
    begin: Option<Instant>,
    /// This computer's time minus the loop's, s, and when it was last observed, s.
    offset_s: Option<(f64, f64)>,
}

/// The loop's clock may run slower than the computer's by this factor.
const DRIFT: f64 = 1e-3;

impl ImageLoopClock {
    /// Notes the arrival of a tick of this time (s).
    pub(crate) fn note(&mut self, t_s: f64, now: Instant) {
        let now_s = now.duration_since(*self.begin.get_or_insert(now)).as_secs_f64();
        let offset_s = now_s - t_s;
        let min_s = self.offset_s.map_or(offset_s, |(min_s, at_s)| offset_s.min(min_s + DRIFT * (now_s - at_s)));
        self.offset_s = Some((min_s, now_s));
    }

    /// Returns the loop's time of a moment, s; negative before the loop's start.
    pub(crate) fn at(&self, moment: Instant) -> Option<f64> {
        let begin = self.begin?;
        let (offset_s, _) = self.offset_s?;
        let since_s = match moment.checked_duration_since(begin) {
            Some(since) => since.as_secs_f64(),
            None => -begin.duration_since(moment).as_secs_f64(),
        };
        Some(since_s - offset_s)
    }
}

pub fn are_recorded(reader: &SessionReader) -> bool {
    let is_one = |topic: &str| [IMAGE_TOPIC, VIDEO_TOPIC].contains(&topic);
    reader.channels().iter().any(|channel| is_one(&channel.topic) && channel.messages != Some(0))
}

/// The images of a session by time. Caches those around the last requested one.
pub struct SessionImages {
    reader: SessionReader,
    begin_ns: u64,
    /// The channel of the video stream, if there is one.
    video: Option<ChannelId>,
    kept: Vec<SessionMessage>,
    /// Range of the cached times, ns.
    times_ns: Range<u64>,
}

impl Debug for SessionImages {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Pictures").field("kept", &self.kept.len()).finish_non_exhaustive()
    }
}

impl SessionImages {
    /// Opens the session separately; `None` if it has no images.
    ///
    /// # Errors
    /// [`ReadError`] if it cannot be read.
    pub fn open(path: &Path) -> Result<Option<Self>, ReadError> {
        let reader = SessionReader::open(path)?;
        if !are_recorded(&reader) {
            return Ok(None);
        }
        let begin_ns = beginning_ns(&reader)?;
        let video = reader.channels().iter().find(|channel| channel.topic == VIDEO_TOPIC).map(|channel| channel.id);
        Ok(Some(Self { reader, begin_ns, video, kept: Vec::new(), times_ns: 0..0 }))
    }

    /// Returns the start of the session, ns.
    pub const fn begin_ns(&self) -> u64 {
        self.begin_ns
    }

    pub const fn reader(&self) -> &SessionReader {
        &self.reader
    }

    /// Returns the newest image at this time (s since the start of the session), if it is at most two seconds old.
    ///
    /// # Errors
    /// [`ReadError`] if it cannot be read. Later images can be requested all the same.
    pub fn at(&mut self, t_s: f64) -> Result<Option<RecordedImage>, ReadError> {
        let time_ns = self.begin_ns + (t_s.max(0.0) * 1e9).round() as u64;
        let wanted_ns = time_ns.saturating_sub(BACK_NS)..time_ns.saturating_add(1);
        if wanted_ns.start < self.times_ns.start || wanted_ns.end > self.times_ns.end {
            let times_ns = wanted_ns.start..wanted_ns.end.saturating_add(AHEAD_NS);
            self.times_ns = 0..0;
            self.kept =
                self.reader.messages(&[IMAGE_TOPIC, VIDEO_TOPIC], times_ns.clone()).collect::<Result<_, _>>()?;
            self.times_ns = times_ns;
        }
        let newest = self.kept.partition_point(|message| message.log_time_ns() <= time_ns);
        let newest = newest.checked_sub(1).and_then(|newest| self.kept.get(newest));
        Ok(newest.filter(|message| wanted_ns.contains(&message.log_time_ns())).and_then(|message| self.read(message)))
    }

    /// Returns the frames that a decoder needs to show the frame of this time, which is the last of them: those from
    /// the last key frame on (`is_key` detects key frames), or those after `known_ns`, the decoder's position, if that
    /// is shortly before. Empty if the frame cannot be shown.
    ///
    /// # Errors
    /// [`ReadError`] if they cannot be read.
    pub fn leading_to(
        &self,
        time_ns: u64,
        known_ns: Option<u64>,
        is_key: impl Fn(&[u8]) -> bool,
    ) -> Result<Vec<RecordedImage>, ReadError> {
        let goes_on = known_ns.filter(|known_ns| *known_ns < time_ns && time_ns - known_ns <= GOES_ON_NS);
        let from_ns = goes_on.map_or(time_ns.saturating_sub(LEAD_NS), |known_ns| known_ns + 1);
        let messages = self.reader.messages(&[VIDEO_TOPIC], from_ns..time_ns.saturating_add(1));
        let read = messages.filter_map(|message| message.map(|message| self.read(&message)).transpose());
        let mut images = read.collect::<Result<Vec<_>, _>>()?;
        if goes_on.is_none() {
            match images.iter().rposition(|image| is_key(&image.data)) {
                Some(first) => drop(images.drain(..first)),
                None => images.clear(),
            }
        }
        Ok(images)
    }

    /// Returns the image of a message; `None` if a message of another program is not an image.
    fn read(&self, message: &SessionMessage) -> Option<RecordedImage> {
        let time_ns = message.log_time_ns();
        if Some(message.channel()) == self.video {
            let CompressedVideo { data, format, .. } = CompressedVideo::decode(message.data()).ok()?;
            return (format == ImageCoding::H264.name()).then(|| RecordedImage {
                time_ns,
                coding: ImageCoding::H264,
                data: data.into(),
            });
        }
        let CompressedImage { data, .. } = CompressedImage::decode(message.data()).ok()?;
        Some(RecordedImage { time_ns, coding: ImageCoding::Jpeg, data: data.into() })
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    #[test]
    fn a_moment_has_its_time_of_the_loop_however_late_ticks_are_known() {
        let begin = Instant::now();
        let mut clock = ImageLoopClock::default();
        assert_eq!(clock.at(begin), None);
        for tick in 0..3000_u32 {
            // The disk delayed the thread by half a second; the loop began 2 s before its first tick was seen here.
            let late = if (1000..1500).contains(&tick) { 1500 - tick } else { tick % 3 };
            clock.note(f64::from(tick) * 1e-3, begin + Duration::from_millis(u64::from(2000 + tick + late)));
        }
        for t_s in [0.5, 1.2, 2.9] {
            let at_s = clock.at(begin + Duration::from_secs_f64(2.0 + t_s)).unwrap();
            assert!((at_s - t_s).abs() < 3e-3, "{at_s} s, not {t_s} s");
        }
        assert!(clock.at(begin).unwrap() < -1.9, "before the loop began");
    }
}
