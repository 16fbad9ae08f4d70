//! Percentiles of durations, with constant memory and without allocation while recording.

use hdrhistogram::Histogram;
use serde::Serialize;

/// Longest duration that the histogram resolves, ns (10 s). Longer durations are counted in this bin. A longer pause is
/// a stopped program, whose exact length does not matter, so the memory can be fixed.
const LONGEST_NS: u64 = 10_000_000_000;

/// A histogram of durations with three significant digits.
///
/// ```
/// use nima_core::statistics::Percentiles;
///
/// let mut percentiles = Percentiles::new();
/// for us in 1..=1000 {
///     percentiles.record(f64::from(us) * 1e-6);
/// }
/// let quantiles = percentiles.quantiles();
/// assert!((quantiles.p50 - 500.0).abs() < 1.0 && (quantiles.p99 - 990.0).abs() < 1.0, "{quantiles:?}");
/// ```
#[derive(Clone, Debug)]
pub struct Percentiles {
    histogram: Histogram<u64>,
}

/// Summary of a histogram, microseconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Quantiles {
    pub p50: f64,
    pub p99: f64,
    pub p999: f64,
    pub max: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Bar {
    /// Upper limit, us.
    pub to_us: f64,
    pub count: u64,
}

impl Default for Percentiles {
    fn default() -> Self {
        Self::new()
    }
}

impl Percentiles {
    /// Creates an empty histogram and allocates all of its memory.
    pub fn new() -> Self {
        // The constants are valid bounds; the fallback only avoids an error type in the signature.
        // Three digits resolve 0.1 % of a duration in a histogram of fixed size.
        let histogram = Histogram::new_with_bounds(1, LONGEST_NS, 3)
            .or_else(|_| Histogram::new_with_max(LONGEST_NS, 2))
            .unwrap_or_else(|_| unreachable!("constant bounds"));
        Self { histogram }
    }

    /// Records one duration, s. A negative or non-finite duration counts as zero.
    pub fn record(&mut self, seconds: f64) {
        // The cast saturates: a duration beyond u64 counts as the longest.
        self.histogram.saturating_record((seconds * 1e9).max(0.0) as u64);
    }

    pub fn count(&self) -> u64 {
        self.histogram.len()
    }

    /// Returns the quantiles of all durations so far, microseconds.
    pub fn quantiles(&self) -> Quantiles {
        // From nanoseconds to microseconds.
        let at = |q| self.histogram.value_at_quantile(q) as f64 * 1e-3;
        Quantiles { p50: at(0.5), p99: at(0.99), p999: at(0.999), max: self.histogram.max() as f64 * 1e-3 }
    }

    /// Returns the quantiles; `None` if nothing was recorded.
    pub fn known_quantiles(&self) -> Option<Quantiles> {
        (self.count() > 0).then(|| self.quantiles())
    }

    /// Returns the counts in bars that double in width, from 1 us to the largest duration; empty if nothing was
    /// recorded.
    pub fn histogram(&self) -> Vec<Bar> {
        // From 1000 ns, doubling: quantities of scheduling differ by factors, not by steps.
        let bars = self.histogram.iter_log(1000, 2.0);
        let bars = bars.map(|bar| Bar {
            to_us: (bar.value_iterated_to() + 1) as f64 * 1e-3,
            count: bar.count_since_last_iteration(),
        });
        if self.count() == 0 { Vec::new() } else { bars.collect() }
    }

    /// Returns the counts in `buckets` equal steps of `step_us`; the last one includes everything longer.
    pub fn bars(&self, step_us: f64, buckets: usize) -> Vec<u64> {
        let mut bars = vec![0; buckets.max(1)];
        for value in self.histogram.iter_recorded() {
            let bar = (value.value_iterated_to() as f64 * 1e-3 / step_us) as usize;
            // Everything beyond the last bar is counted in it.
            bars[bar.min(buckets.max(1) - 1)] += value.count_at_value();
        }
        bars
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_of_a_known_set() {
        let mut percentiles = Percentiles::new();
        for us in 1..=1000 {
            percentiles.record(f64::from(us) * 1e-6);
        }
        let q = percentiles.quantiles();
        assert!((q.p50 - 500.0).abs() < 2.0 && (q.p99 - 990.0).abs() < 2.0 && (q.max - 1000.0).abs() < 2.0, "{q:?}");
        assert_eq!(percentiles.bars(100.0, 5).iter().sum::<u64>(), 1000);
        let bars = percentiles.histogram();
        assert_eq!(bars.iter().map(|bar| bar.count).sum::<u64>(), 1000);
        // 1, 2, 4 ... us: durations from 511 to 1000 us are in the last two bars.
        assert!(bars.windows(2).all(|two| (two[1].to_us / two[0].to_us - 2.0).abs() < 1e-9), "{bars:?}");
        assert!(bars.last().is_some_and(|bar| bar.to_us >= 1000.0 && bar.count >= 450), "{bars:?}");
        assert_eq!(Percentiles::new().histogram(), []);
    }

    #[test]
    fn odd_durations_do_no_harm() {
        let mut percentiles = Percentiles::new();
        for seconds in [f64::NAN, -1.0, f64::INFINITY, 1e12] {
            percentiles.record(seconds);
        }
        assert_eq!(percentiles.count(), 4);
    }
}
