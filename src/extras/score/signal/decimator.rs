//! Converts uneven samples to 100 Hz without aliasing and without delay.

use std::f64::consts::PI;

use nalgebra::Vector3;

use super::TipTrack;

/// A longer step, s, is a gap in which the motion is unknown.
pub(crate) const LONGEST_GAP_S: f64 = 0.1;

/// Step of the evenly spaced samples that are filtered, s.
const TICK_S: f64 = 1e-3;
/// One of this many even samples is kept.
const EVERY: u64 = 10;
/// Half width of the filter in even samples.
const REACH: u64 = 80;
const TAPS: usize = 2 * REACH as usize + 1;
/// Half the amplitude passes at this frequency, Hz. With the Hamming window over 161 ms the filter is flat within 0.1
/// dB up to 10 Hz, the range of SPARC, and passes less than 1/300 above 31 Hz; frequencies that alias below 20 Hz are
/// above 80 Hz.
const CUTOFF_HZ: f64 = 20.0;
/// Tolerance of time comparisons, s.
const TOLERANCE_S: f64 = 1e-6;

/// Interpolates to 1 kHz, filters with a symmetric window (no delay), keeps 100 Hz. Memory: 161 samples and the track.
///
/// Beyond either end of a segment the motion is continued by point reflection about its end. This continues a hand that
/// starts or stops there, or moves on evenly, smoothly.
#[derive(Clone, Debug)]
pub(crate) struct Decimator {
    taps: [f64; TAPS],
    /// The newest even samples, indexed by their number modulo the length.
    window: Vec<Vector3<f64>>,
    last: Option<(f64, Vector3<f64>)>,
    /// Number of the next even sample; of the first and the last one of the segment.
    next: u64,
    stretch: Option<[u64; 2]>,
    /// Number of the even sample at the next point of the track.
    next_point: u64,
    track: TipTrack,
}

impl Decimator {
    /// Allocates memory for this many seconds.
    pub(crate) fn with_room(seconds: f64) -> Self {
        let taps = low_pass();
        let window = vec![Vector3::zeros(); TAPS];
        Self { taps, window, last: None, next: 0, stretch: None, next_point: 0, track: TipTrack::with_room(seconds) }
    }

    /// Adds one sample, `t_s` after the beginning of the trial, later than the previous one.
    pub(crate) fn take(&mut self, t_s: f64, value: Vector3<f64>) {
        let known = self.last.filter(|(before_s, _)| t_s - before_s <= LONGEST_GAP_S && t_s > *before_s);
        let (before_s, before) = known.unwrap_or_else(|| {
            self.close();
            self.next = ((t_s - TOLERANCE_S) / TICK_S).ceil().max(0.0) as u64;
            (t_s, value)
        });
        while self.next as f64 * TICK_S <= t_s + TOLERANCE_S {
            let fraction = if t_s > before_s { (self.next as f64 * TICK_S - before_s) / (t_s - before_s) } else { 1.0 };
            self.even(before + (value - before) * fraction.clamp(0.0, 1.0));
        }
        self.last = Some((t_s, value));
    }

    /// Ends the last segment and returns the track.
    pub(crate) fn finish(mut self) -> TipTrack {
        self.close();
        self.track
    }

    fn even(&mut self, value: Vector3<f64>) {
        let now = self.next;
        self.next += 1;
        let first = self.stretch.map_or(now, |[first, _]| first);
        if self.stretch.is_none() {
            self.next_point = now.next_multiple_of(EVERY);
        }
        self.stretch = Some([first, now]);
        self.window[now as usize % TAPS] = value;
        if self.next_point + REACH <= now {
            self.point(first, now);
        }
    }

    fn close(&mut self) {
        if let Some([first, last]) = self.stretch.take() {
            while self.next_point <= last {
                self.point(first, last);
            }
        }
        self.last = None;
    }

