//! `nima run --record`: the session file of a run; `--live`: who watches it.

use std::path::PathBuf;

use anyhow::Context as _;
use nima_machine::runtime::Tap;
use nima_session::{
    outlet::Destination,
    recorder::{Progress, Recorder},
};
use nima_world::Plan;
use serde::Serialize;

use crate::recording::begin;

/// A recording, if one was asked for. Without a file there are only those who watch.
#[derive(Default)]
pub(super) struct Recording {
    recorder: Option<(Recorder, Option<PathBuf>)>,
    told: bool,
}

/// The figures of a recording.
#[derive(Serialize)]
pub(super) struct Recorded {
    file: PathBuf,
    ticks: u64,
    lost: u64,
    bytes: u64,
}

impl Recording {
    /// Begins it; the tap is for the loop.
    pub(super) fn begin(to: Destination<'_>, plan: &Plan, is_virtual: bool) -> anyhow::Result<(Option<Tap>, Self)> {
        if to.file.is_none() && to.audience.is_none() {
            return Ok((None, Self::default()));
        }
        let file = to.file.map(ToOwned::to_owned);
        let (tap, recorder) = begin(to, plan, if is_virtual { "virtual" } else { "real" })?;
        Ok((Some(tap), Self { recorder: Some((recorder, file)), told: false }))
    }

    /// Whether it has ended by itself.
    pub(super) fn is_over(&self) -> bool {
        self.recorder.as_ref().is_some_and(|(recorder, _)| recorder.trouble().is_some())
    }

    /// Why it has ended by itself, once. The run goes on.
    pub(super) fn newly_over(&mut self) -> Option<String> {
        let trouble = self.recorder.as_ref().and_then(|(recorder, _)| recorder.trouble()).filter(|_| !self.told)?;
        self.told = true;
        Some(format!("the recording has ended, the run goes on: {trouble}"))
    }

    /// Ends it after the loop has ended.
    pub(super) fn end(self) -> anyhow::Result<Option<Recorded>> {
        let Some((recorder, file)) = self.recorder else { return Ok(None) };
        let Progress { ticks, lost, bytes } = recorder.finish().context("the recording has ended before the run")?;
        Ok(file.map(|file| Recorded { file, ticks, lost, bytes }))
    }
}

impl Recorded {
    /// In words, for a terminal; begins with a line break.
    pub(super) fn in_words(&self) -> String {
        let Self { file, ticks, lost, bytes } = self;
        let hole = match lost {
            0 => String::new(),
            _ => format!(", {lost} entries lost: it can be replayed up to the first of them"),
        };
        let megabytes = *bytes as f64 * 1e-6;
        format!("\nrecorded {ticks} ticks into {}, {megabytes:.1} MB{hole}", file.display())
    }
}
