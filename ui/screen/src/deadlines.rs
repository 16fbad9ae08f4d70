//! Missed periods per second: shows when the loop was late, not only how often.

use std::collections::VecDeque;

/// Stored period, s.
pub const SECONDS: usize = 120;

#[derive(Clone, Debug, Default)]
pub struct Deadlines {
    /// Oldest first; the last one is the current second.
    counts: VecDeque<u64>,
    /// The current second, on the loop's clock.
    now: u64,
}

impl Deadlines {
    /// Adds the number of periods missed before the tick at `t_s` (s on the loop's clock). If the clock stops, runs backwards
    /// or is not finite, they are added to the current second.
    pub fn push(&mut self, t_s: f64, missed: u64) {
        let second = t_s.max(0.0) as u64;
        if self.counts.is_empty() {
            self.now = second;
            self.counts.push_back(0);
        }
        // After a gap longer than the stored period, no old counts remain.
        for _ in 0..second.saturating_sub(self.now).min(SECONDS as u64) {
            self.counts.push_back(0);
        }
        self.now = self.now.max(second);
        while self.counts.len() > SECONDS {
            self.counts.pop_front();
        }
        if let Some(last) = self.counts.back_mut() {
            *last += missed;
        }
    }

    /// Returns the age in seconds and number of missed periods, the newest first.
    pub fn newest_first(&self) -> impl Iterator<Item = (usize, u64)> {
        self.counts.iter().rev().copied().enumerate()
    }

    pub fn total(&self) -> u64 {
        self.counts.iter().sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn misses_stand_in_their_second_and_old_ones_go() {
        let mut deadlines = Deadlines::default();
        for (t_s, missed) in [(10.2, 1), (10.9, 2), (12.0, 5), (12.1, 0)] {
            deadlines.push(t_s, missed);
        }
        assert_eq!(deadlines.newest_first().collect::<Vec<_>>(), [(0, 5), (1, 0), (2, 3)]);
        assert_eq!(deadlines.total(), 8);
        deadlines.push(11.0, 1);
        deadlines.push(f64::NAN, 1);
        assert_eq!(deadlines.newest_first().next(), Some((0, 7)), "a clock that runs back changes no other second");
        deadlines.push(12.0 + SECONDS as f64 - 1.0, 0);
        assert_eq!(deadlines.total(), 7);
        deadlines.push(1e15, 0);
        assert_eq!((deadlines.total(), deadlines.newest_first().count()), (0, SECONDS));
    }
}
