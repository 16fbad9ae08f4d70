//! Checks the stop: it is pressed, every arm stops without force, and it is released as usual.

use super::{
    Ask, Cause, Figure, Subject, Unit,
    arms::Arms,
    item::{Item, Progress},
};
use crate::messages::{LoopState, Tick};

/// All arms stop within this time after the first one, s on the loop's clock.
const TOGETHER_S: f64 = 0.1;

#[derive(Debug)]
pub(super) struct Stop {
    arms: Arms,
    /// Times at which the first and the last arm had stopped, s on the loop's clock.
    first_s: Option<f64>,
    last_s: Option<f64>,
    force_n: f64,
}

impl Stop {
    pub(super) fn of(subject: &Subject) -> Self {
        Self { arms: Arms::of(subject), first_s: None, last_s: None, force_n: 0.0 }
    }
}

const fn is_stopped(state: LoopState) -> bool {
    matches!(state, LoopState::Stopped)
}

impl Item for Stop {
    fn tick(&mut self, tick: &Tick) {
        self.arms.tick(tick);
        if is_stopped(tick.state) {
            self.first_s.get_or_insert(tick.t_s);
            self.force_n = self.force_n.max(tick.rendered_n.norm());
        }
        if self.arms.all(is_stopped) {
            self.last_s.get_or_insert(tick.t_s);
        }
    }

    fn look(&mut self, _now_s: f64) -> Progress {
        if self.force_n > 0.0 {
            return Progress::Failed(Cause::Force { force_n: self.force_n });
        }
        let Some((first_s, now_s)) = self.first_s.zip(self.arms.now_s()) else {
            return Progress::Asking(Ask::PressStop);
        };
        let Some(last_s) = self.last_s else {
            let runs = self.arms.find(|state| !is_stopped(state)).filter(|_| now_s - first_s > TOGETHER_S);
            return runs.map_or(Progress::Asking(Ask::PressStop), |tick| Progress::Failed(Cause::HalfStop(tick.side)));
        };
        if !self.arms.all(|state| state == LoopState::Idle) {
            return Progress::Asking(Ask::Release);
        }
        Progress::Passed(Figure { value: last_s - first_s, limit: TOGETHER_S, unit: Unit::Second })
    }

    fn late(&self) -> Cause {
        if self.last_s.is_some() { Cause::NotReleased(None) } else { Cause::NoStop }
    }

    fn expects_latch(&self) -> bool {
        true
    }
}
