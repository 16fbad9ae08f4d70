//! Data of the traces: minima and maxima per time bucket, updated with every sample, at three resolutions.
//!
//! A frame reads at most a few thousand buckets and no raw samples, so drawing costs the same after an hour as after a
//! minute, and memory is constant. Times are seconds on the loop's clock; nothing depends on the unit of a value.

use std::collections::VecDeque;

use egui_plot::PlotPoint;

pub use crate::signals::CHANNELS;

/// Number of buckets per level.
const CAPACITY: usize = 8192;
/// Length of a bucket on each level, s: covers the last 33 s, two minutes, nine minutes.
const SPANS_S: [f64; 3] = [0.004, 0.016, 0.064];

/// A longer interval without samples is drawn as a gap, s; shorter ones are bridged.
const GAP_S: f64 = 0.05;

/// A signal to be drawn: columns with rising x, in runs separated by gaps.
#[derive(Clone, Debug, Default)]
pub struct PlotTrace {
    /// Middle of each column.
    points: Vec<PlotPoint>,
    x: Vec<f64>,
    low: Vec<f64>,
    high: Vec<f64>,
    /// Index of the first column of each run except the first.
    breaks: Vec<usize>,
}

/// Lowest and highest sample of a channel in a column; `None` without a known sample.
pub type SampleExtent = Option<(f32, f32)>;

/// Columns without a gap.
#[derive(Clone, Copy, Debug)]
pub struct TraceRun<'a> {
    /// Middle of each column.
    pub points: &'a [PlotPoint],
    pub x: &'a [f64],
    pub low: &'a [f64],
    pub high: &'a [f64],
}

impl PlotTrace {
    fn clear(&mut self) {
        self.points.clear();
        self.breaks.clear();
        for values in [&mut self.x, &mut self.low, &mut self.high] {
            values.clear();
        }
    }

    /// Returns the runs, oldest first.
    pub fn runs(&self) -> impl Iterator<Item = TraceRun<'_>> {
        let begins = std::iter::once(0).chain(self.breaks.iter().copied());
        let ends = self.breaks.iter().copied().chain(std::iter::once(self.points.len()));
        let run = |(begin, end): (usize, usize)| TraceRun {
            points: &self.points[begin..end],
            x: &self.x[begin..end],
            low: &self.low[begin..end],
            high: &self.high[begin..end],
        };
        begins.zip(ends).filter(|(begin, end)| begin < end).map(run)
    }
}

#[derive(Clone, Copy, Debug)]
struct HistoryBucket {
    low: [f32; CHANNELS],
    high: [f32; CHANNELS],
}

impl HistoryBucket {
    const EMPTY: Self = Self { low: [f32::INFINITY; CHANNELS], high: [f32::NEG_INFINITY; CHANNELS] };

    fn add(&mut self, values: &[f32; CHANNELS]) {
        for (channel, &value) in values.iter().enumerate() {
            // `min` and `max` ignore NaN.
            self.low[channel] = self.low[channel].min(value);
            self.high[channel] = self.high[channel].max(value);
        }
    }

    fn ends(&self, channel: usize) -> Option<(f32, f32)> {
        (self.low[channel] <= self.high[channel]).then_some((self.low[channel], self.high[channel]))
    }
}

#[derive(Debug)]
struct HistoryLevel {
    span_s: f64,
    /// Number of the first stored bucket, counted from time zero.
    first: u64,
    buckets: VecDeque<HistoryBucket>,
}

impl HistoryLevel {
    fn new(span_s: f64) -> Self {
        Self { span_s, first: 0, buckets: VecDeque::with_capacity(CAPACITY) }
    }

    fn number(&self, t_s: f64) -> u64 {
        (t_s / self.span_s).floor().max(0.0) as u64
    }

    fn push(&mut self, t_s: f64, values: &[f32; CHANNELS]) {
        let number = self.number(t_s);
        let end = self.first + self.buckets.len() as u64;
        // After such a pause no stored bucket would remain.
        if self.buckets.is_empty() || number >= end + CAPACITY as u64 {
            self.buckets.clear();
            self.first = number;
        }
        // Missing samples leave empty buckets, so that the index always corresponds to the time.
        while self.first + (self.buckets.len() as u64) <= number {
            if self.buckets.len() == CAPACITY {
                self.buckets.pop_front();
                self.first += 1;
            }
            self.buckets.push_back(HistoryBucket::EMPTY);
        }
        let place = number.checked_sub(self.first).and_then(|place| self.buckets.get_mut(place as usize));
        if let Some(bucket) = place {
            bucket.add(values);
        }
    }

    fn reaches_back_to(&self, t_s: f64) -> bool {
        self.number(t_s) >= self.first
    }

    /// Returns the stored buckets that overlap `from_s..=to_s`, with the start time of each.
    fn between(&self, from_s: f64, to_s: f64) -> impl Iterator<Item = (f64, &HistoryBucket)> {
        let from = self.number(from_s).saturating_sub(self.first).min(self.buckets.len() as u64) as usize;
        let to = (self.number(to_s) + 1).saturating_sub(self.first).min(self.buckets.len() as u64) as usize;
        let range = from..to.max(from);
        let first = self.first;
        let span_s = self.span_s;
        self.buckets
            .range(range)
            .enumerate()
            .map(move |(i, bucket)| ((first + from as u64 + i as u64) as f64 * span_s, bucket))
    }
}

