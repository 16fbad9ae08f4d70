//! The newest tick of each arm of a check.

use super::CheckSubject;
use crate::{
    messages::{LoopState, Tick},
    rig::{SIDES, Side},
};

#[derive(Clone, Debug)]
pub(super) struct Arms {
    sides: Vec<Side>,
    ticks: [Option<Tick>; SIDES],
}

impl Arms {
    pub(super) fn of(subject: &CheckSubject) -> Self {
        Self { sides: subject.sides().collect(), ticks: [None; SIDES] }
    }

    pub(super) const fn tick(&mut self, tick: &Tick) {
        self.ticks[tick.side.index()] = Some(*tick);
    }

    /// Returns the newest tick of every arm; `None` until each has sent one.
    pub(super) fn ticks(&self) -> Option<Vec<&Tick>> {
        self.sides.iter().map(|side| self.ticks[side.index()].as_ref()).collect()
    }

    /// Returns whether the state of every arm satisfies `is`.
    pub(super) fn all(&self, is: impl Fn(LoopState) -> bool) -> bool {
        self.ticks().is_some_and(|ticks| ticks.iter().all(|tick| is(tick.state)))
    }

    pub(super) fn find(&self, is: impl Fn(LoopState) -> bool) -> Option<&Tick> {
        self.ticks.iter().flatten().find(|tick| is(tick.state))
    }

    /// Returns the newest time on the loop's clock, s.
    pub(super) fn now_s(&self) -> Option<f64> {
        self.ticks.iter().flatten().map(|tick| tick.t_s).max_by(f64::total_cmp)
    }
}
