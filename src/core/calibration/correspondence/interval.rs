//! Finds the stillest interval of a push near its peak, in one pass with constant memory.

use std::collections::VecDeque;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::PushPair;

#[derive(Clone, Copy, Debug)]
pub(super) struct IntervalReading {
    pub(super) t_s: f64,
    pub(super) f1_n: Vector3<f64>,
    pub(super) f2_n: Vector3<f64>,
    pub(super) s1_from_c: UnitQuaternion<f64>,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct BestInterval {
    pub(super) pair: PushPair,
    /// Standard deviation of the worst axis of either sensor, N.
    pub(super) deviation_n: f64,
}

/// Maximum number of samples in an interval (0.1 s at 10 kHz, with a margin); a faster source gets a shorter interval.
const CAPACITY: usize = 2048;
/// Minimum number of samples for a mean: with fewer, the error of the standard deviation would exceed 22 % (`1 / sqrt(2
/// n)`), and it is used to detect rest.
const MIN_SAMPLES: usize = 10;
/// An interval weaker than this fraction of the strongest one is not near the peak. The force of a push rises and
/// falls, and the two sensors differ most while it changes, so only the top is used.
const NEAR_PEAK: f64 = 0.8;
/// Readings farther apart than this belong to different intervals, s. Longer than a lost reading, because one gap must
/// not cut a push in two.
const LONGEST_GAP_S: f64 = 0.05;

/// A sliding window with running sums, and the best interval so far.
#[derive(Clone, Debug)]
pub(super) struct SlidingInterval {
    length_s: f64,
    window: VecDeque<IntervalReading>,
    sums: StretchSums,
    best: Option<BestInterval>,
}

#[derive(Clone, Copy, Debug, Default)]
struct StretchSums {
    force_n: [Vector3<f64>; 2],
    square_n2: [Vector3<f64>; 2],
}

impl StretchSums {
    fn add(&mut self, reading: &IntervalReading, sign: f64) {
        for (sensor, force_n) in [reading.f1_n, reading.f2_n].iter().enumerate() {
            self.force_n[sensor] += force_n * sign;
            self.square_n2[sensor] += force_n.component_mul(force_n) * sign;
        }
    }

    /// Returns the means of both sensors and the standard deviation of the worst axis.
    fn statistics(&self, count: f64) -> ([Vector3<f64>; 2], f64) {
        let mean_n = self.force_n.map(|sum| sum / count);
        let mut variance = 0.0;
        for (square, mean_n) in self.square_n2.iter().zip(&mean_n) {
            // The difference of sums may be slightly negative by rounding; the maximum starts at zero.
            variance = (square / count - mean_n.component_mul(mean_n)).max().max(variance);
        }
        (mean_n, variance.sqrt())
    }
}

impl SlidingInterval {
    /// Creates a window for intervals of this length, s.
    pub(super) fn new(length_s: f64) -> Self {
        Self { length_s, window: VecDeque::with_capacity(CAPACITY), sums: StretchSums::default(), best: None }
    }

    pub(super) fn clear(&mut self) {
        self.window.clear();
        self.sums = StretchSums::default();
        self.best = None;
    }

    /// Returns the best interval so far; `None` until the window has been full.
    pub(super) const fn best(&self) -> Option<BestInterval> {
        self.best
    }

    /// Adds a reading; returns `true` if the interval that ends with it is the best so far.
    pub(super) fn take(&mut self, reading: &IntervalReading) -> bool {
        if self.window.back().is_some_and(|last| reading.t_s - last.t_s > LONGEST_GAP_S) {
            self.window.clear();
            self.sums = StretchSums::default();
        }
        self.window.push_back(*reading);
        self.sums.add(reading, 1.0);
        // A full buffer counts as a full interval (see `CAPACITY`).
        let mut full = self.window.len() == CAPACITY;
        while let Some(first) = self.window.front().copied()
            && (reading.t_s - first.t_s >= self.length_s || self.window.len() == CAPACITY)
        {
            full = true;
            self.sums.add(&first, -1.0);
            self.window.pop_front();
        }
        full && self.window.len() >= MIN_SAMPLES && self.note()
    }

    fn note(&mut self) -> bool {
        let ([f1_n, f2_n], deviation_n) = self.sums.statistics(self.window.len() as f64);
        let better = self.best.is_none_or(|best| {
            let now_n = f1_n.norm();
            let best_n = best.pair.f1_n.norm();
            // A stronger interval replaces one that was not near the peak; among those near it the steadiest wins.
            best_n < NEAR_PEAK * now_n || (now_n >= NEAR_PEAK * best_n && deviation_n < best.deviation_n)
        });
        if better {
            // The arm is still while it pushes; averaging reduces the tracker's noise.
            let near = self.window.back().map_or_else(UnitQuaternion::identity, |last| last.s1_from_c);
            let sum = self.window.iter().fold(Quaternion::default(), |sum: Quaternion<f64>, reading| {
                let part = reading.s1_from_c.into_inner();
                // A quaternion and its negative are the same rotation, so all are added with the same sign.
                if part.dot(&near) < 0.0 { sum - part } else { sum + part }
            });
            let s1_from_c = UnitQuaternion::try_new(sum, 1e-9).unwrap_or(near);
            self.best = Some(BestInterval { pair: PushPair { f1_n, f2_n, s1_from_c }, deviation_n });
        }
        better
    }
}
