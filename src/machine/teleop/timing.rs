//! The times of a tick, and how they follow from those of the tick before.

/// Times measured by the caller: the pair never reads a clock.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Timing {
    /// Loop time of this tick, s.
    pub now_s: f64,
    /// How late the tick woke after its deadline, s.
    pub wake_s: f64,
    /// Duration of the work of the previous tick, s.
    pub work_s: f64,
    /// Time from the arrival of the oldest measurement of the previous tick until its force was given to the device, s;
    /// `None` without a measurement.
    pub sample_to_force_s: Option<f64>,
    /// Periods missed just before this tick.
    pub missed_now: u64,
}

/// How the time of a tick follows from that of the tick before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Passed {
    /// By one period and those that were missed.
    Evenly,
    /// Forwards by another time.
    Unevenly,
    /// It stood still, went back, or is not a number.
    Backwards,
}

/// Counts the ticks of a pair and compares their times.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ticks {
    /// Executed ticks.
    pub(super) executed: u64,
    /// Missed periods.
    pub(super) missed: u64,
    last_s: Option<f64>,
    period_s: f64,
}

impl Ticks {
    pub(super) const fn new(period_s: f64) -> Self {
        Self { executed: 0, missed: 0, last_s: None, period_s }
    }

    /// Time must advance by one period plus those missed, and each tick may wake up to a period after its deadline.
    pub(super) fn pass(&mut self, timing: &Timing) -> Passed {
        self.missed += timing.missed_now;
        let Some(last_s) = self.last_s.replace(timing.now_s) else { return Passed::Evenly };
        if timing.now_s.is_nan() || timing.now_s <= last_s {
            return Passed::Backwards;
        }
        let surplus_s = timing.now_s - last_s - self.period_s * (1 + timing.missed_now) as f64;
        // A tenth more for a loop that moves its phase.
        if surplus_s.abs() <= 1.1 * self.period_s { Passed::Evenly } else { Passed::Unevenly }
    }
}
