//! A track at 100 Hz, in segments without gaps.

use nalgebra::Vector3;

pub(crate) const RATE_HZ: f64 = 100.0;
pub(crate) const STEP_S: f64 = 1.0 / RATE_HZ;

/// Minimum number of points of a segment: with five points the first derivative does not depend only on its ends.
const MIN_POINTS: usize = 5;

/// Points at multiples of [`STEP_S`] from the beginning of the trial.
#[derive(Clone, Debug, Default)]
pub(crate) struct TipTrack {
    points: Vec<Vector3<f64>>,
    runs: Vec<TrackRun>,
}

#[derive(Clone, Copy, Debug)]
struct TrackRun {
    /// Index of its first point on the grid of the trial.
    grid: usize,
    /// Index of its first point in `points`.
    start: usize,
    len: usize,
}

impl TipTrack {
    /// Allocates memory for this many seconds, so that a trial of this length does not allocate more.
    pub(super) fn with_room(seconds: f64) -> Self {
        Self { points: Vec::with_capacity((seconds * RATE_HZ) as usize + 1), runs: Vec::with_capacity(64) }
    }

    pub(super) fn push(&mut self, grid: usize, point: Vector3<f64>) {
        match self.runs.last_mut() {
            Some(run) if run.grid + run.len == grid => run.len += 1,
            _ => self.runs.push(TrackRun { grid, start: self.points.len(), len: 1 }),
        }
        self.points.push(point);
    }

    /// Returns the segments without gaps: index of the first point on the grid, and the points. Segments under 50 ms
    /// are left out.
    pub(crate) fn runs(&self) -> impl Iterator<Item = (usize, &[Vector3<f64>])> {
        let long = self.runs.iter().filter(|run| run.len >= MIN_POINTS);
        long.filter_map(|run| Some((run.grid, self.points.get(run.start..run.start + run.len)?)))
    }
}
