//! Speed of a handle that reports its position in steps.
//!
//! First-order adaptive windowing (Janabi-Sharifi, Hayward, Chen, "Discrete-time adaptive windowing for velocity
//! estimation", 2000), per axis: the slope from the newest reading back to the oldest one whose connecting line passes
//! all readings between them within one step. Here the window also ends as soon as it is accurate enough, which keeps
//! the delay as short as the permitted error allows.
//!
//! Error of a steady motion: at most 10 % and 0.1 mm/s per axis. After a sudden start the speed exceeds one half of its
//! true value after the time that the motion takes for two steps. At 2 mm/s and 10 um that is 10 ms; no estimate can
//! detect a motion before the first step.

use std::collections::VecDeque;

use nalgebra::SVector;

/// Permitted error, as a fraction and in m/s. A gate that compares the speed with a threshold does not need more, so
/// the window can stay short.
/// Larger values shorten the window and let the dead band flicker; smaller ones lengthen it and delay the speed.
const FRACTION: f64 = 0.1;
const MIN_M_S: f64 = 0.1e-3;
/// Each of this many newest readings is examined; of the older ones, only one in this many.
/// 16 readings are 16 ms at 1 kHz: a fast hand is judged within them. Further back every fourth is enough, because the
/// line hardly changes.
const NEAR: usize = 16;
const STRIDE: usize = 4;
/// Longest window, s: a step of 40 um. Otherwise a hand at rest would keep the last motion for seconds.
const LONGEST_S: f64 = 0.4;
/// Tolerance for rounding in the last digit of a step: readings are stored in 32 bits by some devices, so that equal
/// steps differ in their last digit.
const ROUNDING: f64 = 1.01;

/// Estimates the speed of a handle.
///
/// ```
/// use nalgebra::Vector1;
/// use nima_core::signal::Speed;
///
/// let mut speed = Speed::new(1e-5, 1000.0);
/// // 0.2 mm/s, read in steps of 10 um: differences would read 10 mm/s every 50 ms.
/// for tick in 0..1000 {
///     let t_s = f64::from(tick) * 1e-3;
///     let position_m = Vector1::new((0.2e-3 * t_s / 1e-5).round() * 1e-5);
///     let m_s = speed.step(t_s, position_m);
///     assert!(tick < 200 || (m_s - 0.2e-3).abs() < 0.12e-3, "{m_s}");
/// }
/// ```
#[derive(Clone, Debug)]
pub struct Speed<const D: usize> {
    step_m: f64,
    period_s: f64,
    room: usize,
    /// Time (s) and position (m), the newest first.
    readings: VecDeque<(f64, SVector<f64, D>)>,
}

impl<const D: usize> Speed<D> {
    /// Creates an estimator for readings in steps of `step_m` (m) at `rate_hz`. All memory is allocated here.
    pub fn new(step_m: f64, rate_hz: f64) -> Self {
        // A step of zero would ask for a window of zero length.
        let step_m = if step_m > 0.0 { step_m } else { f64::MIN_POSITIVE };
        // Over this window a single step is within the permitted error of a hand at rest.
        let longest_s = (step_m * (1.0 + FRACTION) / MIN_M_S).min(LONGEST_S);
        let room = (longest_s * rate_hz).ceil() as usize + 2;
        Self { step_m, period_s: 1.0 / rate_hz, room, readings: VecDeque::with_capacity(room + 2) }
    }

    /// Adds a reading (m) at this time (s) and returns the speed, m/s. If the time does not increase, the estimator
    /// restarts at rest; non-finite input is ignored.
    pub fn step(&mut self, t_s: f64, position_m: SVector<f64, D>) -> f64 {
        if t_s.is_finite() && position_m.iter().all(|x| x.is_finite()) {
            // The clock was set back or the reading was repeated: no slope can be computed over it.
            if self.readings.front().is_some_and(|(last_s, _)| t_s <= *last_s) {
                self.readings.clear();
            }
            if self.readings.is_empty() {
                // Assume that the handle has been at rest until now.
                self.readings.extend((1..=self.room).map(|back| (t_s - back as f64 * self.period_s, position_m)));
            }
            self.readings.push_front((t_s, position_m));
            self.readings.truncate(self.room);
        }
        SVector::<f64, D>::from_fn(|axis, _| self.slope(axis)).norm()
    }

    fn slope(&self, axis: usize) -> f64 {
        // No reading yet: no motion is known.
        let Some((now_s, now_m)) = self.readings.front() else { return 0.0 };
        let band_m = ROUNDING * self.step_m;
        let mut slope = 0.0;
        let mut min = f64::NEG_INFINITY;
        let mut max = f64::INFINITY;
        let mut back = 1;
        while let Some((then_s, then_m)) = self.readings.get(back) {
            let dt_s = now_s - then_s;
            let travel_m = now_m[axis] - then_m[axis];
            let line = travel_m / dt_s;
            // No straight line passes within a step of all readings: the motion bends here, so the window ends.
            if !(min..=max).contains(&line) {
                break;
            }
            slope = line;
            // The slope may exceed the true speed by the permitted error.
            // Long enough: a longer window would only add lag.
            if self.step_m * (1.0 + FRACTION) <= dt_s * (FRACTION * slope.abs() + MIN_M_S) {
                break;
            }
            min = min.max((travel_m - band_m) / dt_s);
            max = max.min((travel_m + band_m) / dt_s);
            back += if back < NEAR { 1 } else { STRIDE };
        }
        slope
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Vector1, Vector3};
    use proptest::prelude::*;

