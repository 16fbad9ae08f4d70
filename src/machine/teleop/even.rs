//! Even spacing for code that counts ticks: the deadlines that have passed since the last tick, and values at their
//! times.
//!
//! Identification, rendering and the follower's lag are difference equations with one period. A tick that wakes late
//! measures late; if its measurements were used for the deadline, they would distort velocity and acceleration. Each
//! deadline that has passed therefore gets the interpolated value between the last tick and this one, like a lost
//! sample. A tick at its deadline passes unchanged.

use nalgebra::{SVector, Vector3};

use super::Timing;

/// After a longer pause, in periods, only the newest deadline counts: catching up must not delay the tick further, and
/// the identification treats a pause as a gap.
const CAUGHT_UP_MAX: u64 = 8;

/// Returns the deadlines since the last tick, s, the newest last.
pub fn deadlines(timing: &Timing, period_s: f64) -> impl Iterator<Item = f64> + use<> {
    // The tick woke `wake_s` after its deadline.
    let first_s = timing.now_s - timing.wake_s;
    let newest = timing.missed_now;
    let oldest = if newest > CAUGHT_UP_MAX { newest } else { 0 };
    (oldest..=newest).map(move |k| first_s + k as f64 * period_s)
}

#[derive(Clone, Copy, Debug, Default)]
pub struct Between<const N: usize> {
    last: Option<(f64, SVector<f64, N>)>,
}

impl<const N: usize> Between<N> {
    /// Returns the value at `t_s` (s), which is not after `now`: the time (s) and the value of this tick.
    pub fn at(&self, t_s: f64, now: (f64, SVector<f64, N>)) -> SVector<f64, N> {
        let (now_s, value) = now;
        match self.last {
            // Without two readings in order there is nothing to interpolate between.
            Some((last_s, last)) if t_s < now_s && last_s < now_s => {
                let fraction = ((t_s - last_s) / (now_s - last_s)).clamp(0.0, 1.0);
                last + (value - last) * fraction
            }
            _ => value,
        }
    }

    /// Stores the value of this tick for the next one.
    pub const fn keep(&mut self, now: (f64, SVector<f64, N>)) {
        self.last = Some(now);
    }

    /// Discards the last value, because the next one does not follow from it.
    pub const fn forget(&mut self) {
        self.last = None;
    }
}

pub fn stacked<const N: usize, const M: usize>(parts: [&Vector3<f64>; M]) -> SVector<f64, N> {
    SVector::from_fn(|row, _| parts[row / 3][row % 3])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tick(now_s: f64, wake_s: f64, missed_now: u64) -> Timing {
        Timing { now_s, wake_s, missed_now, ..Timing::default() }
    }

    #[test]
    fn a_late_tick_answers_for_every_deadline_that_has_passed() {
        let all = |timing: &Timing| deadlines(timing, 1e-3).collect::<Vec<_>>();
        assert_eq!(all(&tick(2.0, 0.0, 0)), [2.0]);
        let late = all(&tick(2.0035, 2.5e-3, 2));
        assert_eq!(late.len(), 3);
        assert!(late.iter().zip([2.001, 2.002, 2.003]).all(|(is, wanted)| (is - wanted).abs() < 1e-12), "{late:?}");
        let paused = all(&tick(2.5, 0.5, 499));
        assert!(paused.len() == 1 && (paused[0] - 2.499).abs() < 1e-9, "{paused:?}");
    }

    #[test]
    fn a_straight_motion_stays_straight_at_uneven_times() {
        let mut between = Between::<1>::default();
        let value = |t_s: f64| SVector::from([0.3 * t_s]);
        for (now_s, deadline_s) in [(0.0, 0.0), (1.7e-3, 1e-3), (2.0e-3, 2e-3), (6.2e-3, 4e-3)] {
            let at = between.at(deadline_s, (now_s, value(now_s)));
            assert!((at - value(deadline_s)).norm() < 1e-15, "at {deadline_s} s");
            between.keep((now_s, value(now_s)));
        }
        between.forget();
        assert_eq!(between.at(7e-3, (8e-3, value(8e-3))), value(8e-3), "nothing to be between");
    }
}
