//! A hand that lets go again and again, to show what the governor is for.

use nalgebra::Vector3;
use nima_core::safety::Why;
use nima_machine::{
    messages::{Command, LoopState},
    rig::Side,
};

use crate::console::{live::Live, outbox::Outbox};

/// The hand lets go when it presses at least so hard, N, and takes the handle again after this time, s.
const LET_GO_N: f64 = 1.5;
const OPEN_S: f64 = 2.5;
/// Then it works on for this time, s, before it lets go once more.
const CLOSED_S: f64 = 2.5;
/// The engagement after that takes at most this time, s; it fails after [`nima_core::safety::READY_WITHIN_S`].
const RETURNS_S: f64 = 2.5;

/// The hand, and how far its handle went.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LettingGo {
    /// Where the handle was when the hand opened, m; `None` while it is closed.
    from_m: Option<Vector3<f64>>,
    /// When it opened or closed, s on the loop's clock.
    since_s: Option<f64>,
    /// The governor found nobody at the handle and ended the engagement.
    gone: bool,
    /// When the hand was back and an engagement was asked for, s.
    returned_s: Option<f64>,
    /// How far the handle went the last time, m.
    pub(super) travel_m: Option<f64>,
}

impl LettingGo {
    /// Whether the hand is open.
    pub(super) const fn is_open(&self) -> bool {
        self.from_m.is_some()
    }

    /// Whether an idle loop is part of the show.
    pub(super) fn explains_idle(&self, now_s: f64) -> bool {
        self.is_open() || self.returned_s.is_some_and(|at_s| now_s - at_s < RETURNS_S)
    }

    /// Opens the hand when it presses, closes it a while later, and engages again if the governor had to end that.
    pub(super) fn play(&mut self, live: &Live, outbox: &mut Outbox) {
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
                outbox.push(Command::LetGo(true));
            }
            return;
        };
        if tick.state == LoopState::Engaged {
            // Behind the end of the engagement the hand's place is not on the same scale.
            self.travel_m = self.travel_m.map(|most_m| most_m.max((tick.leader_m - from_m).norm()));
        }
        // Who ended the engagement otherwise, wants it ended.
        let ended = live.changes[Side::Right.index()].is_some_and(|change| change.why == Why::Absent);
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
        *self = Self { travel_m: self.travel_m, returned_s: self.returned_s, ..Self::default() };
    }
}
