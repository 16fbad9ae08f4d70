//! Checks that the active force ceiling equals the one in the current rig file.

use nima_core::safety::{Ceiling as Limits, ChainSettings};

use super::{
    Ask, Cause, Figure, Subject, Unit,
    arms::Arms,
    item::{Item, Progress},
};
use crate::messages::Tick;

#[derive(Debug)]
pub(super) struct Ceiling {
    in_file: Option<ChainSettings>,
    arms: Arms,
}

impl Ceiling {
    pub(super) fn of(subject: &Subject) -> Self {
        Self { in_file: subject.gates_in_file, arms: Arms::of(subject) }
    }
}

fn most_n(gates: &ChainSettings) -> f64 {
    Limits::new(gates.ceiling_n, gates.device_limit_n).most_n()
}

impl Item for Ceiling {
    fn tick(&mut self, tick: &Tick) {
        self.arms.tick(tick);
    }

    fn look(&mut self, _now_s: f64) -> Progress {
        let Some(in_file_n) = self.in_file.as_ref().map(most_n) else { return Progress::Failed(Cause::NoRigFile) };
        let Some(ticks) = self.arms.ticks() else { return Progress::Asking(Ask::Nothing) };
        let differs = |in_force_n: &f64| (in_force_n - in_file_n).abs().max(0.0) > 1e-9 || in_force_n.is_nan();
        match ticks.iter().map(|tick| most_n(&tick.gate_settings)).find(differs) {
            Some(in_force_n) => Progress::Failed(Cause::OtherCeiling { in_force_n, in_file_n }),
            None => Progress::Passed(Figure { value: in_file_n, limit: in_file_n, unit: Unit::Newton }),
        }
    }

    fn late(&self) -> Cause {
        Cause::NoTicks
    }

    fn patience_s(&self) -> f64 {
        3.0
    }
}
