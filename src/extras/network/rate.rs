//! Rate limits, as token buckets.

/// Maximum saving, as time, s.
const SAVED_S: f64 = 0.01;

/// Limits the amount spent per second.
#[derive(Clone, Copy, Debug)]
pub struct RateBucket {
    per_s: f64,
    room: f64,
    level: f64,
    filled_s: Option<f64>,
}

impl RateBucket {
    /// Creates a full bucket that fills at this rate per second and has this capacity.
    pub const fn new(per_s: f64, room: f64) -> Self {
        Self { per_s, room, level: room, filled_s: None }
    }

    /// For datagrams: bytes at this rate (bit/s), with a capacity of 10 ms plus one datagram of `min` bytes.
    pub fn of_bits(bits_per_s: f64, min: usize) -> Self {
        let per_s = bits_per_s / 8.0;
        Self::new(per_s, (per_s * SAVED_S).max(min as f64))
    }

    /// Returns the amount available now.
    pub fn level(&mut self, now_s: f64) -> f64 {
        let passed_s = self.filled_s.map_or(0.0, |filled_s| (now_s - filled_s).max(0.0));
        self.filled_s = Some(now_s);
        self.level = (self.level + passed_s * self.per_s).min(self.room);
        self.level
    }

    /// Spends this amount if it is available.
    pub fn spend(&mut self, amount: f64, now_s: f64) -> bool {
        let is_there = self.level(now_s) >= amount;
        if is_there {
            self.level -= amount;
        }
        is_there
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_more_is_spent_than_the_rate_allows() {
        let mut bucket = RateBucket::of_bits(1e6, 1200);
        let spent = (0..10_000).filter(|&tick| bucket.spend(200.0, f64::from(tick) * 1e-3)).count();
        let allowed = 10.0 * 1e6 / 8.0 / 200.0;
        assert!((spent as f64 - allowed).abs() < 10.0, "{spent} of {allowed}");
    }
}
