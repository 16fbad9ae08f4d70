//! One ring, followed from event to event.

use nima_core::{SIDES, Side, task::TaskEvent};

use crate::physics::objects::{RingActivity, RingState};

/// A ring counts as grasped when it has been held for this long, s.
const GRASPED_AFTER_S: f64 = 0.03;
/// A ring counts as released when it has not been held for this long, s; a shorter time is a slip. A ring falls 11 mm
/// in this time.
const LET_GO_AFTER_S: f64 = 0.05;
/// A ring has left a peg, or is on one, after this time, s.
const OFF_PEG_AFTER_S: f64 = 0.05;
const ON_PEG_AFTER_S: f64 = 0.1;
/// A ring that is not held counts as knocked off its peg after this time, s.
const KNOCKED_AFTER_S: f64 = 0.1;
/// A released ring has landed after this time at rest, or after this time in total, s; until then it may still roll out
/// of view.
const LIES_AFTER_S: f64 = 0.15;
const LIES_AT_LAST_S: f64 = 2.0;

/// Tracked state of a ring.
#[derive(Clone, Copy, Debug, PartialEq)]
enum FollowingStage {
    /// Not held; on this peg, or elsewhere.
    Free {
        peg: Option<usize>,
    },
    /// Held; `peg` is the peg on which it was grasped, until the ring has left it.
    Held {
        side: Side,
        peg: Option<usize>,
    },
    /// Released, with an undecided outcome. `landed` if it has been supported since.
    LetGo {
        side: Side,
        peg: Option<usize>,
        landed: bool,
        since_s: f64,
    },
    Lost,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct RingFollower {
    stage: FollowingStage,
    /// Time for which each side has held the ring, and has not held it, s.
    held_s: [f64; SIDES],
    loose_s: [f64; SIDES],
    /// Time for which the ring has been around the current peg, off the peg of its stage, and at rest, s.
    on_s: f64,
    on: Option<usize>,
    off_s: f64,
    rest_s: f64,
    last: Option<Side>,
}

fn for_s(time_s: f64, lasts: bool, period_s: f64) -> f64 {
    if lasts { time_s + period_s } else { 0.0 }
}

impl RingFollower {
    pub(super) fn new(state: &RingState) -> Self {
        Self {
            stage: FollowingStage::Free { peg: state.around },
            held_s: [0.0; SIDES],
            loose_s: [f64::INFINITY; SIDES],
            on_s: 0.0,
            on: state.around,
            off_s: 0.0,
            rest_s: 0.0,
            last: None,
        }
    }

    /// Processes the next step. `last` is the side that last touched any ring.
    pub(super) fn look(
        &mut self,
        ring: usize,
        state: &RingState,
        last: Option<Side>,
        period_s: f64,
        report: &mut dyn FnMut(TaskEvent),
    ) {
        self.measure(state, period_s);
        let lost = state.doing == RingActivity::OutOfView;
        let of = |side: Option<Side>| side.or(last).unwrap_or(Side::Right);
        self.stage = match self.stage {
            FollowingStage::Lost => FollowingStage::Lost,
            FollowingStage::Free { .. } if lost => {
                report(TaskEvent::RingDropped { ring, side: of(self.last), in_view: false });
                FollowingStage::Lost
            }
            FollowingStage::Held { side, .. } | FollowingStage::LetGo { side, .. } if lost => {
                report(TaskEvent::RingDropped { ring, side, in_view: false });
                FollowingStage::Lost
            }
            FollowingStage::Free { peg } => self.free(ring, peg, report),
            FollowingStage::Held { side, peg } => self.held(ring, state, side, peg, report),
            FollowingStage::LetGo { side, peg, landed, since_s } => {
                let landed = landed || (state.supported && !state.touched_by.contains(&true)) || state.around.is_some();
                self.let_go(ring, side, peg, (landed, since_s + period_s), report)
            }
        };
    }

