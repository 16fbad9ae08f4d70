//! Poses of the tips and of the endoscope's marker in the last 1.5 s, so that drawings in an image belong to its time.

use std::{
    collections::VecDeque,
    time::{Duration, Instant},
};

use nalgebra::{Isometry3, Vector3};
use nima_endoscope::steadied;
use nima_machine::{
    messages::Tick,
    rig::{SIDES, Side},
};

use super::mount::STEADY_S;

/// If a marker was last seen before this time, it may be anywhere, s: some frames of a tracker.
const UNSEEN_S: f64 = 0.2;
/// Time between two stored poses, s, and time for which they are stored, s.
const STEP_S: f64 = 0.005;
const KEPT_S: f64 = 1.5;
/// The loop's clock may be slower than the window's clock by this factor.
const DRIFT: f64 = 1e-3;

/// A tip and the force on it, if known, in the workspace.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TipPose {
    pub(super) tip_m: Vector3<f64>,
    pub(super) measured_n: Option<Vector3<f64>>,
}

#[derive(Debug, Default)]
pub(super) struct Poses {
    kept: [VecDeque<(f64, TipPose)>; SIDES],
    /// The endoscope's marker in the workspace (`world_from_n`), reported by either side.
    markers: VecDeque<(f64, Isometry3<f64>)>,
    begin: Option<Instant>,
    /// Minimum time from a tick to its arrival in the window, as window clock minus loop clock, s; and the time of the
    /// measurement.
    offset_s: Option<(f64, f64)>,
}

impl Poses {
    pub(super) fn note(&mut self, tick: &Tick, now: Instant) {
        let pose = TipPose { tip_m: tick.positions.tip_m, measured_n: tick.known_n() };
        let begin = *self.begin.get_or_insert(now);
        self.take(tick.side, tick.t_s, pose, now.duration_since(begin).as_secs_f64());
        if let Some(world_from_n) = tick.calibration.view.world_from_n() {
            self.take_marker(tick.t_s, *world_from_n);
        }
    }

    fn take_marker(&mut self, t_s: f64, world_from_n: Isometry3<f64>) {
        if !world_from_n.to_homogeneous().iter().all(|x| x.is_finite()) {
            return;
        }
        let last_s = self.markers.back().map(|(last_s, _)| *last_s);
        // The time of a restarted loop begins at zero.
        if last_s.is_some_and(|last_s| t_s < last_s - KEPT_S) {
            self.markers.clear();
        } else if last_s.is_some_and(|last_s| t_s < last_s + STEP_S) {
            return;
        }
        self.markers.push_back((t_s, world_from_n));
        while self.markers.front().is_some_and(|(first_s, _)| *first_s < t_s - KEPT_S) {
            self.markers.pop_front();
        }
    }

    /// Returns the endoscope's marker at the time of an image of this age; `None` if the tracker did not see it then.
    pub(super) fn marker(&self, now: Instant, age: Duration) -> Option<Isometry3<f64>> {
        let now_s = now.duration_since(self.begin?).as_secs_f64();
        self.marker_at(now_s - age.as_secs_f64())
    }

    fn marker_at(&self, window_s: f64) -> Option<Isometry3<f64>> {
        let t_s = window_s - self.offset_s?.0;
        let until = self.markers.partition_point(|(at_s, _)| *at_s <= t_s);
        let before = || self.markers.range(..until).rev();
        let (newest_s, _) = before().next().filter(|(newest_s, _)| *newest_s >= t_s - UNSEEN_S)?;
        steadied(before().take_while(|(at_s, _)| *at_s >= newest_s - STEADY_S).map(|(_, pose)| *pose))
    }

    fn take(&mut self, side: Side, t_s: f64, pose: TipPose, now_s: f64) {
        if !pose.tip_m.iter().all(|x| x.is_finite()) {
            return;
        }
        let kept = &mut self.kept[side.index()];
        // The time of a restarted loop begins at zero.
        if kept.back().is_some_and(|(last_s, _)| t_s < *last_s) {
            kept.clear();
            self.offset_s = None;
        }
        let offset_s = now_s - t_s;
        let min_s = self.offset_s.map_or(offset_s, |(min_s, at_s)| offset_s.min(min_s + DRIFT * (now_s - at_s)));
        self.offset_s = Some((min_s, now_s));
        if kept.back().is_none_or(|(last_s, _)| t_s >= last_s + STEP_S) {
            kept.push_back((t_s, pose));
        }
        while kept.front().is_some_and(|(first_s, _)| *first_s < t_s - KEPT_S) {
            kept.pop_front();
        }
    }

