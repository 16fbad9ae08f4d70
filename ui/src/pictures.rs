//! Endoscope images on their way to a session.

use std::time::Instant;

use nima_endoscope::{Address, Compressed, Feed, Format, Reel, ReelEnd, Standing};
use nima_machine::config::RigConfig;
use nima_session::{
    pictures::{Coding, PictureSource, Taken},
    recorder::Recorder,
};

/// Passes the images of a queue to a recording.
#[derive(Debug)]
struct OfEndoscope(ReelEnd);

impl PictureSource for OfEndoscope {
    fn picture(&mut self) -> Option<Taken> {
        let Compressed { format, bytes, arrived, stamp_s, .. } = self.0.take()?;
        // The queue contains only compressed images.
        let coding = if matches!(format, Format::H264 { .. }) { Coding::H264 } else { Coding::Jpeg };
        Some(Taken { arrived, camera_s: stamp_s, coding, data: bytes })
    }

    fn dropped(&self) -> u64 {
        self.0.dropped()
    }
}

/// Whether the rig has an endoscope whose images are recorded.
pub(crate) fn are_recorded(rig: &RigConfig) -> bool {
    rig.endoscope.as_ref().is_some_and(|endoscope| endoscope.record)
}

/// Lets the recording of a loop on this rig take the images of this queue, if they are to be recorded.
pub(crate) fn film(recorder: &Recorder, rig: &RigConfig, reel: &Reel) {
    if are_recorded(rig) {
        recorder.film(Box::new(OfEndoscope(reel.end())));
    }
}

/// Reads the images for a recording or for viewers, without showing them.
#[derive(Debug)]
pub(crate) struct Filming {
    feed: Option<Feed>,
    /// Reason why there are no images.
    refused: Option<String>,
}

impl Filming {
    /// Starts to put the images of this rig into this queue; the recording, if given, takes them if they are to be recorded.
    pub(crate) fn start(recorder: Option<&Recorder>, rig: &RigConfig, reel: &Reel) -> Option<Self> {
        let endoscope = rig.endoscope.as_ref()?;
        let size_px = endoscope.camera.map(|camera| camera.size_px);
        let started = endoscope.url.parse::<Address>().map_err(|error| error.to_string());
        let started =
            started.and_then(|address| Feed::start(address, size_px, || ()).map_err(|error| error.to_string()));
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

    /// Reason why no images are recorded now.
    pub(crate) fn trouble(&self) -> Option<String> {
        let lost = || match self.feed.as_ref()?.standing(Instant::now()) {
            Standing::Lost(trouble) => Some(format!("{trouble}: {}", trouble.cure())),
            _ => None,
        };
        self.refused.clone().or_else(lost)
    }
}
