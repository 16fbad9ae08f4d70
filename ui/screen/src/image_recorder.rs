//! Endoscope images on their way to a session.

use std::time::Instant;

use nima_endoscope::{Address, CompressedFrame, EndoscopeFeed, Format, FrameHealth, FrameQueue, ReelEnd};
use nima_machine::config::RigConfig;
use nima_session::{
    images::{ImageCoding, PendingImage, RecordedImageSource},
    recorder::SessionRecorder,
};

/// Passes the images of a queue to a recording.
#[derive(Debug)]
struct OfEndoscope(ReelEnd);

impl RecordedImageSource for OfEndoscope {
    fn image(&mut self) -> Option<PendingImage> {
        let CompressedFrame { format, bytes, arrived, stamp_s, .. } = self.0.take()?;
        // The queue contains only compressed images.
        let (coding, is_key) = match format {
            Format::H264 { is_key } => (ImageCoding::H264, is_key),
            Format::Jpeg | Format::Raw(_) => (ImageCoding::Jpeg, true),
        };
        Some(PendingImage { arrived, camera_s: stamp_s, coding, is_key, data: bytes })
    }

    fn dropped(&self) -> u64 {
        self.0.dropped()
    }
}

/// Returns whether the rig has an endoscope whose images are recorded.
pub fn are_recorded(rig: &RigConfig) -> bool {
    rig.endoscope.as_ref().is_some_and(|endoscope| endoscope.record)
}

/// Lets the recording of a loop on this rig take the images from this queue, if they are to be recorded.
pub fn film(recorder: &SessionRecorder, rig: &RigConfig, reel: &FrameQueue) {
    if are_recorded(rig) {
        recorder.film(Box::new(OfEndoscope(reel.end())));
    }
}

/// Reads the images for a recording or for viewers, without showing them.
#[derive(Debug)]
pub struct ImageRecorder {
    feed: Option<EndoscopeFeed>,
    /// Reason why there are no images.
    refused: Option<String>,
}

impl ImageRecorder {
    /// Starts to put the images of this rig into this queue; the recording, if given, takes them if they are to be recorded.
    pub fn start(recorder: Option<&SessionRecorder>, rig: &RigConfig, reel: &FrameQueue) -> Option<Self> {
        let endoscope = rig.endoscope.as_ref()?;
        let size_px = endoscope.camera.map(|camera| camera.size_px);
        let started = endoscope.url.parse::<Address>().map_err(|error| error.to_string());
        let started = started
            .and_then(|address| EndoscopeFeed::start(address, size_px, || ()).map_err(|error| error.to_string()));
        let (feed, refused) = match started {
            Ok(feed) => (Some(feed), None),
            Err(why) => (None, Some(why)),
        };
        if let Some(feed) = &feed {
            feed.record_to(reel.clone());
            if let Some(recorder) = recorder {
                film(recorder, rig, reel);
            }
        }
        Some(Self { feed, refused })
    }

    /// Returns the reason why no images are recorded now.
    pub fn trouble(&self) -> Option<String> {
        let lost = || match self.feed.as_ref()?.standing(Instant::now()) {
            FrameHealth::Lost(trouble) => Some(format!("{trouble}: {}", trouble.cure())),
            _ => None,
        };
        self.refused.clone().or_else(lost)
    }
}