/// Minima and maxima of [`CHANNELS`] signals over the last minutes.
#[derive(Debug)]
pub struct SignalHistory {
    levels: [HistoryLevel; SPANS_S.len()],
    began_s: Option<f64>,
    latest_s: f64,
    gap_s: f64,
}

impl Default for SignalHistory {
    fn default() -> Self {
        Self { levels: SPANS_S.map(HistoryLevel::new), began_s: None, latest_s: 0.0, gap_s: GAP_S }
    }
}

impl SignalHistory {
    /// Adds a sample at `t_s` (s; not earlier than the previous one by more than the stored time).
    pub fn push(&mut self, t_s: f64, values: &[f32; CHANNELS]) {
        if !t_s.is_finite() || t_s < 0.0 {
            return;
        }
        self.began_s.get_or_insert(t_s);
        self.latest_s = self.latest_s.max(t_s);
        for level in &mut self.levels {
            level.push(t_s, values);
        }
    }

    /// Also bridges longer intervals without samples, up to this one, s: for slow recordings.
    pub const fn bridge(&mut self, gap_s: f64) {
        self.gap_s = GAP_S.max(gap_s);
    }

    /// Returns the time of the newest sample, s.
    pub const fn latest_s(&self) -> f64 {
        self.latest_s
    }

    /// Returns the time of the oldest stored sample, s.
    pub fn oldest_s(&self) -> f64 {
        let coarsest = &self.levels[SPANS_S.len() - 1];
        self.began_s.unwrap_or(0.0).max(coarsest.first as f64 * coarsest.span_s)
    }

    /// Returns the finest level that reaches back to `from_s` and has at most about `max` buckets up to `to_s`.
    fn level(&self, from_s: f64, to_s: f64, max: usize) -> &HistoryLevel {
        let from_s = from_s.max(self.oldest_s());
        let fits =
            |level: &&HistoryLevel| (to_s - from_s) / level.span_s <= max as f64 && level.reaches_back_to(from_s);
        self.levels.iter().find(fits).unwrap_or(&self.levels[SPANS_S.len() - 1])
    }

    /// Replaces `trace` by the signal between two times, a column per bucket, x relative to `origin_s`. The newest bucket is
    /// included when it is full.
    pub fn trace(&self, channel: usize, (from_s, to_s): (f64, f64), origin_s: f64, max: usize, trace: &mut PlotTrace) {
        trace.clear();
        let level = self.level(from_s, to_s, max);
        let mut last_s = f64::INFINITY;
        for (begin_s, bucket) in level.between(from_s, to_s) {
            // Skip a bucket that is still being filled, because it would change from frame to frame.
            if begin_s + level.span_s > self.latest_s {
                break;
            }
            let Some((low, high)) = bucket.ends(channel) else { continue };
            if begin_s - last_s > self.gap_s + level.span_s {
                trace.breaks.push(trace.points.len());
            }
            last_s = begin_s;
            let [low, high] = [low, high].map(f64::from);
            let x_s = begin_s - origin_s + 0.5 * level.span_s;
            trace.points.push(PlotPoint::new(x_s, f64::midpoint(low, high)));
            trace.x.push(x_s);
            trace.low.push(low);
            trace.high.push(high);
        }
    }

    /// Returns the times (s), lowest and highest values of these channels between two times, for a table: as fine as the
    /// traces drawn with the same `max`.
    pub fn table(&self, channels: &[usize], (from_s, to_s): (f64, f64), max: usize) -> Vec<(f64, Vec<SampleExtent>)> {
        let level = self.level(from_s, to_s, max);
        let full = level.between(from_s, to_s).filter(|(begin_s, _)| begin_s + level.span_s <= self.latest_s);
        full.map(|(begin_s, bucket)| (begin_s, channels.iter().map(|channel| bucket.ends(*channel)).collect()))
            .collect()
    }

    /// Returns the lowest and highest value of the channels between two times.
    pub fn extent(&self, channels: &[usize], (from_s, to_s): (f64, f64)) -> Option<(f64, f64)> {
        let mut extent: Option<(f32, f32)> = None;
        // Coarse buckets have the same lowest and highest values.
        for (_, bucket) in self.level(from_s, to_s, 1000).between(from_s, to_s) {
            for (low, high) in channels.iter().filter_map(|&channel| bucket.ends(channel)) {
                extent = Some(extent.map_or((low, high), |(l, h)| (l.min(low), h.max(high))));
            }
        }
        extent.map(|(low, high)| (f64::from(low), f64::from(high)))
    }

