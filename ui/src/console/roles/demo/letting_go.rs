//! A hand that repeatedly releases the handle, to show the purpose of the governor.

use nalgebra::Vector3;
use nima_core::safety::TransitionCause;
use nima_machine::{
    messages::{Command, LoopState},
    rig::Side,
};

use crate::console::{live::LiveState, outbox::Outbox};

/// The hand releases the handle when it presses with at least this force, N, and grips it again after this time, s.
const LET_GO_N: f64 = 1.5;
const OPEN_S: f64 = 2.5;
/// Time until the next release, s.
const CLOSED_S: f64 = 2.5;
/// Maximum time until the engagement after that, s; it fails after [`nima_core::safety::READY_WITHIN_S`].
const RETURNS_S: f64 = 2.5;

/// Distance between two points of a trail, m, and their largest number.
const TRAIL_STEP_M: f64 = 0.5e-3;
const TRAIL_POINTS: usize = 128;

/// The way of a released handle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::console) struct ReleaseTrail {
    points_m: [Vector3<f64>; TRAIL_POINTS],
    count: usize,
}

impl Default for ReleaseTrail {
    fn default() -> Self {
        Self { points_m: [Vector3::zeros(); TRAIL_POINTS], count: 0 }
    }
}

impl ReleaseTrail {
    /// Returns the points of the trail, m, from the release on.
    pub(in crate::console) fn points_m(&self) -> &[Vector3<f64>] {
        &self.points_m[..self.count]
    }

    /// Returns the largest distance from the place of the release, m.
    pub(in crate::console) fn travel_m(&self) -> f64 {
        let points_m = self.points_m();
        points_m.iter().map(|point_m| (point_m - points_m[0]).norm()).fold(0.0, f64::max)
    }

    fn add(&mut self, point_m: Vector3<f64>) {
        let is_apart = |last_m: &Vector3<f64>| (last_m - point_m).norm() >= TRAIL_STEP_M;
        if self.points_m().last().is_none_or(is_apart)
            && let Some(place) = self.points_m.get_mut(self.count)
        {
            *place = point_m;
            self.count += 1;
        }
    }
}

/// The hand, and the travel of its handle.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LettingGo {
    /// Position of the handle when the hand opened, m; `None` while it is closed.
    from_m: Option<Vector3<f64>>,
    /// Time at which the hand opened or closed, s on the loop's clock.
    since_s: Option<f64>,
    /// The governor detected no hand on the handle and ended the engagement.
    gone: bool,
    /// Time at which the hand was back and an engagement was requested, s.
    returned_s: Option<f64>,
    /// Travel of the handle after the last release, m.
    pub(super) travel_m: Option<f64>,
    /// Its way.
    pub(super) trail: ReleaseTrail,
}

impl LettingGo {
    pub(super) const fn is_open(&self) -> bool {
        self.from_m.is_some()
    }

    /// Returns whether an idle loop is part of the show.
    pub(super) fn explains_idle(&self, now_s: f64) -> bool {
        self.is_open() || self.returned_s.is_some_and(|at_s| now_s - at_s < RETURNS_S)
    }

    /// Opens the hand when it presses, closes it a while later, and engages again if the governor ended the engagement.
    pub(super) fn play(&mut self, live: &LiveState, outbox: &mut Outbox) {
        let Some(tick) = live.first_tick() else { return };
        let for_s = tick.t_s - *self.since_s.get_or_insert(tick.t_s);
        let Some(from_m) = self.from_m else {
            let presses = tick.state == LoopState::Engaged && tick.rendered_n.z > LET_GO_N;
            if presses && for_s > CLOSED_S {
                *self = Self {
                    from_m: Some(tick.leader_m),
                    since_s: Some(tick.t_s),
                    travel_m: Some(0.0),
                    ..Self::default()
                };
                self.trail.add(tick.leader_m);
                outbox.push(Command::LetGo(true));
            }
            return;
        };
        if tick.state == LoopState::Engaged {
            // After the engagement has ended, the hand's position is on another scale.
            self.travel_m = self.travel_m.map(|max_m| max_m.max((tick.leader_m - from_m).norm()));
            self.trail.add(tick.leader_m);
        }
        // If the engagement ended for another reason, do not restart it.
        let ended = live.changes[Side::Right.index()].is_some_and(|change| change.why == TransitionCause::Absent);
        self.gone |= tick.state == LoopState::Idle && ended;
        if for_s > OPEN_S {
            self.close(tick.t_s, outbox);
        }
    }

    /// Closes the hand, at this time of the loop's clock, s.
    pub(super) fn close(&mut self, now_s: f64, outbox: &mut Outbox) {
        if self.from_m.is_some() {
            outbox.push(Command::LetGo(false));
            if self.gone {
                outbox.push(Command::Engage);
                self.returned_s = Some(now_s);
            }
        }
        *self = Self { travel_m: self.travel_m, trail: self.trail, returned_s: self.returned_s, ..Self::default() };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_trail_keeps_the_way_of_a_release_and_its_length() {
        let mut trail = ReleaseTrail::default();
        assert!(trail.points_m().is_empty() && trail.travel_m() == 0.0);
        for step in 0..=300 {
            trail.add(Vector3::new(0.0, 0.0, f64::from(step) * 1e-4));
        }
        assert!((trail.travel_m() - 0.030).abs() < 1e-3, "{}", trail.travel_m());
        assert!((50..=TRAIL_POINTS).contains(&trail.points_m().len()), "{}", trail.points_m().len());
        (0..1000).for_each(|step| trail.add(Vector3::x() * f64::from(step)));
        assert_eq!(trail.points_m().len(), TRAIL_POINTS, "never more than its room");
    }
}