    fn point(&mut self, first: u64, last: u64) {
        let mut sum = Vector3::zeros();
        for (tap, weight) in self.taps.iter().enumerate() {
            // Relative to the first sample the numbers may be negative.
            let place = (self.next_point - first + tap as u64).cast_signed() - REACH.cast_signed();
            sum += self.continued(first, last, place) * *weight;
        }
        self.track.push((self.next_point / EVERY) as usize, sum);
        self.next_point += EVERY;
    }

    /// Returns an even sample by its index relative to the first one of the segment; the index may be beyond either
    /// end.
    fn continued(&self, first: u64, last: u64, place: i64) -> Vector3<f64> {
        let end = (last - first).cast_signed();
        let at = |place: i64| self.window[(first + place.cast_unsigned()) as usize % TAPS];
        if place < 0 {
            at(0) * 2.0 - at((-place).min(end))
        } else if place > end {
            at(end) * 2.0 - at((2 * end - place).max(0))
        } else {
            at(place)
        }
    }
}

/// Returns a windowed sinc of unit sum.
fn low_pass() -> [f64; TAPS] {
    let mut taps = std::array::from_fn(|tap| {
        let from_middle = tap as f64 - REACH as f64;
        let angle = 2.0 * PI * CUTOFF_HZ * TICK_S * from_middle;
        let sinc = if from_middle == 0.0 { 1.0 } else { libm::sin(angle) / angle };
        sinc * (0.54 + 0.46 * libm::cos(PI * from_middle / REACH as f64))
    });
    let sum: f64 = taps.iter().sum();
    for tap in &mut taps {
        *tap /= sum;
    }
    taps
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the output amplitude of a sine, in the middle of 4 s.
    fn passes(hz: f64, even: impl Fn(u32) -> f64) -> f64 {
        let mut decimator = Decimator::with_room(4.0);
        for k in 0..4000 {
            let t_s = even(k);
            decimator.take(t_s, Vector3::new((2.0 * PI * hz * t_s).sin(), (2.0 * PI * hz * t_s).cos(), 1.0));
        }
        let track = decimator.finish();
        let points = track.runs().next().unwrap().1;
        assert!(points.iter().all(|point| (point.z - 1.0).abs() < 1e-12));
        points[100..300].iter().map(|point| point.x.hypot(point.y)).fold(0.0, f64::max)
    }

    #[test]
    fn the_filter_is_flat_to_10_hz_and_closed_from_31_hz() {
        let exact = |k: u32| f64::from(k) * 1e-3;
        for hz in [0.5, 2.0, 5.0, 10.0] {
            assert!((passes(hz, exact) - 1.0).abs() < 0.012, "{hz} Hz: {}", passes(hz, exact));
        }
        assert!((passes(20.0, exact) - 0.5).abs() < 0.01, "{}", passes(20.0, exact));
        for hz in [31.0, 50.0, 90.0, 110.0, 430.0] {
            assert!(passes(hz, exact) < 1.0 / 300.0, "{hz} Hz: {}", passes(hz, exact));
        }
    }

    #[test]
    fn uneven_steps_give_the_same_points() {
        let jittered = |k: u32| f64::from(k) * 1e-3 + if k.is_multiple_of(3) { 4e-4 } else { 0.0 };
        let exact = |k: u32| f64::from(k) * 1e-3;
        assert!((passes(3.0, jittered) - passes(3.0, exact)).abs() < 2e-4);
    }

    #[test]
    fn a_gap_parts_the_track() {
        let mut decimator = Decimator::with_room(1.0);
        for k in (0..300).chain(500..900) {
            decimator.take(f64::from(k) * 1e-3, Vector3::new(f64::from(k), 0.0, 0.0));
        }
        let track = decimator.finish();
        let runs: Vec<_> = track.runs().map(|(grid, points)| (grid, points.len())).collect();
        assert_eq!(runs, [(0, 30), (50, 40)]);
        for (grid, points) in track.runs() {
            for (k, point) in points.iter().enumerate() {
                assert!((point.x - 10.0 * (grid + k) as f64).abs() < 1e-9, "a straight line stays one: {point:?}");
            }
        }
    }
}
