//! The samples that have come from the rig: the newest one, how old it is, and how many are missing.

use crate::rig::Inputs;

/// No sample from the rig for longer than this, s, is a fault.
pub(super) const SILENT_AFTER_S: f64 = 0.020;
/// Missing samples, of which each one that comes makes up for [`FORGIVEN`], that are too many.
const TOO_MANY: f64 = 8.0;
const FORGIVEN: f64 = 0.2;

/// What is kept of the samples of a pair.
#[derive(Clone, Debug)]
pub(super) struct Samples {
    /// The newest one.
    pub(super) last: Option<Inputs>,
    /// When the oldest part of it was measured, s.
    last_s: f64,
    /// Samples missing lately, and whether one came in this tick.
    missing: f64,
    pub(super) came: bool,
    rate_hz: f64,
}

impl Samples {
    pub(super) const fn new(rate_hz: f64) -> Self {
        Self { last: None, last_s: 0.0, missing: 0.0, came: false, rate_hz }
    }

    /// Distance of the tip from where the sample before had it, m; 0 if there is none.
    pub(super) fn moved_m(&self, now: Option<&Inputs>) -> f64 {
        now.zip(self.last.as_ref()).map_or(0.0, |(now, last)| (now.tip_m - last.tip_m).norm())
    }

    /// Keeps the sample of this tick.
    pub(super) fn keep(&mut self, inputs: &Inputs, now_s: f64) {
        self.last = Some(*inputs);
        self.last_s = now_s - inputs.age_s;
    }

    /// The newest one counts as one of now: the time before is not comparable.
    pub(super) const fn begin_at(&mut self, now_s: f64) {
        self.last_s = now_s;
    }

    /// Whether the newest one is too old.
    pub(super) fn are_silent(&self, now_s: f64) -> bool {
        now_s - self.last_s > SILENT_AFTER_S - 0.5 / self.rate_hz
    }

    /// The newest one, if it is not too old.
    pub(super) fn recent(&self, now_s: f64) -> Option<&Inputs> {
        self.last.as_ref().filter(|_| !self.are_silent(now_s))
    }

    /// Counts whether a sample came in this tick; returns whether so many are missing that the identification would learn from
    /// interpolated data: more than one in six; detected within 20 ms if every second one is missing. A continuous silence counts as one
    /// gap.
    pub(super) fn count(&mut self, came: bool) -> bool {
        match (came, self.came) {
            (true, _) => self.missing = (self.missing - FORGIVEN).max(0.0),
            (false, true) => self.missing += 1.0,
            (false, false) => {}
        }
        self.came = came;
        self.missing >= TOO_MANY
    }
}
