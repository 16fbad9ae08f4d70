//! Checks the stop: it is pressed, every arm stops without force, and it is released as usual.

use super::{
    CheckSubject, FigureUnit, PersonRequest, ReadyCause, ReadyFigure,
    arms::Arms,
    item::{Item, PointProgress},
};
use crate::messages::{LoopState, Tick};

/// All arms stop within this time after the first one, s on the loop's clock.
/// Both arms stop in the same tick; a longer difference means that one of them did not receive the stop.
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
    pub(super) fn of(subject: &CheckSubject) -> Self {
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
            self.force_n = self.force_n.max(tick.rendering.rendered_n.norm());
        }
        if self.arms.all(is_stopped) {
            self.last_s.get_or_insert(tick.t_s);
        }
    }

    fn look(&mut self, _now_s: f64) -> PointProgress {
        if self.force_n > 0.0 {
            return PointProgress::Failed(ReadyCause::Force { force_n: self.force_n });
        }
        let Some((first_s, now_s)) = self.first_s.zip(self.arms.now_s()) else {
            return PointProgress::Asking(PersonRequest::PressStop);
        };
        let Some(last_s) = self.last_s else {
            let runs = self.arms.find(|state| !is_stopped(state)).filter(|_| now_s - first_s > TOGETHER_S);
            return runs.map_or(PointProgress::Asking(PersonRequest::PressStop), |tick| {
                PointProgress::Failed(ReadyCause::HalfStop(tick.side))
            });
        };
        if !self.arms.all(|state| state == LoopState::Idle) {
            return PointProgress::Asking(PersonRequest::Release);
        }
        PointProgress::Passed(ReadyFigure { value: last_s - first_s, limit: TOGETHER_S, unit: FigureUnit::Second })
    }

    fn late(&self) -> ReadyCause {
        if self.last_s.is_some() { ReadyCause::NotReleased(None) } else { ReadyCause::NoStop }
    }

    fn expects_latch(&self) -> bool {
        true
    }
}
