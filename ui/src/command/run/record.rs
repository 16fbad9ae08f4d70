//! `nima run --record`: the session file of a run; `--live`: its viewers.

use std::{
    ops::Range,
    path::PathBuf,
    time::{Duration, Instant},
};

use anyhow::Context as _;
use nima_endoscope::FrameQueue;
use nima_machine::runtime::{Tap, VirtualClock};
use nima_screen::{
    image_recorder::{ImageRecorder, are_recorded},
    recording::begin,
};
use nima_session::{
    disk_forecast::{DiskForecast, WARN_BEFORE},
    objects::ObjectSource,
    recorder::{RecordingProgress, SessionRecorder},
    sinks::Destination,
};
use nima_simulation::SimulationPlan;
use nima_words::report_text::disk_full_in;
use serde::Serialize;

/// A recording, if requested; without a file it has only viewers.
#[derive(Default)]
pub(super) struct RunRecording {
    recorder: Option<(SessionRecorder, Option<PathBuf>)>,
    outlook: Option<DiskForecast>,
    /// End of the run, if known.
    ends: Option<Instant>,
    /// Reads its endoscope images.
    filming: Option<ImageRecorder>,
    /// Messages already printed: ended, waiting for the disk, entries lost, disk full within a day, disk full within an hour,
    /// images missing, no images.
    report: [bool; 7],
}

/// Remaining time for the second warning of a full disk.
const WARN_AGAIN: Duration = Duration::from_hours(1);

/// A disk that does not respond for this long is reported, because entries are lost after 2 s.
const SLOW: Duration = Duration::from_secs(1);

/// Results of a recording.
#[derive(Serialize)]
pub(super) struct RecordingFigures {
    file: PathBuf,
    ticks: u64,
    lost: u64,
    bytes: u64,
    /// Number of recorded endoscope images, followed by the number of missing ones.
    #[serde(skip_serializing_if = "is_none")]
    #[serde(rename = "pictures")]
    images: u64,
    #[serde(skip_serializing_if = "is_none")]
    #[serde(rename = "pictures_dropped")]
    images_dropped: u64,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde requires a reference")]
const fn is_none(count: &u64) -> bool {
    *count == 0
}

impl RunRecording {
    /// Starts a recording; the tap is for the loop. A run on the real clock ends after `seconds`. The endoscope images come
    /// through `reel` if they are recorded or a viewer `watches` them.
    pub(super) fn begin(
        to: Destination<'_>,
        plan: &SimulationPlan,
        clock: Option<VirtualClock>,
        seconds: Option<f64>,
        (reel, watches): (&FrameQueue, bool),
    ) -> anyhow::Result<(Option<Tap>, Self)> {
        if to.file.is_none() && to.audiences.is_empty() {
            return Ok((None, Self::default()));
        }
        let file = to.file.map(ToOwned::to_owned);
        let (tap, recorder) = begin(to, plan, clock)?;
        let now = Instant::now();
        let outlook = file.as_deref().map(|file| DiskForecast::new(file, recorder.progress().bytes, now));
        let ends = seconds.and_then(|seconds| now.checked_add(Duration::from_secs_f64(seconds)));
        // On the virtual clock, an image has no valid time.
        let films = file.is_some() && are_recorded(&plan.rig);
        let into = films.then_some(&recorder);
        let filming =
            (clock.is_none() && (films || watches)).then(|| ImageRecorder::start(into, &plan.rig, reel)).flatten();
        Ok((Some(tap), Self { recorder: Some((recorder, file)), outlook, ends, filming, report: [false; 7] }))
    }

    /// Also records the objects of the scene that this source reports. Call it before the loop starts.
    pub(super) fn watch(&self, source: Box<dyn ObjectSource>) {
        if let Some((recorder, _)) = &self.recorder {
            recorder.watch(source);
        }
    }

    /// Returns whether the recording has ended on its own.
    pub(super) fn is_over(&self) -> bool {
        self.recorder.as_ref().is_some_and(|(recorder, _)| recorder.trouble().is_some())
    }

    /// Returns new problems, each reported once. The run continues.
    pub(super) fn news(&mut self) -> Vec<String> {
        let Some((recorder, _)) = &self.recorder else { return Vec::new() };
        let progress = recorder.progress();
        let over = recorder.trouble().map(|why| format!("the recording has ended, but the run continues: {why}"));
        let slow =
            || format!("the disk has not responded for {:.1} s; the run continues", progress.waits.as_secs_f64());
        let lost =
            || "the disk is slower than the loop: parts of the recording are lost, but the run continues".to_owned();
        let missing = || "the disk is slower than the endoscope: images are missing, but the run continues".to_owned();
        let no_image = self.filming.as_ref().and_then(ImageRecorder::trouble);
        let now = Instant::now();
        let outlook = self.outlook.as_ref().filter(|_| over.is_none());
        let full_in = outlook.and_then(|outlook| outlook.full_in(progress.bytes, 0, now));
        // If the run ends earlier, it needs no more space.
        let full_in = full_in.filter(|full_in| self.ends.is_none_or(|ends| now + *full_in < ends));
        let full = |within: Range<Duration>| {
            let words = full_in.filter(|full_in| within.contains(full_in)).map(disk_full_in)?;
            Some(format!("{words}: free space, or record to another disk next time"))
        };
        let news = [
            over,
            (progress.waits > SLOW).then(slow),
            (progress.lost > 0).then(lost),
            full(WARN_AGAIN..WARN_BEFORE),
            full(Duration::ZERO..WARN_AGAIN),
            (progress.images_dropped > 0).then(missing),
            no_image.map(|why| format!("the endoscope sends no images, but the run continues: {why}")),
        ];
        let is_new = |(words, report): (Option<String>, &mut bool)| {
            let words = words.filter(|_| !*report)?;
            *report = true;
            Some(words)
        };
        news.into_iter().zip(&mut self.report).filter_map(is_new).collect()
    }

    /// Call it after the loop has ended.
    pub(super) fn end(self) -> anyhow::Result<Option<RecordingFigures>> {
        let Some((mut recorder, file)) = self.recorder else { return Ok(None) };
        recorder.end();
        let RecordingProgress { ticks, lost, bytes, images, images_dropped, .. } =
            recorder.finish().context("the recording ended before the run")?;
        Ok(file.map(|file| RecordingFigures { file, ticks, lost, bytes, images, images_dropped }))
    }
}

impl RecordingFigures {
    /// Returns the text for a terminal; starts with a line break.
    pub(super) fn as_text(&self) -> String {
        let Self { file, ticks, lost, bytes, images, images_dropped } = self;
        let hole = match lost {
            0 => String::new(),
            _ => format!(", {lost} entries lost: it can be replayed up to the first lost entry"),
        };
        let megabytes = *bytes as f64 * 1e-6;
        let of_endoscope = match (images, images_dropped) {
            (0, 0) => String::new(),
            (_, 0) => format!(" and {images} images"),
            _ => format!(" and {images} images ({images_dropped} more are missing: the disk was too slow)"),
        };
        format!("\nrecorded {ticks} ticks{of_endoscope} into {}, {megabytes:.1} MB{hole}", file.display())
    }
}
