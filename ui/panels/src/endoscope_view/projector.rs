//! The recorded image of a moment: found and decoded on a separate thread, which serves only the newest request.

use std::{
    path::{Path, PathBuf},
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        mpsc::{Receiver, Sender, channel},
    },
    thread::Builder,
    time::Duration,
};

use nalgebra::Isometry3;
use nima_endoscope::{Damage, DecodedImage, FROZEN, FeedSnapshot, FrameFault, FrameHealth, Tone, h264, jpeg, steadied};
use nima_machine::rig::{SIDES, Side};
use nima_session::{
    images::{ImageCoding, RecordedImage, SessionImages},
    plot_channels::{self, PlottedError},
};
use nima_words::{language, report_text::chain, text};

use super::{mount::STEADY_S, poses::TipPose};

/// The tip pose of an image comes from the last tick before it, within this time, ns.
const TICK_NS: u64 = 20_000_000;

/// Maximum number of consecutive damaged images before a whole one is searched for.
const TRIED_MAX: usize = 10;

/// Result of the thread for a moment.
#[derive(Clone, Debug)]
pub(super) struct ProjectedMoment {
    /// The requested moment, and the time of its image, s; `None`: no image.
    pub(super) asked_s: f64,
    pub(super) came_s: Option<f64>,
    /// The last decodable image at that time, and its number.
    image: Option<(u64, Arc<DecodedImage>)>,
    damage: Option<Damage>,
    /// Tips and forces at the time of the image.
    pub(super) poses: [Option<TipPose>; SIDES],
    /// Pose of the endoscope's marker at the time of the image, if known.
    pub(super) world_from_n: Option<Isometry3<f64>>,
    /// Reason why the session cannot be read there.
    trouble: Option<String>,
}

/// The window's end of the thread; dropping it ends the thread.
#[derive(Debug)]
pub(super) struct Projector {
    wishes: Sender<(Tone, f64)>,
    asked: (Tone, f64),
    found: Arc<Mutex<Option<ProjectedMoment>>>,
}

fn locked(found: &Mutex<Option<ProjectedMoment>>) -> MutexGuard<'_, Option<ProjectedMoment>> {
    found.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Projector {
    /// Opens the images of a session; `wake` is called when a new one is ready.
    pub(super) fn start(session: &Path, wake: impl Fn() + Send + 'static) -> Self {
        let (wishes, wanted) = channel();
        let found = Arc::default();
        let session = session.to_path_buf();
        let report = Arc::clone(&found);
        let work = move || {
            let mut reel = match SessionImages::open(&session) {
                Ok(Some(images)) => Projection::of(images, session),
                Ok(None) => return,
                Err(error) => {
                    *locked(&report) = Some(ProjectedMoment::trouble(0.0, chain(&error)));
                    return wake();
                }
            };
            while let Some((tone, t_s)) = newest(&wanted) {
                if reel.tone != tone {
                    reel.tone = tone;
                    reel.shown = None;
                }
                let found = reel.find(t_s);
                *locked(&report) = Some(found);
                wake();
            }
        };
        // If no thread can be created, no image is shown.
        Builder::new().name("projector".to_owned()).spawn(language::carried(work)).ok();
        Self { wishes, asked: (Tone::default(), f64::NAN), found }
    }

    /// Requests the image of this moment, s since the start of the session.
    pub(super) fn show(&mut self, tone: Tone, t_s: f64) {
        if self.asked != (tone, t_s) {
            self.asked = (tone, t_s);
            self.wishes.send(self.asked).ok();
        }
    }

    pub(super) fn found(&self) -> Option<ProjectedMoment> {
        locked(&self.found).clone()
    }
}

/// Waits for the newest request. `None` after the window has closed.
fn newest(wanted: &Receiver<(Tone, f64)>) -> Option<(Tone, f64)> {
    let first = wanted.recv().ok()?;
    Some(wanted.try_iter().last().unwrap_or(first))
}

impl ProjectedMoment {
    const fn trouble(asked_s: f64, why: String) -> Self {
        let image = None;
        let damage = None;
        let came_s = None;
        Self { asked_s, came_s, image, damage, poses: [None; SIDES], world_from_n: None, trouble: Some(why) }
    }

    /// Returns the result as from a feed at that moment; an error if there is no image.
    pub(super) fn look(&self) -> Result<FeedSnapshot<Arc<DecodedImage>>, Option<&str>> {
        let Some(came_s) = self.came_s.filter(|_| self.image.is_some() || self.damage.is_some()) else {
            return Err(self.trouble.as_deref());
        };
        let age = Duration::from_secs_f64((self.asked_s - came_s).max(0.0));
        let standing = match &self.damage {
            Some(damage) => FrameHealth::Wrong(FrameFault::Damaged(damage.clone())),
            None if age > FROZEN => FrameHealth::Wrong(FrameFault::Frozen(age)),
            None => FrameHealth::Live,
        };
        let image = self.image.clone();
        Ok(FeedSnapshot { image, standing, age: Some(age), rate_hz: 0.0, work: Duration::ZERO })
    }
}

