//! Checks that the trocar is at its position in the rig file: the line of the shaft, from the arm's joints, passes
//! through it. A displacement along the shaft is not detected.

use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use nima_core::{
    calibration::frames::{ShaftLine, TrocarState, TrocarWatch},
    kinematics,
};

use super::{
    CheckSubject, FigureUnit, PersonRequest, ReadyCause, ReadyFigure,
    item::{Item, PointProgress},
};
use crate::{
    messages::Tick,
    rig::{EngageBlocker, Healths, Side, SideSwap},
};

/// The instrument is in its trocar if the shaft passes within this distance, m: the limit for an engagement too, so that
/// a pair that passes this check can start.
const NEAR_M: f64 = kinematics::START_MISS_M;
/// The arm rests when its tip moves by less than this, m, for this time, s.
const RESTS_M: f64 = 0.3e-3;
const RESTS_S: f64 = 1.2;

#[derive(Debug)]
pub(super) struct ReadyTrocar {
    side: Side,
    /// The shaft in the flange's frame, the base in the workspace, and the trocar in the workspace (m).
    arm: Option<(ShaftLine, Isometry3<f64>, Vector3<f64>)>,
    watch: Option<TrocarWatch>,
    /// Position at which the tip rests, m, and the time since which it rests, s on the loop's clock.
    rest: Option<(Vector3<f64>, f64)>,
    has_rested: bool,
    miss_m: f64,
    /// Swap of the sides, according to the rig's geometry.
    exchange: Option<SideSwap>,
}

impl ReadyTrocar {
    pub(super) fn of(side: Side, subject: &CheckSubject) -> Self {
        let arm = subject.rig.devices.as_ref().and_then(|devices| {
            let set = devices.arm(side)?;
            let arm = set.kinematics().ok()?;
            let base = arm.world_from_base();
            let turn = UnitQuaternion::from_rotation_matrix(&base.rotation);
            let world_from_base = Isometry3::from_parts(base.translation, turn);
            Some((ShaftLine::of_arm(&arm), world_from_base, set.rcm.trocar_m))
        });
        Self { side, arm, watch: None, rest: None, has_rested: false, miss_m: f64::INFINITY, exchange: None }
    }

    /// Records whether the tip rests.
    fn follow(&mut self, tick: &Tick) {
        let (rest_m, since_s) = *self.rest.get_or_insert((tick.positions.tip_m, tick.t_s));
        self.has_rested = tick.t_s - since_s >= RESTS_S;
        if (tick.positions.tip_m - rest_m).norm() > RESTS_M {
            self.rest = None;
            self.watch = None;
            self.has_rested = false;
        }
    }
}

impl Item for ReadyTrocar {
    fn tick(&mut self, tick: &Tick) {
        let Some((shaft, world_from_base, trocar_m)) = self.arm.filter(|_| tick.side == self.side) else { return };
        let Some(base_from_flange) = &tick.calibration.frames.base_from_flange else { return };
        self.follow(tick);
        let line = shaft.in_frame(&(world_from_base * base_from_flange));
        let is_through = (tick.positions.tip_m - trocar_m).dot(&line.direction) > 0.0;
        self.miss_m = if is_through { line.miss_m(&trocar_m).norm() } else { f64::INFINITY };
        let watch = self.watch.get_or_insert_with(|| TrocarWatch::new(trocar_m, TrocarWatch::LIMIT_M));
        watch.step(&line, tick.t_s);
    }

    fn healths(&mut self, healths: &Healths) {
        self.exchange = match healths.obstacles[self.side.index()] {
            Some(EngageBlocker::Exchanged(exchange)) => Some(exchange),
            _ => None,
        };
    }

    fn look(&mut self, _now_s: f64) -> PointProgress {
        if let Some(exchange) = self.exchange.filter(|_| self.has_rested) {
            return PointProgress::Failed(ReadyCause::Exchanged(exchange));
        }
        let Some(watch) = self.watch.as_ref().filter(|_| self.has_rested && self.miss_m <= NEAR_M) else {
            return PointProgress::Asking(PersonRequest::PutBack(self.side));
        };
        match watch.state() {
            TrocarState::Waiting => PointProgress::Asking(PersonRequest::PutBack(self.side)),
            TrocarState::Fine { by_m } => PointProgress::Passed(ReadyFigure {
                value: 1e3 * by_m,
                limit: 1e3 * TrocarWatch::LIMIT_M,
                unit: FigureUnit::Millimetre,
            }),
            TrocarState::Moved { by_m } => {
                PointProgress::Failed(ReadyCause::TrocarMoved { by_m: Vector3::from(by_m).norm() })
            }
        }
    }

    fn late(&self) -> ReadyCause {
        ReadyCause::BesideTrocar { miss_m: self.miss_m }
    }
}
