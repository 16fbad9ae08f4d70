//! A hand that repeatedly releases the handle, to show the purpose of the governor.

use nalgebra::Vector3;
use nima_core::safety::TransitionCause;
use nima_machine::{
    messages::{Command, LoopState},
    rig::Side,
};
use nima_screen::{live::LiveState, outbox::Outbox, scene3d::release_trail::ReleaseTrail};

/// The hand releases the handle when it presses with at least this force, N, and grips it again after this time, s.
const LET_GO_N: f64 = 1.5;
const OPEN_S: f64 = 2.5;
/// Time until the next release, s.
const CLOSED_S: f64 = 2.5;
/// Maximum time until the engagement after that, s; it fails after [`nima_core::safety::READY_WITHIN_S`].
const RETURNS_S: f64 = 2.5;

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
            let presses = tick.state == LoopState::Engaged && tick.rendering.rendered_n.z > LET_GO_N;
            if presses && for_s > CLOSED_S {
                *self = Self {
                    from_m: Some(tick.positions.leader_m),
                    since_s: Some(tick.t_s),
                    travel_m: Some(0.0),
                    ..Self::default()
                };
                self.trail.add(tick.positions.leader_m);
                outbox.push(Command::LetGo(true));
            }
            return;
        };
        if tick.state == LoopState::Engaged {
            // After the engagement has ended, the hand's position is on another scale.
            self.travel_m = self.travel_m.map(|max_m| max_m.max((tick.positions.leader_m - from_m).norm()));
            self.trail.add(tick.positions.leader_m);
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
