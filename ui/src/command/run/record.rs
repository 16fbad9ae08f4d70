//! `nima run --record`: the session file of a run; `--live`: who watches it.

use std::{
    ops::Range,
    path::PathBuf,
    time::{Duration, Instant},
};

use anyhow::Context as _;
use nima_endoscope::Reel;
use nima_machine::runtime::{Tap, VirtualClock};
use nima_session::{
    objects::ObjectSource,
    outlet::Destination,
    outlook::{Outlook, WARN_BEFORE},
    recorder::{Progress, Recorder},
};
use nima_simulation::Plan;
use serde::Serialize;

use crate::{
    pictures::{Filming, are_recorded},
    recording::begin,
    words::disk_full_in,
};

/// A recording, if one was asked for. Without a file there are only those who watch.
#[derive(Default)]
pub(super) struct Recording {
    recorder: Option<(Recorder, Option<PathBuf>)>,
    outlook: Option<Outlook>,
    /// When the run ends, if that is known.
    ends: Option<Instant>,
    /// Reads the endoscope's pictures for it.
    filming: Option<Filming>,
    /// What was told already: that it is over, waits for the disk, has lost entries, that the disk will be full
    /// within a day and within an hour, that pictures are missing, and that there are none.
    told: [bool; 7],
}

/// A second warning of a full disk.
const WARN_AGAIN: Duration = Duration::from_hours(1);

/// A disk that does not answer for this long is told: a second later entries are lost.
const SLOW: Duration = Duration::from_secs(1);

/// The figures of a recording.
#[derive(Serialize)]
pub(super) struct Recorded {
    file: PathBuf,
    ticks: u64,
    lost: u64,
    bytes: u64,
    /// Pictures of the endoscope, and those that are missing.
    #[serde(skip_serializing_if = "is_none")]
    pictures: u64,
    #[serde(skip_serializing_if = "is_none")]
    pictures_dropped: u64,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks for a reference")]
const fn is_none(count: &u64) -> bool {
    *count == 0
}

impl Recording {
    /// Begins it; the tap is for the loop. A run on the real clock ends after `seconds`. The endoscope's pictures come through `reel`, where
    /// they are recorded, or somebody `watches` them.
    pub(super) fn begin(
        to: Destination<'_>,
        plan: &Plan,
        clock: Option<VirtualClock>,
        seconds: Option<f64>,
        (reel, watches): (&Reel, bool),
    ) -> anyhow::Result<(Option<Tap>, Self)> {
        if to.file.is_none() && to.audiences.is_empty() {
            return Ok((None, Self::default()));
        }
        let file = to.file.map(ToOwned::to_owned);
        let (tap, recorder) = begin(to, plan, clock)?;
        let now = Instant::now();
        let outlook = file.as_deref().map(|file| Outlook::new(file, recorder.progress().bytes, now));
        let ends = seconds.and_then(|seconds| now.checked_add(Duration::from_secs_f64(seconds)));
        // On the virtual clock pictures would belong to no moment.
        let films = file.is_some() && are_recorded(&plan.rig);
        let into = films.then_some(&recorder);
        let filming = (clock.is_none() && (films || watches)).then(|| Filming::start(into, &plan.rig, reel)).flatten();
        Ok((Some(tap), Self { recorder: Some((recorder, file)), outlook, ends, filming, told: [false; 7] }))
    }

    /// Records what this source tells of the objects of the scene too; to be called before the loop starts.
    pub(super) fn watch(&self, source: Box<dyn ObjectSource>) {
        if let Some((recorder, _)) = &self.recorder {
            recorder.watch(source);
        }
    }

    /// Whether it has ended by itself.
    pub(super) fn is_over(&self) -> bool {
        self.recorder.as_ref().is_some_and(|(recorder, _)| recorder.trouble().is_some())
    }

    /// What has gone wrong, each of it once. The run goes on.
    pub(super) fn news(&mut self) -> Vec<String> {
        let Some((recorder, _)) = &self.recorder else { return Vec::new() };
        let progress = recorder.progress();
        let over = recorder.trouble().map(|why| format!("the recording has ended, the run goes on: {why}"));
        let slow = || format!("the disk has not answered for {:.1} s: the run goes on", progress.waits.as_secs_f64());
        let lost = || "the disk is slower than the loop: parts of the recording are lost, the run goes on".to_owned();
        let missing = || "the disk is slower than the endoscope: pictures are missing, the run goes on".to_owned();
        let no_picture = self.filming.as_ref().and_then(Filming::trouble);
        let now = Instant::now();
        let outlook = self.outlook.as_ref().filter(|_| over.is_none());
        let full_in = outlook.and_then(|outlook| outlook.full_in(progress.bytes, 0, now));
        // A run that ends before needs no more room.
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
            (progress.pictures_dropped > 0).then(missing),
            no_picture.map(|why| format!("the endoscope's picture does not come now, the run goes on: {why}")),
        ];
        let is_new = |(words, told): (Option<String>, &mut bool)| {
            let words = words.filter(|_| !*told)?;
            *told = true;
            Some(words)
        };
        news.into_iter().zip(&mut self.told).filter_map(is_new).collect()
    }

    /// Ends it after the loop has ended.
    pub(super) fn end(self) -> anyhow::Result<Option<Recorded>> {
        let Some((mut recorder, file)) = self.recorder else { return Ok(None) };
        recorder.end();
        let Progress { ticks, lost, bytes, pictures, pictures_dropped, .. } =
            recorder.finish().context("the recording has ended before the run")?;
        Ok(file.map(|file| Recorded { file, ticks, lost, bytes, pictures, pictures_dropped }))
    }
}

impl Recorded {
    /// In words, for a terminal; begins with a line break.
    pub(super) fn in_words(&self) -> String {
        let Self { file, ticks, lost, bytes, pictures, pictures_dropped } = self;
        let hole = match lost {
            0 => String::new(),
            _ => format!(", {lost} entries lost: it can be replayed up to the first of them"),
        };
        let megabytes = *bytes as f64 * 1e-6;
        let of_endoscope = match (pictures, pictures_dropped) {
            (0, 0) => String::new(),
            (_, 0) => format!(" and {pictures} pictures"),
            _ => format!(" and {pictures} pictures ({pictures_dropped} more are missing: the disk was too slow)"),
        };
        format!("\nrecorded {ticks} ticks{of_endoscope} into {}, {megabytes:.1} MB{hole}", file.display())
    }
}
