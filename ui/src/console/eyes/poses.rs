//! Where the tips were in the last second and a half, so that what is drawn into a picture belongs to its moment.

use std::{
    collections::VecDeque,
    time::{Duration, Instant},
};

use nalgebra::Vector3;
use nima_machine::{
    messages::Tick,
    rig::{SIDES, Side},
};

/// Time between two poses that are kept, s, and how long they are, s.
const STEP_S: f64 = 0.005;
const KEPT_S: f64 = 1.5;
/// The loop's clock may run this much slower than the window's.
const DRIFT: f64 = 1e-3;

/// A tip and the force on it, in the workspace.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pose {
    pub(super) tip_m: Vector3<f64>,
    pub(super) measured_n: Vector3<f64>,
}

#[derive(Debug, Default)]
pub(super) struct Poses {
    kept: [VecDeque<(f64, Pose)>; SIDES],
    begin: Option<Instant>,
    /// Least time from a tick until the window had it, on the window's clock minus the loop's, s; and when it was last seen.
    offset_s: Option<(f64, f64)>,
}

impl Poses {
    pub(super) fn note(&mut self, tick: &Tick, now: Instant) {
        let pose = Pose { tip_m: tick.tip_m, measured_n: tick.measured_n };
        let begin = *self.begin.get_or_insert(now);
        self.take(tick.side, tick.t_s, pose, now.duration_since(begin).as_secs_f64());
    }

    fn take(&mut self, side: Side, t_s: f64, pose: Pose, now_s: f64) {
        if !pose.tip_m.iter().chain(&pose.measured_n).all(|x| x.is_finite()) {
            return;
        }
        let kept = &mut self.kept[side.index()];
        // A loop that was started again begins at zero.
        if kept.back().is_some_and(|(last_s, _)| t_s < *last_s) {
            kept.clear();
            self.offset_s = None;
        }
        let offset_s = now_s - t_s;
        let least_s = self.offset_s.map_or(offset_s, |(least_s, at_s)| offset_s.min(least_s + DRIFT * (now_s - at_s)));
        self.offset_s = Some((least_s, now_s));
        if kept.back().is_none_or(|(last_s, _)| t_s >= last_s + STEP_S) {
            kept.push_back((t_s, pose));
        }
        while kept.front().is_some_and(|(first_s, _)| *first_s < t_s - KEPT_S) {
            kept.pop_front();
        }
    }

    /// The pose of a side when a picture was made that is so old now.
    pub(super) fn at(&self, side: Side, now: Instant, age: Duration) -> Option<Pose> {
        let now_s = now.duration_since(self.begin?).as_secs_f64();
        self.at_s(side, now_s - age.as_secs_f64())
    }

    fn at_s(&self, side: Side, window_s: f64) -> Option<Pose> {
        let t_s = window_s - self.offset_s?.0;
        let kept = &self.kept[side.index()];
        let after = kept.partition_point(|(at_s, _)| *at_s <= t_s);
        let (Some((from_s, from)), Some((to_s, to))) = (kept.get(after.wrapping_sub(1)), kept.get(after)) else {
            let nearest = if after == 0 { kept.front() } else { kept.back() };
            return nearest.map(|(_, pose)| *pose);
        };
        let share = (t_s - from_s) / (to_s - from_s);
        Some(Pose { tip_m: from.tip_m.lerp(&to.tip_m, share), measured_n: from.measured_n.lerp(&to.measured_n, share) })
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
            let pose = Pose { tip_m: Vector3::new(t_s, 0.0, 0.0), measured_n: Vector3::zeros() };
            // The window's clock is 7 s ahead, and it has the ticks of up to 16 ms at once.
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
    fn a_loop_that_began_again_is_followed() {
        let mut poses = Poses::default();
        let pose = |x| Pose { tip_m: Vector3::new(x, 0.0, 0.0), measured_n: Vector3::zeros() };
        poses.take(Side::Right, 100.0, pose(1.0), 100.0);
        poses.take(Side::Right, 0.0, pose(2.0), 110.0);
        assert!((poses.at_s(Side::Right, 110.0).unwrap().tip_m.x - 2.0).abs() < 1e-12);
    }
}
