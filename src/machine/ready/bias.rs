//! Checks that the wrist sensor's bias is unchanged since its calibration, by the force that remains at rest outside
//! the trocar.

use nima_core::calibration::gravity::{DriftCheck, GravityDrift, NotChecked, StillSettings};

use super::{
    FigureUnit, PersonRequest, ReadyArm, ReadyCause, ReadyFigure,
    item::{Item, PointProgress},
};
use crate::{
    messages::{LoopState, Tick},
    rig::Side,
};

#[derive(Debug)]
pub(super) struct Bias {
    side: Side,
    check: Option<(DriftCheck, f64)>,
    /// Whether the instrument is in the trocar; `None` while this is unknown.
    is_in_trocar: Option<bool>,
}

impl Bias {
    pub(super) fn of(side: Side, arm: &ReadyArm) -> Self {
        let check = |(model, limit_n)| (DriftCheck::new(model, limit_n, StillSettings::default()), limit_n);
        Self { side, check: arm.gravity.map(check), is_in_trocar: None }
    }
}

impl Item for Bias {
    fn tick(&mut self, tick: &Tick) {
        // An arm cannot become engaged through the brief loss of a device; when an arm is engaged, the session ends the
        // check.
        if tick.side != self.side || tick.state != LoopState::Idle {
            return;
        }
        let Some((check, _)) = &mut self.check else { return };
        let is_in_trocar =
            tick.calibration.wrist.as_ref().is_some_and(|sample| sample.insertion_m.is_some_and(|m| m > 0.0));
        self.is_in_trocar = Some(is_in_trocar);
        check.step(tick.calibration.wrist.as_ref(), true, tick.t_s);
    }

    fn look(&mut self, _now_s: f64) -> PointProgress {
        let Some((check, limit_n)) = &self.check else { return PointProgress::Failed(ReadyCause::Uncalibrated) };
        match check.drift() {
            GravityDrift::Fine { by_n } => {
                PointProgress::Passed(ReadyFigure { value: by_n, limit: *limit_n, unit: FigureUnit::Newton })
            }
            GravityDrift::Moved { by_n } => PointProgress::Failed(ReadyCause::BiasMoved { by_n, limit_n: *limit_n }),
            _ => PointProgress::Asking(match self.is_in_trocar {
                None => PersonRequest::Nothing,
                Some(true) => PersonRequest::TakeOut(self.side),
                Some(false) => PersonRequest::LeaveAlone(self.side),
            }),
        }
    }

    fn late(&self) -> ReadyCause {
        match self.check.as_ref().map(|(check, _)| check.drift()) {
            _ if self.is_in_trocar == Some(true) => ReadyCause::BiasUnseen(NotChecked::InTrocar),
            Some(GravityDrift::NotChecked(why)) => ReadyCause::BiasUnseen(why),
            _ => ReadyCause::BiasUnseen(NotChecked::NoSample),
        }
    }
}
