//! The samples from the rig: the newest one, its age, and the number of missing ones.

use crate::rig::Inputs;

/// If the rig delivers no sample for longer than this, s, that is a fault. As long as the supervisor waits for the loop
/// itself (`STALL_MAX_S`): a force must not be older for either reason.
pub(super) const SILENT_AFTER_S: f64 = 0.020;
/// Number of missing samples that counts as a fault; each arriving sample compensates for [`FORGIVEN`] missing ones.
const TOO_MANY: f64 = 8.0;
// One missing sample for every five that arrive never adds up to a fault.
const FORGIVEN: f64 = 0.2;

#[derive(Clone, Debug)]
pub(super) struct Samples {
    pub(super) last: Option<Inputs>,
    /// Time of the sample's oldest part, s.
    last_s: f64,
    /// Recent missing samples, and whether a sample arrived in this tick.
    missing: f64,
    pub(super) came: bool,
    rate_hz: f64,
}

impl Samples {
    pub(super) const fn new(rate_hz: f64) -> Self {
        Self { last: None, last_s: 0.0, missing: 0.0, came: false, rate_hz }
    }

    /// Returns the distance of the tip from its position in the previous sample, m; 0 without a previous sample.
    pub(super) fn moved_m(&self, now: Option<&Inputs>) -> f64 {
        now.zip(self.last.as_ref()).map_or(0.0, |(now, last)| (now.tip_m - last.tip_m).norm())
    }

    pub(super) fn keep(&mut self, inputs: &Inputs, now_s: f64) {
        self.last = Some(*inputs);
        // The time of the measurement, not of its arrival in the loop.
        self.last_s = now_s - inputs.age_s;
    }

    /// Treats the newest sample as current, because earlier times are not comparable.
    pub(super) const fn begin_at(&mut self, now_s: f64) {
        self.last_s = now_s;
    }

    pub(super) fn are_silent(&self, now_s: f64) -> bool {
        // Half a period earlier, because a tick that wakes a little early must not decide one period later.
        now_s - self.last_s > SILENT_AFTER_S - 0.5 / self.rate_hz
    }

    /// Returns the newest sample, if it is not too old.
    pub(super) fn recent(&self, now_s: f64) -> Option<&Inputs> {
        self.last.as_ref().filter(|_| !self.are_silent(now_s))
    }

    /// Counts whether a sample arrived in this tick. Returns whether so many are missing that the identification would
    /// learn from interpolated data: more than one in six; detected within 20 ms if every second one is missing. A
    /// continuous silence counts as one gap.
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