    fn measure(&mut self, state: &RingState, period_s: f64) {
        let by = if let RingActivity::Held { by } = state.doing { by } else { [false; SIDES] };
        for side in Side::LEFT_TO_RIGHT {
            let i = side.index();
            self.loose_s[i] = for_s(self.loose_s[i], !by[i], period_s);
            self.held_s[i] = for_s(self.held_s[i], self.loose_s[i] < LET_GO_AFTER_S, period_s);
            if state.touched_by[i] {
                self.last = Some(side);
            }
        }
        self.on_s = for_s(self.on_s, state.around == self.on && self.on.is_some(), period_s);
        self.on = state.around;
        let peg = match self.stage {
            FollowingStage::Free { peg } | FollowingStage::Held { peg, .. } | FollowingStage::LetGo { peg, .. } => peg,
            FollowingStage::Lost => None,
        };
        self.off_s = for_s(self.off_s, peg.is_some() && state.around != peg, period_s);
        self.rest_s = for_s(self.rest_s, state.supported && state.slow && !by.contains(&true), period_s);
    }

    /// Returns the side that holds it firmly, other than `than`; the left one if both do.
    fn firm(&self, than: Option<Side>) -> Option<Side> {
        Side::LEFT_TO_RIGHT.into_iter().find(|side| Some(*side) != than && self.held_s[side.index()] >= GRASPED_AFTER_S)
    }

    fn free(&self, ring: usize, peg: Option<usize>, report: &mut dyn FnMut(TaskEvent)) -> FollowingStage {
        if let Some(side) = self.firm(None) {
            report(TaskEvent::RingGrasped { ring, side });
            return FollowingStage::Held { side, peg };
        }
        match peg {
            Some(_) if self.off_s >= KNOCKED_AFTER_S => {
                report(TaskEvent::RingKnockedOff { ring, side: self.last });
                FollowingStage::Free { peg: None }
            }
            // A ring that was pushed onto a peg, or fell onto it, counts as placed there.
            None if self.on_s >= ON_PEG_AFTER_S => FollowingStage::Free { peg: self.on },
            peg => FollowingStage::Free { peg },
        }
    }

    fn held(
        &self,
        ring: usize,
        state: &RingState,
        side: Side,
        peg: Option<usize>,
        report: &mut dyn FnMut(TaskEvent),
    ) -> FollowingStage {
        let peg = if self.off_s >= OFF_PEG_AFTER_S {
            report(TaskEvent::RingLifted { ring, side });
            None
        } else {
            peg
        };
        if self.loose_s[side.index()] < LET_GO_AFTER_S {
            return FollowingStage::Held { side, peg };
        }
        let Some(to) = self.firm(Some(side)) else {
            return FollowingStage::LetGo { side, peg, landed: false, since_s: 0.0 };
        };
        let in_air = !state.supported && state.around.is_none();
        let event =
            if in_air { TaskEvent::RingTransferred { ring, to } } else { TaskEvent::RingGrasped { ring, side: to } };
        report(event);
        FollowingStage::Held { side: to, peg }
    }

    fn let_go(
        &self,
        ring: usize,
        side: Side,
        peg: Option<usize>,
        (landed, since_s): (bool, f64),
        report: &mut dyn FnMut(TaskEvent),
    ) -> FollowingStage {
        if let Some(by) = self.firm(None) {
            match (landed, peg) {
                (false, _) if by == side => {}
                (false, _) => report(TaskEvent::RingTransferred { ring, to: by }),
                (true, Some(_)) => report(TaskEvent::RingGrasped { ring, side: by }),
                (true, None) => {
                    report(TaskEvent::RingDropped { ring, side, in_view: true });
                    report(TaskEvent::RingGrasped { ring, side: by });
                }
            }
            return FollowingStage::Held { side: by, peg };
        }
        if let (Some(on), true) = (self.on, self.on_s >= ON_PEG_AFTER_S) {
            // A ring that never left its peg was not placed.
            if peg != Some(on) {
                report(TaskEvent::RingPlaced { ring, side, peg: on });
            }
            return FollowingStage::Free { peg: Some(on) };
        }
        if self.rest_s >= LIES_AFTER_S || (landed && since_s >= LIES_AT_LAST_S) {
            report(TaskEvent::RingDropped { ring, side, in_view: true });
            return FollowingStage::Free { peg: None };
        }
        FollowingStage::LetGo { side, peg, landed, since_s }
    }
}