struct Projection {
    images: SessionImages,
    session: PathBuf,
    /// The last decoded image, and its time, ns.
    shown: Option<(u64, ProjectedMoment)>,
    number: u64,
    tone: Tone,
    stream: ProjectorStream,
}

/// A stream's decoder, and the image at its position, ns.
#[derive(Default)]
struct ProjectorStream {
    decoder: h264::H264Decoder,
    stands_ns: Option<u64>,
}

impl ProjectorStream {
    /// Shows the image of this time: decodes all images that it depends on.
    fn show(&mut self, images: &SessionImages, time_ns: u64) -> Result<DecodedImage, Damage> {
        let damaged = |reason: String| Damage::Undecodable { reason };
        let units = images.leading_to(time_ns, self.stands_ns, h264::is_key);
        let units = units.map_err(|error| damaged(chain(&error)))?;
        let mut shown = Err(damaged(text::endoscope_view::BASE_MISSING.get().to_owned()));
        self.stands_ns = None;
        for (left, unit) in (0..units.len()).rev().zip(&units) {
            match self.decoder.take(&unit.data, h264::is_key(&unit.data), left == 0) {
                Ok(taken) => {
                    if let Some(image) = taken.and_then(|taken| taken.image) {
                        shown = Ok(image);
                    }
                }
                Err(damage) => shown = Err(damage),
            }
        }
        self.stands_ns = shown.is_ok().then_some(time_ns);
        shown
    }
}

impl Projection {
    fn of(images: SessionImages, session: PathBuf) -> Self {
        let tone = Tone::default();
        let stream = ProjectorStream::default();
        Self { images, session, shown: None, number: 0, tone, stream }
    }

    fn find(&mut self, t_s: f64) -> ProjectedMoment {
        let recorded = match self.images.at(t_s) {
            Ok(Some(recorded)) => recorded,
            Ok(None) => return ProjectedMoment { trouble: None, ..ProjectedMoment::trouble(t_s, String::new()) },
            Err(error) => return ProjectedMoment::trouble(t_s, chain(&error)),
        };
        if let Some((_, shown)) = self.shown.as_ref().filter(|(time_ns, _)| *time_ns == recorded.time_ns) {
            return ProjectedMoment { asked_s: t_s, ..shown.clone() };
        }
        let found = self.decoded(t_s, &recorded);
        self.shown = Some((recorded.time_ns, found.clone()));
        found
    }

    fn decoded(&mut self, t_s: f64, recorded: &RecordedImage) -> ProjectedMoment {
        let came_s = recorded.time_ns.saturating_sub(self.images.begin_ns()) as f64 / 1e9;
        let decoded = match recorded.coding {
            ImageCoding::Jpeg => jpeg::decode(&recorded.data),
            ImageCoding::H264 => self.stream.show(&self.images, recorded.time_ns),
        };
        let (image, damage) = match (decoded, recorded.coding) {
            (Ok(image), _) => (Some(image), None),
            (Err(damage), ImageCoding::Jpeg) => (self.whole_before(recorded.time_ns), Some(damage)),
            (Err(damage), ImageCoding::H264) => (None, Some(damage)),
        };
        let image = image.map(|mut image| {
            self.tone.apply(&mut image);
            self.number += 1;
            (self.number, Arc::new(image))
        });
        let poses = self.poses(recorded.time_ns);
        let world_from_n = self.marker(recorded.time_ns);
        ProjectedMoment { asked_s: t_s, came_s: Some(came_s), image, damage, poses, world_from_n, trouble: None }
    }

    /// Shows the last intact image instead of a damaged one, as during the recording.
    fn whole_before(&mut self, time_ns: u64) -> Option<DecodedImage> {
        let mut before_ns = time_ns;
        for _ in 0..TRIED_MAX {
            let t_s = before_ns.saturating_sub(self.images.begin_ns()).checked_sub(1)? as f64 / 1e9;
            let recorded = self.images.at(t_s).ok()??;
            if let Ok(image) = jpeg::decode(&recorded.data) {
                return Some(image);
            }
            before_ns = recorded.time_ns.min(before_ns - 1);
        }
        None
    }

    /// Returns the pose of the endoscope's marker at that time.
    fn marker(&self, time_ns: u64) -> Option<Isometry3<f64>> {
        let times_ns = time_ns.saturating_sub((STEADY_S * 1e9) as u64)..time_ns.saturating_add(1);
        steadied(plot_channels::endoscope(self.images.reader(), times_ns).into_iter().rev())
    }

    /// Returns the poses of the tips at that time; none if they are not recorded or cannot be read.
    fn poses(&self, time_ns: u64) -> [Option<TipPose>; SIDES] {
        let reader = self.images.reader();
        let times_ns = time_ns.saturating_sub(TICK_NS)..time_ns.saturating_add(1);
        Side::ALL.map(|side| {
            let mut pose = None;
            let read = plot_channels::each_tick(reader, &self.session, side, times_ns.clone(), |tick| {
                let measured_n = Some(tick.measured_n).filter(|force_n| force_n.iter().all(|x| x.is_finite()));
                pose = Some(TipPose { tip_m: tick.tip_m, measured_n });
                Ok::<_, PlottedError>(())
            });
            read.ok().and(pose)
        })
    }
}
