//! The times of a tick, and their relation to the previous tick.

/// A loop that shifts its phase has periods that are longer by a thousandth; twice that is not a drift, as a fraction
/// of a period.
const MOVES_PHASE: f64 = 0.002;
/// A tick wakes within a period after its deadline, so consecutive ticks drift from whole periods by less than this,
/// periods.
const DRIFT_MAX: f64 = 2.5;

/// Times measured by the caller: the pair never reads a clock.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Timing {
    pub now_s: f64,
    pub wake_s: f64,
    /// Duration of the work of the previous tick, s.
    pub work_s: f64,
    /// Time from the arrival of the oldest measurement of the previous tick until its force was sent to the device, s;
    /// `None` without a measurement.
    pub sample_to_force_s: Option<f64>,
    pub missed_now: u64,
}

/// Relation of a tick's time to the previous tick's time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum TickSpacing {
    /// Advanced by one period plus the missed ones.
    Evenly,
    /// Advanced by another time.
    Unevenly,
    /// Unchanged, decreased, or NaN.
    Backwards,
}

/// Counts the ticks of a pair and compares their times.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ticks {
    pub(super) executed: u64,
    pub(super) missed: u64,
    last_s: Option<f64>,
    period_s: f64,
    /// Lateness and earliness of recent ticks relative to whole periods: cumulative sums, periods.
    late: f64,
    early: f64,
}

impl Ticks {
    pub(super) const fn new(period_s: f64) -> Self {
        Self { executed: 0, missed: 0, last_s: None, period_s, late: 0.0, early: 0.0 }
    }

    /// Compares the time with the previous tick. It must advance by one period plus the missed ones, and each tick may
    /// wake up to a period after its deadline. A clock that runs too slowly or too fast stays within this limit from
    /// tick to tick, but drifts.
    pub(super) fn pass(&mut self, timing: &Timing) -> TickSpacing {
        self.missed += timing.missed_now;
        let Some(last_s) = self.last_s.replace(timing.now_s) else { return TickSpacing::Evenly };
        // NaN is tested by name, because every comparison with it is false.
        if timing.now_s.is_nan() || timing.now_s <= last_s {
            return TickSpacing::Backwards;
        }
        // One period is expected, and each missed one was announced.
        let surplus = (timing.now_s - last_s) / self.period_s - (1 + timing.missed_now) as f64;
        // Leaky sums in both directions: jitter cancels out, a drift adds up.
        self.late = (self.late + surplus - MOVES_PHASE).max(0.0);
        self.early = (self.early - surplus - MOVES_PHASE).max(0.0);
        let drifts = self.late.max(self.early) > DRIFT_MAX;
        // Restart the sums: one fault for one drift, not one in every tick that follows.
        if drifts {
            self.late = 0.0;
            self.early = 0.0;
        }
        // Allow a tenth of a period more for a loop that shifts its phase.
        if surplus.abs() <= 1.1 && !drifts { TickSpacing::Evenly } else { TickSpacing::Unevenly }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::runtime::{ClockProfile, TickTimes};

    const PERIOD_S: f64 = 1e-3;

    /// Returns the first tick at which the clock is no longer even, if there is one.
    fn uneven(ticks: u32, now_s: impl Fn(u32) -> f64) -> Option<u32> {
        let mut counted = Ticks::new(PERIOD_S);
        (0..ticks)
            .find(|tick| counted.pass(&Timing { now_s: now_s(*tick), ..Timing::default() }) != TickSpacing::Evenly)
    }

    #[test]
    fn a_clock_at_half_or_at_twice_its_rate_is_uneven_within_six_ticks() {
        for rate in [0.5, 0.7, 1.5, 2.0] {
            let found = uneven(20, |tick| rate * f64::from(tick) * PERIOD_S);
            assert!(found.is_some_and(|tick| tick <= 10), "{rate}: {found:?}");
        }
        assert!(uneven(20, |tick| 0.5 * f64::from(tick) * PERIOD_S).is_some_and(|tick| tick <= 6));
        assert_eq!(uneven(100_000, |tick| f64::from(tick) * PERIOD_S), None);
        // A loop that shifts its phase for as long as a shift may take at most.
        assert_eq!(uneven(1000, |tick| 1.001 * f64::from(tick) * PERIOD_S), None);
    }

    #[test]
    fn late_ticks_are_even() {
        for profile in ClockProfile::ALL {
            let mut times = TickTimes::new(profile, 3, 1.0 / PERIOD_S);
            let mut counted = Ticks::new(PERIOD_S);
            for _ in 0..100_000 {
                let timing = Timing::from(times.advance());
                assert_eq!(counted.pass(&timing), TickSpacing::Evenly, "{profile} at {} s", timing.now_s);
            }
        }
    }
}
