//! The relation between the loop's clock and UTC while a loop runs.

use std::time::{Duration, Instant};

/// The relation is measured again after this time.
const LOOK_EVERY: Duration = Duration::from_secs(1);
/// A smaller change is not reported, ns: the measurement itself is better than a tenth of it.
const JUMP_MIN_NS: u64 = 1_000_000;

#[derive(Debug, Default)]
pub(super) struct UtcClock {
    looked: Option<Instant>,
    /// Start of the loop's clock, ns since 1970, as it was first measured, or last reported.
    started_ns: Option<u64>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ClockChange {
    /// Start of the loop's clock, ns since 1970.
    pub(super) started_ns: u64,
    pub(super) is_first: bool,
    /// Change since the last report, s, if the system's clock was set.
    pub(super) jump_s: Option<f64>,
}

impl UtcClock {
    /// Returns the relation when it is due; `measure` returns the start of the loop's clock, if it has started.
    pub(super) fn look(&mut self, now: Instant, measure: impl FnOnce() -> Option<u64>) -> Option<ClockChange> {
        if self.looked.is_some_and(|looked| now.saturating_duration_since(looked) < LOOK_EVERY) {
            return None;
        }
        let started_ns = measure()?;
        self.looked = Some(now);
        let Some(before_ns) = self.started_ns else {
            self.started_ns = Some(started_ns);
            return Some(ClockChange { started_ns, is_first: true, jump_s: None });
        };
        let has_jumped = started_ns.abs_diff(before_ns) >= JUMP_MIN_NS;
        if has_jumped {
            self.started_ns = Some(started_ns);
        }
        let jump_s = has_jumped.then(|| (started_ns.cast_signed() - before_ns.cast_signed()) as f64 * 1e-9);
        Some(ClockChange { started_ns, is_first: false, jump_s })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clock_that_was_set_is_followed_and_reported_once() {
        let mut clock = UtcClock::default();
        let begin = Instant::now();
        let mut at = |millis, started_ns| clock.look(begin + Duration::from_millis(millis), || started_ns);
        assert_eq!(at(0, None), None, "the loop has not started");
        assert_eq!(at(1, Some(5_000_000_000)).map(|change| change.is_first), Some(true));
        assert_eq!(at(500, Some(1)), None, "not yet");
        let same = at(1100, Some(5_000_090_000)).unwrap();
        assert_eq!((same.is_first, same.jump_s), (false, None));
        let set = at(2200, Some(5_080_000_000)).unwrap();
        assert!((set.jump_s.unwrap() - 0.08).abs() < 1e-9, "{set:?}");
        assert_eq!(at(3300, Some(5_080_000_000)).unwrap().jump_s, None);
    }
}
