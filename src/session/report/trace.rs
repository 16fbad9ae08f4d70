//! A quantity over time, small enough for a page: the minimum and the maximum of each bucket.

use serde::Serialize;

// Design choice: more than a page shows would only enlarge the report.
pub const BUCKETS: usize = 600;

/// The minimum and the maximum of each bucket; `None` where there is no value.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SignalTrace {
    /// Length of a bucket, s; the first begins with the session.
    pub step_s: f64,
    /// Minimum and maximum.
    pub buckets: Vec<Option<[f64; 2]>>,
}

impl SignalTrace {
    /// Creates an empty trace for a session of this length.
    pub(super) fn over(length_s: f64) -> Self {
        Self { step_s: length_s.max(1e-3) / BUCKETS as f64, buckets: vec![None; BUCKETS] }
    }

    /// Adds a value; a value that is not finite is left out.
    pub(super) fn add(&mut self, t_s: f64, value: f64) {
        if value.is_finite() {
            let place = ((t_s / self.step_s).max(0.0) as usize).min(BUCKETS - 1);
            let bucket = self.buckets[place].get_or_insert([value; 2]);
            *bucket = [bucket[0].min(value), bucket[1].max(value)];
        }
    }

    pub fn largest(&self) -> f64 {
        self.buckets.iter().flatten().fold(0.0, |largest, bucket| bucket[1].max(largest))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_peak_is_lost() {
        let mut trace = SignalTrace::over(60.0);
        for i in 0..60_000 {
            trace.add(f64::from(i) * 1e-3, if i == 12_345 { 9.0 } else { 1.0 });
        }
        trace.add(1.0, f64::NAN);
        trace.add(1e9, 2.0);
        assert_eq!(
            (trace.buckets[123], trace.buckets[122], trace.largest()),
            (Some([1.0, 9.0]), Some([1.0, 1.0]), 9.0)
        );
        assert_eq!(trace.buckets[BUCKETS - 1], Some([1.0, 2.0]));
    }
}
