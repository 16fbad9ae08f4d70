//! Measures of the motion of one instrument's tip, from its track.

use nalgebra::Vector3;

use crate::{
    ellipsoid::WeightedScatter,
    signal::{DerivativeOrder, STEP_S, TipTrack, magnitudes, mean, peak},
    smoothness::{log_dimensionless_jerk, spectral_arc_length},
};

/// A hand is idle below this speed, m/s.
pub(crate) const IDLE_M_PER_S: f64 = 0.005;
/// A peak of speed counts as a movement if the speed rises and falls by this much around it, m/s.
const PEAK_M_PER_S: f64 = 0.010;
/// Minimum number of steps of a movement whose smoothness is evaluated: 0.3 s.
const MOVEMENT_STEPS: usize = 30;

/// A segment of the track without a gap.
pub(crate) struct TrackSegment<'a> {
    /// Index of the first point on the grid of the trial.
    pub grid: usize,
    pub points: &'a [Vector3<f64>],
    /// m/s, m/s^2 and m/s^3 at each point.
    pub speed: Vec<f64>,
    acceleration: Vec<f64>,
    jerk: Vec<f64>,
}

/// The whole motion of one tip.
pub(crate) struct TipMotion<'a> {
    pub stretches: Vec<TrackSegment<'a>>,
}

impl<'a> TipMotion<'a> {
    pub(crate) fn of(track: &'a TipTrack) -> Self {
        let stretch = |(grid, points)| TrackSegment {
            grid,
            points,
            speed: magnitudes(points, DerivativeOrder::First),
            acceleration: magnitudes(points, DerivativeOrder::Second),
            jerk: magnitudes(points, DerivativeOrder::Third),
        };
        Self { stretches: track.runs().map(stretch).collect() }
    }

    pub(crate) fn path_m(&self) -> Option<f64> {
        self.sum(path_m)
    }

    /// Returns the path up and down, m.
    pub(crate) fn depth_m(&self) -> Option<f64> {
        self.sum(|points| points.windows(2).map(|two| (two[1].z - two[0].z).abs()).sum())
    }

    pub(crate) fn mean_speed(&self) -> Option<f64> {
        mean(self.speeds())
    }

    pub(crate) fn peak_speed(&self) -> Option<f64> {
        peak(self.speeds())
    }

    pub(crate) fn mean_acceleration(&self) -> Option<f64> {
        mean(self.stretches.iter().map(|stretch| stretch.acceleration.as_slice()))
    }

    pub(crate) fn peak_acceleration(&self) -> Option<f64> {
        peak(self.stretches.iter().map(|stretch| stretch.acceleration.as_slice()))
    }

    pub(crate) fn mean_jerk(&self) -> Option<f64> {
        mean(self.stretches.iter().map(|stretch| stretch.jerk.as_slice()))
    }

    pub(crate) fn idle_s(&self) -> Option<f64> {
        let idle = self.speeds().flatten().filter(|speed| **speed < IDLE_M_PER_S).count();
        (!self.stretches.is_empty()).then_some(idle as f64 * STEP_S)
    }

    pub(crate) fn movements(&self) -> Option<f64> {
        let count = self.speeds().map(peaks).sum::<usize>();
        (!self.stretches.is_empty()).then_some(count as f64)
    }

    pub(crate) fn volume_m3(&self) -> Option<f64> {
        let mut cloud = WeightedScatter::default();
        for point in self.stretches.iter().flat_map(|stretch| stretch.points) {
            cloud.add(point, 1.0);
        }
        cloud.volume()
    }

    /// Returns log dimensionless jerk and spectral arc length of the longest segment.
    pub(crate) fn smoothness(&self) -> [Option<f64>; 2] {
        let longest = self.stretches.iter().reduce(|a, b| if b.points.len() > a.points.len() { b } else { a });
        longest.map_or([None; 2], |stretch| smoothness(&stretch.speed, &stretch.jerk))
    }

    /// Returns the same, as means over the movements: segments of at least 0.3 s in which the hand is not idle.
    pub(crate) fn smoothness_of_movements(&self) -> [Option<f64>; 2] {
        let mut sums = [(0.0, 0_u32); 2];
        for stretch in &self.stretches {
            let mut start = 0;
            for movement in stretch.speed.chunk_by(|a, b| (*a < IDLE_M_PER_S) == (*b < IDLE_M_PER_S)) {
                let jerk = stretch.jerk.get(start..start + movement.len());
                start += movement.len();
                let long = movement.len() > MOVEMENT_STEPS && movement[0] >= IDLE_M_PER_S;
                let values = jerk.filter(|_| long).map_or([None; 2], |jerk| smoothness(movement, jerk));
                for (sum, value) in sums.iter_mut().zip(values) {
                    *sum = value.map_or(*sum, |value| (sum.0 + value, sum.1 + 1));
                }
            }
        }
        sums.map(|(sum, count)| (count > 0).then(|| sum / f64::from(count)))
    }

    fn speeds(&self) -> impl Iterator<Item = &[f64]> {
        self.stretches.iter().map(|stretch| stretch.speed.as_slice())
    }

    fn sum(&self, of: impl Fn(&[Vector3<f64>]) -> f64) -> Option<f64> {
        (!self.stretches.is_empty()).then(|| self.stretches.iter().map(|stretch| of(stretch.points)).sum())
    }
}

/// Returns the length of the path through the points, m.
pub(crate) fn path_m(points: &[Vector3<f64>]) -> f64 {
    points.windows(2).map(|two| (two[1] - two[0]).norm()).sum()
}

fn smoothness(speed: &[f64], jerk: &[f64]) -> [Option<f64>; 2] {
    [log_dimensionless_jerk(speed, jerk), spectral_arc_length(speed)]
}

/// Returns the number of peaks of a speed that starts from rest: reversals of at least [`PEAK_M_PER_S`] after a rise of
/// as much. A peak that is cut off by the end counts.
fn peaks(speed: &[f64]) -> usize {
    let mut count = 0;
    let mut rising = false;
    let mut turn = 0.0;
    for now in speed {
        if rising {
            turn = f64::max(turn, *now);
            if *now < turn - PEAK_M_PER_S {
                rising = false;
                turn = *now;
            }
        } else {
            turn = f64::min(turn, *now);
            if *now > turn + PEAK_M_PER_S {
                rising = true;
                turn = *now;
                count += 1;
            }
        }
    }
    count
}