    use super::*;

    const STEPS_M: [f64; 5] = [1e-6, 2e-6, 5e-6, 1e-5, 2e-5];
    const SPEEDS_M_S: [f64; 7] = [0.1e-3, 0.2e-3, 0.5e-3, 1e-3, 2e-3, 3e-3, 5e-3];

    /// Returns the speeds estimated for a handle that rests for half a second and then moves at `m_s`.
    fn ramp(step_m: f64, m_s: f64, rate_hz: f64, offset: f64) -> Vec<f64> {
        let mut speed = Speed::new(step_m, rate_hz);
        let read = |t_s: f64| {
            let position_m = offset * step_m + m_s * (t_s - 0.5).max(0.0);
            Vector1::new((position_m / step_m).round() * step_m)
        };
        let ticks = (1.5 * rate_hz) as u32;
        let all: Vec<f64> = (0..ticks).map(|tick| f64::from(tick) / rate_hz).map(|t| speed.step(t, read(t))).collect();
        all[(0.5 * rate_hz) as usize..].to_vec()
    }

    #[test]
    fn a_steady_motion_reads_its_speed_and_a_start_shows_at_once() {
        for rate_hz in [1000.0, 4000.0] {
            for (step_m, m_s) in STEPS_M.into_iter().flat_map(|step_m| SPEEDS_M_S.map(|m_s| (step_m, m_s))) {
                for offset in [0.0, 0.3, 0.49] {
                    let read = ramp(step_m, m_s, rate_hz, offset);
                    let error = |read_m_s: &f64| (read_m_s - m_s).abs();
                    let settled = &read[(0.45 * rate_hz) as usize..];
                    let worst = settled.iter().map(error).fold(0.0, f64::max);
                    assert!(worst <= 0.1 * m_s + 0.1e-3 + 1e-9, "{step_m} m, {m_s} m/s: {worst}");
                    let half_s = read.iter().position(|read_m_s| *read_m_s >= 0.5 * m_s).unwrap() as f64 / rate_hz;
                    let max_s = (2.2 * step_m / m_s).max(0.015);
                    assert!(half_s <= max_s, "{step_m} m, {m_s} m/s: {half_s} s");
                    // A single position step must not look like a jump either.
                    let max_m_s = read.iter().copied().fold(0.0, f64::max);
                    assert!(max_m_s <= 1.25 * m_s + 0.5 * step_m * rate_hz.min(500.0), "{step_m} {m_s}: {max_m_s}");
                }
            }
        }
    }

    #[test]
    fn a_trembling_hand_reads_as_slow_as_it_is() {
        for step_m in STEPS_M {
            let mut speed = Speed::new(step_m, 1000.0);
            let mut max_m_s = 0.0_f64;
            for tick in 0..5000 {
                let t_s = f64::from(tick) * 1e-3;
                let position_m = 1e-5 * (std::f64::consts::TAU * 9.7 * t_s).sin();
                max_m_s = max_m_s.max(speed.step(t_s, Vector1::new((position_m / step_m).round() * step_m)));
            }
            // The true speed never exceeds 0.61 mm/s.
            assert!(max_m_s < 0.9e-3, "{step_m} m: {max_m_s} m/s");
        }
    }

    #[test]
    fn one_step_at_rest_is_no_motion() {
        let mut speed = Speed::new(1e-5, 1000.0);
        let read: Vec<f64> = (0..400)
            .map(|tick| speed.step(f64::from(tick) * 1e-3, Vector1::new(if tick < 200 { 0.0 } else { 1e-5 })))
            .collect();
        assert!(read.iter().all(|m_s| *m_s < 0.11e-3), "{:?}", read.iter().copied().fold(0.0, f64::max));
    }

    proptest! {
        #[test]
        fn whatever_is_read_gives_a_finite_speed(
            readings in prop::collection::vec((prop::num::f64::ANY, prop::array::uniform3(-1.0..1.0f64), any::<bool>()), 1..200),
        ) {
            let mut speed = Speed::new(1e-5, 1000.0);
            for (tick, (odd, position_m, clean)) in readings.into_iter().enumerate() {
                let t_s = if clean { tick as f64 * 1e-3 } else { odd };
                let position_m = if clean { Vector3::from(position_m) } else { Vector3::new(odd, position_m[1], position_m[2]) };
                prop_assert!(speed.step(t_s, position_m) >= 0.0);
            }
        }
    }
}
