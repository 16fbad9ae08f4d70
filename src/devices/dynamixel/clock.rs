//! The servos' clock: unwraps 15 bits of milliseconds (register 120) to seconds and detects old readings.

use super::table::TICK_WRAP;

/// Rate at which the smallest observed delay increases; it exceeds the rate error of a servo's clock.
const DRIFT: f64 = 0.02;

/// Age of a reading by its time stamp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum ReadingAge {
    /// Newer than all previous ones.
    New,
    /// From the same millisecond as the previous one.
    Same,
    /// Older than a previous one, or delayed too long.
    Old,
}

#[derive(Clone, Copy, Debug)]
struct LastReading {
    tick: i32,
    device_s: f64,
    arrival_s: f64,
    /// Arrival time minus device time of the fastest reading.
    offset_s: f64,
}

/// Unwraps the clock.
#[derive(Clone, Copy, Debug)]
pub(super) struct DeviceClock {
    last: Option<LastReading>,
    late_s: f64,
}

impl DeviceClock {
    /// Creates a clock for which a reading delayed by `late_s` more than the fastest ones counts as an answer to an
    /// earlier exchange.
    pub(super) const fn new(late_s: f64) -> Self {
        Self { last: None, late_s }
    }

    /// Adds the tick of a reading that arrived at `arrival_s`; returns its time, s, and its age.
    pub(super) fn take(&mut self, tick: u16, arrival_s: f64) -> (f64, ReadingAge) {
        let tick = i32::from(tick) % TICK_WRAP;
        let Some(last) = &mut self.last else {
            let device_s = f64::from(tick) * 1e-3;
            self.last = Some(LastReading { tick, device_s, arrival_s, offset_s: arrival_s - device_s });
            return (device_s, ReadingAge::New);
        };
        let elapsed_s = (arrival_s - last.arrival_s).max(0.0);
        let wrap_s = f64::from(TICK_WRAP) * 1e-3;
        let step_s = f64::from(tick - last.tick) * 1e-3;
        let step_s = step_s + wrap_s * ((elapsed_s - step_s) / wrap_s).round();
        let device_s = last.device_s + step_s;
        let offset_s = arrival_s - device_s;
        let quickest_s = offset_s.min(last.offset_s + DRIFT * elapsed_s);
        if step_s < -0.5e-3 || offset_s - quickest_s > self.late_s {
            return (device_s, ReadingAge::Old);
        }
        let age = if step_s > 0.5e-3 { ReadingAge::New } else { ReadingAge::Same };
        *last = LastReading { tick, device_s, arrival_s, offset_s: quickest_s };
        (device_s, age)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_clock_runs_on_over_its_wrap_and_over_long_pauses() {
        let mut clock = DeviceClock::new(0.015);
        let mut now_s = 0.0;
        for (k, step_ms) in [1_u64, 1, 0, 3, 20_000, 31_000, 100_000, 5].into_iter().enumerate() {
            now_s += step_ms as f64 * 1e-3;
            let tick = ((now_s * 1e3).round() as u64 + 32_760) % 32_768;
            let (device_s, age) = clock.take(tick as u16, now_s);
            assert!((device_s - 32.760 - now_s).abs() < 1e-9, "step {k}: {device_s}");
            assert_eq!(age, if step_ms == 0 { ReadingAge::Same } else { ReadingAge::New });
        }
    }

    #[test]
    fn what_was_long_on_the_way_is_old_and_a_slow_clock_is_not() {
        let mut clock = DeviceClock::new(0.015);
        for k in 0..20_000_u16 {
            // The servo's clock is 1 % slow.
            assert_ne!(clock.take((f64::from(k) * 0.99) as u16, f64::from(k) * 1e-3).1, ReadingAge::Old, "{k}");
        }
        assert_eq!(clock.take(19_801, 20.050).1, ReadingAge::Old, "50 ms late");
        assert_eq!(clock.take(19_700, 20.001).1, ReadingAge::Old, "from before");
        assert_eq!(clock.take(19_802, 20.002).1, ReadingAge::New);
    }
}