    /// Returns the pose of a side at the time of an image of this age.
    pub(super) fn at(&self, side: Side, now: Instant, age: Duration) -> Option<TipPose> {
        let now_s = now.duration_since(self.begin?).as_secs_f64();
        self.at_s(side, now_s - age.as_secs_f64())
    }

    fn at_s(&self, side: Side, window_s: f64) -> Option<TipPose> {
        let t_s = window_s - self.offset_s?.0;
        let kept = &self.kept[side.index()];
        let after = kept.partition_point(|(at_s, _)| *at_s <= t_s);
        let (Some((from_s, from)), Some((to_s, to))) = (kept.get(after.wrapping_sub(1)), kept.get(after)) else {
            let nearest = if after == 0 { kept.front() } else { kept.back() };
            return nearest.map(|(_, pose)| *pose);
        };
        let fraction = (t_s - from_s) / (to_s - from_s);
        let measured_n = from.measured_n.zip(to.measured_n).map(|(from_n, to_n)| from_n.lerp(&to_n, fraction));
        Some(TipPose { tip_m: from.tip_m.lerp(&to.tip_m, fraction), measured_n })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pose_is_that_of_the_pictures_moment_on_whichever_clock() {
        let mut poses = Poses::default();
        for tick in 0..3000 {
            let t_s = f64::from(tick) * 1e-3;
            let pose = TipPose { tip_m: Vector3::new(t_s, 0.0, 0.0), measured_n: None };
            // The window's clock is 7 s ahead, and the window receives up to 16 ms of ticks at once.
            let now_s = 7.0 + f64::from(tick / 16 * 16 + 15) * 1e-3;
            poses.take(Side::Right, t_s, pose, now_s);
        }
        let x_m = |window_s: f64| poses.at_s(Side::Right, window_s).unwrap().tip_m.x;
        for t_s in [1.6, 2.0, 2.5] {
            assert!((x_m(7.0 + t_s) - t_s).abs() < 2e-3, "{t_s}: {}", x_m(7.0 + t_s));
        }
        assert!((x_m(20.0) - 2.995).abs() < 6e-3, "nothing is newer than the newest");
        assert!(poses.kept[0].len() < 320);
        assert_eq!(poses.at_s(Side::Left, 9.0), None);
    }

    #[test]
    fn the_marker_is_that_of_the_pictures_moment_and_nothing_once_it_is_not_seen() {
        let mut poses = Poses::default();
        let rest = TipPose { tip_m: Vector3::zeros(), measured_n: None };
        for tick in 0..1500 {
            let t_s = f64::from(tick) * 1e-3;
            poses.take(Side::Right, t_s, rest, 5.0 + t_s);
            // The tip jumps by 5 mm after half a second and is hidden after one second.
            let x_m = if tick < 500 { 0.0 } else { 0.005 };
            if tick < 1000 {
                poses.take_marker(t_s, Isometry3::translation(x_m, 0.0, 0.0));
            }
        }
        let x_m = |t_s: f64| poses.marker_at(5.0 + t_s).map(|pose| pose.translation.x);
        for (t_s, expected_m) in [(0.49, 0.0), (0.51, 0.005), (1.1, 0.005)] {
            assert!((x_m(t_s).unwrap() - expected_m).abs() < 1e-9, "{t_s}: {:?}", x_m(t_s));
        }
        assert_eq!(x_m(1.3), None);
        poses.take_marker(-3.0, Isometry3::translation(1.0, 0.0, 0.0));
        assert_eq!(poses.markers.len(), 1, "a loop that began again");
    }

    #[test]
    fn a_loop_that_began_again_is_followed() {
        let mut poses = Poses::default();
        let pose = |x| TipPose { tip_m: Vector3::new(x, 0.0, 0.0), measured_n: None };
        poses.take(Side::Right, 100.0, pose(1.0), 100.0);
        poses.take(Side::Right, 0.0, pose(2.0), 110.0);
        assert!((poses.at_s(Side::Right, 110.0).unwrap().tip_m.x - 2.0).abs() < 1e-12);
    }
}