    /// Returns the value of a channel at a time: the middle of its bucket on the finest level that has it.
    pub fn value_at(&self, channel: usize, t_s: f64) -> Option<f64> {
        // A time before zero has no bucket, and would be read from the first one.
        if t_s < self.oldest_s() {
            return None;
        }
        let level = self.levels.iter().find(|level| level.reaches_back_to(t_s))?;
        let (_, bucket) = level.between(t_s, t_s).next()?;
        bucket.ends(channel).map(|(low, high)| f64::midpoint(f64::from(low), f64::from(high)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn filled(seconds: f64, rate_hz: f64, value: impl Fn(f64) -> f32) -> SignalHistory {
        let mut history = SignalHistory::default();
        for i in 0..(seconds * rate_hz) as u64 {
            let t_s = i as f64 / rate_hz;
            history.push(t_s, &[value(t_s); CHANNELS]);
        }
        history
    }

    fn one_run(trace: &PlotTrace) -> TraceRun<'_> {
        assert_eq!(trace.breaks, [0; 0]);
        trace.runs().next().unwrap()
    }

    #[test]
    fn nothing_is_read_before_the_first_sample() {
        let history = filled(2.0, 1000.0, |_| 1.0);
        assert_eq!([-3.0, -0.001, 1.0].map(|t_s| history.value_at(0, t_s)), [None, None, Some(1.0)]);
    }

    #[test]
    fn a_stall_is_drawn_as_a_gap_and_a_missed_tick_is_not() {
        let mut history = SignalHistory::default();
        for i in (0..1000).filter(|i| !(300..600).contains(i) && i % 10 != 0) {
            history.push(f64::from(i) * 1e-3, &[1.0; CHANNELS]);
        }
        let mut trace = PlotTrace::default();
        for max in [10_000, 20] {
            history.trace(0, (0.0, 1.0), 0.0, max, &mut trace);
            assert_eq!(trace.runs().count(), 2);
            assert!(trace.runs().all(|run| run.x.is_sorted()));
        }
    }

    #[test]
    fn a_spike_of_one_sample_survives_at_every_resolution() {
        let history = filled(120.0, 1000.0, |t_s| if (t_s - 100.0).abs() < 5e-4 { 3.0 } else { 0.0 });
        let mut line = PlotTrace::default();
        for (from_s, max) in [(99.9, 10_000), (90.0, 2000), (0.0, 2000), (0.0, 10)] {
            history.trace(0, (from_s, 120.0), 120.0, max, &mut line);
            let run = one_run(&line);
            assert!(run.high.iter().any(|high| (high - 3.0).abs() < 1e-9), "lost from {from_s}");
            assert!(run.x.is_sorted(), "x must rise, or plotting falls off its fast path");
        }
    }

    #[test]
    fn drawing_never_costs_more_than_the_kept_buckets() {
        let history = filled(700.0, 1000.0, |t_s| t_s as f32);
        let mut line = PlotTrace::default();
        history.trace(0, (0.0, 700.0), 700.0, 1000, &mut line);
        assert!(one_run(&line).points.len() <= CAPACITY);
        history.trace(0, (690.0, 700.0), 700.0, 1000, &mut line);
        assert!((300..=1001).contains(&one_run(&line).points.len()), "{}", one_run(&line).points.len());
        assert!(history.oldest_s() > 170.0 && history.oldest_s() < 180.0, "{}", history.oldest_s());
    }

    #[test]
    fn samples_of_one_column_are_a_band_around_their_middle() {
        let mut history = SignalHistory::default();
        history.push(0.000, &[1.0; CHANNELS]);
        history.push(0.001, &[-2.0; CHANNELS]);
        history.push(0.004, &[-9.0; CHANNELS]);
        let mut line = PlotTrace::default();
        history.trace(2, (0.0, 0.003), 0.0, 100, &mut line);
        let run = one_run(&line);
        assert_eq!((run.low, run.high, run.points[0].y), (&[-2.0][..], &[1.0][..], -0.5));
        assert_eq!(history.table(&[2], (0.0, 0.003), 100), [(0.0, vec![Some((-2.0, 1.0))])]);
    }

    #[test]
    fn a_gap_stays_a_gap_and_bad_input_is_left_out() {
        let mut history = SignalHistory::default();
        history.push(0.0, &[1.0; CHANNELS]);
        history.push(f64::NAN, &[9.0; CHANNELS]);
        history.push(0.5, &[f32::NAN; CHANNELS]);
        history.push(1.0, &[2.0; CHANNELS]);
        assert_eq!(history.value_at(0, 0.5), None);
        assert_eq!(history.value_at(0, 1.0), Some(2.0));
        assert_eq!(history.extent(&[0, 5], (0.0, 2.0)), Some((1.0, 2.0)));
        history.push(1e5, &[3.0; CHANNELS]);
        assert_eq!(history.extent(&[0], (0.0, 1e6)), Some((3.0, 3.0)), "a jump beyond the stored range starts again");
    }

    #[test]
    fn nothing_is_drawn_from_nothing() {
        let history = SignalHistory::default();
        let mut line = PlotTrace { points: vec![PlotPoint::new(0.0, 0.0)], ..PlotTrace::default() };
        history.trace(0, (-10.0, 0.0), 0.0, 100, &mut line);
        assert_eq!(line.runs().count(), 0);
        assert_eq!(history.extent(&[0], (-10.0, 0.0)), None);
    }
}
