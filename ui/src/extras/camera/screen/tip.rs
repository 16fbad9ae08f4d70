//! The instrument's tip while it is held still on a corner of the board, and the endoscope's marker at that time.

use std::collections::VecDeque;

use nalgebra::{Isometry3, Vector3};
use nima_endoscope::steadied;

/// Interval of stored positions, s, and storage time, s.
const STEP_S: f64 = 0.01;
const KEPT_S: f64 = 0.4;
/// Required holding time, s, and maximum distance from the mean, m.
const HELD_S: f64 = 0.3;
const STILL_M: f64 = 0.3e-3;

#[derive(Debug, Default)]
pub(super) struct CameraTip {
    kept: VecDeque<(f64, Vector3<f64>)>,
}

impl CameraTip {
    pub(super) fn note(&mut self, t_s: f64, tip_m: Vector3<f64>) {
        if !tip_m.iter().all(|x| x.is_finite()) {
            self.kept.clear();
            return;
        }
        match self.kept.back() {
            // The time of a restarted loop begins at zero.
            Some((last_s, _)) if t_s < *last_s => self.kept.clear(),
            Some((last_s, _)) if t_s < last_s + STEP_S => return,
            _ => {}
        }
        self.kept.push_back((t_s, tip_m));
        while self.kept.front().is_some_and(|(first_s, _)| *first_s < t_s - KEPT_S) {
            self.kept.pop_front();
        }
    }

    /// Returns its position, m; `None` while it moves.
    pub(super) fn still_m(&self) -> Option<Vector3<f64>> {
        let first = self.kept.front()?;
        let last = self.kept.back()?;
        if last.0 - first.0 < HELD_S {
            return None;
        }
        let mean_m = self.kept.iter().map(|(_, tip_m)| tip_m).sum::<Vector3<f64>>() / self.kept.len() as f64;
        self.kept.iter().all(|(_, tip_m)| (tip_m - mean_m).norm() < STILL_M).then_some(mean_m)
    }
}

/// Averaging time of the marker, s.
const MARKED_S: f64 = 5.0;

#[derive(Debug, Default)]
pub(super) struct EndoscopeMarker {
    kept: VecDeque<(f64, Isometry3<f64>)>,
}

impl EndoscopeMarker {
    /// Adds a tick; both sides report the same marker.
    pub(super) fn note(&mut self, t_s: f64, world_from_n: Option<&Isometry3<f64>>) {
        if self.kept.back().is_some_and(|(last_s, _)| t_s < *last_s) {
            self.kept.clear();
        }
        let Some(world_from_n) = world_from_n else { return };
        if self.kept.back().is_none_or(|(last_s, _)| t_s >= last_s + STEP_S) {
            self.kept.push_back((t_s, *world_from_n));
        }
        while self.kept.front().is_some_and(|(first_s, _)| *first_s < t_s - MARKED_S) {
            self.kept.pop_front();
        }
    }

    /// Returns its mean without noise; `None` if it was not seen.
    pub(super) fn world_from_n(&self) -> Option<Isometry3<f64>> {
        steadied(self.kept.iter().rev().map(|(_, pose)| *pose))
    }
}
