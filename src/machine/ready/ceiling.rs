//! Checks that the active force ceiling equals the one in the current rig file.

use nima_core::safety::{Ceiling as Limits, ChainSettings};

use super::{
    CheckSubject, FigureUnit, PersonRequest, ReadyCause, ReadyFigure,
    arms::Arms,
    item::{Item, PointProgress},
};
use crate::messages::Tick;

#[derive(Debug)]
pub(super) struct ReadyCeiling {
    in_file: Option<ChainSettings>,
    arms: Arms,
}

impl ReadyCeiling {
    pub(super) fn of(subject: &CheckSubject) -> Self {
        Self { in_file: subject.gates_in_file, arms: Arms::of(subject) }
    }
}

fn max_n(gates: &ChainSettings) -> f64 {
    Limits::new(gates.ceiling_n, gates.device_limit_n).max_n()
}

impl Item for ReadyCeiling {
    fn tick(&mut self, tick: &Tick) {
        self.arms.tick(tick);
    }

    fn look(&mut self, _now_s: f64) -> PointProgress {
        let Some(in_file_n) = self.in_file.as_ref().map(max_n) else {
            return PointProgress::Failed(ReadyCause::NoRigFile);
        };
        let Some(ticks) = self.arms.ticks() else { return PointProgress::Asking(PersonRequest::Nothing) };
        let differs = |in_force_n: &f64| (in_force_n - in_file_n).abs().max(0.0) > 1e-9 || in_force_n.is_nan();
        match ticks.iter().map(|tick| max_n(&tick.gates.settings)).find(differs) {
            Some(in_force_n) => PointProgress::Failed(ReadyCause::OtherCeiling { in_force_n, in_file_n }),
            None => PointProgress::Passed(ReadyFigure { value: in_file_n, limit: in_file_n, unit: FigureUnit::Newton }),
        }
    }

    fn late(&self) -> ReadyCause {
        ReadyCause::NoTicks
    }

    fn patience_s(&self) -> f64 {
        3.0
    }
}
