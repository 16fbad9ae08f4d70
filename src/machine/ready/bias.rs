//! Checks that the wrist sensor's bias is unchanged since its calibration, by the force that remains at rest outside
//! the trocar.

use nima_core::calibration::gravity::{Drift, DriftCheck, NotChecked, StillSettings};

use super::{
    Arm, Ask, Cause, Figure, Unit,
    item::{Item, Progress},
};
use crate::{
    messages::{LoopState, Tick},
    rig::Side,
};

#[derive(Debug)]
pub(super) struct Bias {
    side: Side,
    check: Option<(DriftCheck, f64)>,
    /// Unknown as long as it is `None`.
    is_in_trocar: Option<bool>,
}

impl Bias {
    pub(super) fn of(side: Side, arm: &Arm) -> Self {
        let check = |(model, limit_n)| (DriftCheck::new(model, limit_n, StillSettings::default()), limit_n);
        Self { side, check: arm.gravity.map(check), is_in_trocar: None }
    }
}

impl Item for Bias {
    fn tick(&mut self, tick: &Tick) {
        // The brief loss of a device does not engage an arm; the session ends the check when an arm is engaged.
        if tick.side != self.side || tick.state != LoopState::Idle {
            return;
        }
        let Some((check, _)) = &mut self.check else { return };
        let is_in_trocar = tick.wrist.as_ref().is_some_and(|sample| sample.insertion_m.is_some_and(|m| m > 0.0));
        self.is_in_trocar = Some(is_in_trocar);
        check.step(tick.wrist.as_ref(), true, tick.t_s);
    }

    fn look(&mut self, _now_s: f64) -> Progress {
        let Some((check, limit_n)) = &self.check else { return Progress::Failed(Cause::Uncalibrated) };
        match check.drift() {
            Drift::Fine { by_n } => Progress::Passed(Figure { value: by_n, limit: *limit_n, unit: Unit::Newton }),
            Drift::Moved { by_n } => Progress::Failed(Cause::BiasMoved { by_n, limit_n: *limit_n }),
            _ => Progress::Asking(match self.is_in_trocar {
                None => Ask::Nothing,
                Some(true) => Ask::TakeOut(self.side),
                Some(false) => Ask::LeaveAlone(self.side),
            }),
        }
    }

    fn late(&self) -> Cause {
        match self.check.as_ref().map(|(check, _)| check.drift()) {
            _ if self.is_in_trocar == Some(true) => Cause::BiasUnseen(NotChecked::InTrocar),
            Some(Drift::NotChecked(why)) => Cause::BiasUnseen(why),
            _ => Cause::BiasUnseen(NotChecked::NoSample),
        }
    }
}
