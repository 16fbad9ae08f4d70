//! Unwraps the sensor's clock and uses it to detect readings that are missing, duplicated or out of order.

/// Follows the 32-bit microsecond clock of a sensor with a fixed period.
#[derive(Clone, Debug)]
pub struct BotaClock {
    period_us: f64,
    newest: Option<u32>,
    total_us: u64,
    /// The newest gap, as long as a late reading may fill it: the time before the gap, and the number of missing
    /// readings.
    gap: Option<(u32, u64)>,
}

/// Order of a reading by its time stamp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BotaClockStep {
    /// Newer than all previous ones.
    Newer {
        /// Time since the clock's zero, unwrapped, s.
        device_s: f64,
        /// Number of readings missing between this one and the previous one.
        missing: u64,
    },
    /// A reading that was counted as missing.
    Late,
    /// Not newer: a duplicate, or the clock is stopped or was reset.
    Stale,
}

impl BotaClock {
    /// Creates a clock for a sensor with this period, us (must be positive).
    pub const fn new(period_us: f64) -> Self {
        Self { period_us, newest: None, total_us: 0, gap: None }
    }

    pub fn step(&mut self, timestamp_us: u32) -> BotaClockStep {
        let Some(newest) = self.newest else {
            self.newest = Some(timestamp_us);
            self.total_us = u64::from(timestamp_us);
            return BotaClockStep::Newer { device_s: self.total_us as f64 * 1e-6, missing: 0 };
        };
        let ahead_us = timestamp_us.wrapping_sub(newest);
        // A difference of more than half the range means that the clock is behind.
        if ahead_us == 0 || ahead_us > u32::MAX / 2 {
            return self.behind(timestamp_us, newest);
        }
        let periods = (f64::from(ahead_us) / self.period_us).round();
        let missing = (periods - 1.0).max(0.0) as u64;
        self.gap = if missing > 0 { Some((newest, missing)) } else { self.gap };
        self.newest = Some(timestamp_us);
        self.total_us += u64::from(ahead_us);
        BotaClockStep::Newer { device_s: self.total_us as f64 * 1e-6, missing }
    }

    fn behind(&mut self, timestamp_us: u32, newest: u32) -> BotaClockStep {
        let Some((before, missing)) = self.gap else { return BotaClockStep::Stale };
        let since = timestamp_us.wrapping_sub(before);
        if since == 0 || since >= newest.wrapping_sub(before) {
            return BotaClockStep::Stale;
        }
        self.gap = (missing > 1).then_some((before, missing - 1));
        BotaClockStep::Late
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn device_s(step: BotaClockStep) -> f64 {
        match step {
            BotaClockStep::Newer { device_s, missing: 0 } => device_s,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn time_goes_on_where_the_counter_begins_again() {
        let mut clock = BotaClock::new(1250.0);
        let begin = u32::MAX - 10_000;
        let zero_s = device_s(clock.step(begin));
        for k in 1..100_000_u32 {
            let now_s = device_s(clock.step(begin.wrapping_add(k * 1250)));
            assert!((now_s - zero_s - f64::from(k) * 1250e-6).abs() < 1e-9, "{k}: {now_s}");
        }
    }

    #[test]
    fn what_is_missing_is_counted_over_the_wrap_too_and_in_spite_of_jitter() {
        let mut clock = BotaClock::new(1000.0);
        let mut lost = 0;
        let mut random = fastrand::Rng::with_seed(4);
        let mut left_out = 0;
        for k in 0..20_000_u32 {
            if k > 0 && k < 19_999 && random.u8(..) < 50 {
                left_out += 1;
                continue;
            }
            let jitter = random.u32(0..400);
            match clock.step((u32::MAX - 5_000_000).wrapping_add(k * 1000 + jitter)) {
                BotaClockStep::Newer { missing, .. } => lost += missing,
                other => panic!("{k}: {other:?}"),
            }
        }
        assert_eq!(lost, left_out);
    }

    #[test]
    fn late_readings_are_told_from_repeated_ones() {
        let mut clock = BotaClock::new(1000.0);
        clock.step(10_000);
        assert_eq!(clock.step(13_000), BotaClockStep::Newer { device_s: 0.013, missing: 2 });
        assert_eq!(clock.step(11_000), BotaClockStep::Late);
        assert_eq!(clock.step(12_000), BotaClockStep::Late);
        assert_eq!(clock.step(12_000), BotaClockStep::Stale, "no more were missing");
        assert_eq!(clock.step(13_000), BotaClockStep::Stale);
        assert_eq!(clock.step(0), BotaClockStep::Stale, "a restarted clock is not newer");
    }
}
