//! Checks that the handle is free: released, it rests; in idle it has no force; and its reading follows the hand.

use nalgebra::{UnitQuaternion, Vector3};
use nima_core::calibration::frames::ViewMove;

use super::{
    CheckSubject, FigureUnit, PersonRequest, ReadyCause, ReadyFigure, angle_deg,
    item::{Item, PointProgress},
};
use crate::{
    messages::Tick,
    rig::{Side, SideSwap},
};

/// A released handle rests within this distance, m, for this time, s.
const RESTS_M: f64 = 1e-3;
const RESTS_S: f64 = 0.6;
/// Travel after which its direction is evaluated, m: far more than a tremor (0.2 mm), so that the direction shows the
/// hand's motion.
const TRAVEL_M: f64 = 0.010;
/// Maximum angle between the requested and the measured direction, degrees: allows for a person's hand, and is nearer
/// to this axis than to any other.
const ASKEW_MAX_DEG: f64 = 40.0;
/// The requested direction.
/// One direction is enough: a swapped axis or sign turns it by at least 90 degrees.
const WAY: ViewMove = ViewMove::Right;

#[derive(Debug)]
pub(super) struct ReadyHandle {
    side: Side,
    view_from_leader: UnitQuaternion<f64>,
    /// Position at which it rests, m (leader), and the time since which it rests, s on the loop's clock.
    rest: Option<(Vector3<f64>, f64)>,
    /// Position from which it is to be moved after resting, m.
    from_m: Option<Vector3<f64>>,
    /// Farthest displacement, m, in the image frame.
    far_m: Vector3<f64>,
    /// Distance that the handle moved by itself, m.
    drifted_m: f64,
    force_n: f64,
    /// Position of the other handle at the time of the instruction to move this one, and its maximum distance from that
    /// position, m.
    other: Option<(Vector3<f64>, f64)>,
}

impl ReadyHandle {
    pub(super) fn of(side: Side, subject: &CheckSubject) -> Self {
        Self {
            side,
            view_from_leader: subject.rig.teleoperation.view_from_leader(),
            rest: None,
            from_m: None,
            far_m: Vector3::zeros(),
            drifted_m: 0.0,
            force_n: 0.0,
            other: None,
        }
    }
}

impl Item for ReadyHandle {
    fn tick(&mut self, tick: &Tick) {
        if tick.side != self.side {
            if let (Some(pose), Some(_)) = (tick.calibration.frames.leader_from_handle, self.from_m) {
                let position_m = pose.translation.vector;
                let (from_m, far_m) = self.other.get_or_insert((position_m, 0.0));
                *far_m = far_m.max((position_m - *from_m).norm());
            }
            return;
        }
        self.force_n = self.force_n.max(tick.rendering.rendered_n.norm());
        let Some(position_m) = tick.calibration.frames.leader_from_handle.map(|pose| pose.translation.vector) else {
            return;
        };
        if let Some(from_m) = self.from_m {
            let travel_m = self.view_from_leader * (position_m - from_m);
            if travel_m.norm() > self.far_m.norm() {
                self.far_m = travel_m;
            }
            return;
        }
        let (rest_m, since_s) = *self.rest.get_or_insert((position_m, tick.t_s));
        let by_m = (position_m - rest_m).norm();
        if by_m > RESTS_M {
            self.drifted_m = self.drifted_m.max(by_m);
            self.rest = Some((position_m, tick.t_s));
        } else if tick.t_s - since_s >= RESTS_S {
            self.from_m = Some(position_m);
        }
    }

    fn look(&mut self, _now_s: f64) -> PointProgress {
        // The check runs without permission for a force, so any force is a fault of the program.
        if self.force_n > 0.0 {
            return PointProgress::Failed(ReadyCause::HandleForce { force_n: self.force_n });
        }
        if self.from_m.is_none() {
            return PointProgress::Asking(PersonRequest::LetGo(self.side));
        }
        if self.far_m.norm() <= RESTS_M && self.other.is_some_and(|(_, far_m)| far_m >= TRAVEL_M) {
            return PointProgress::Failed(ReadyCause::Exchanged(SideSwap::Handles));
        }
        if self.far_m.norm() < TRAVEL_M {
            return PointProgress::Asking(PersonRequest::MoveHandle(self.side, WAY));
        }
        let by_deg = angle_deg(&self.far_m, &WAY.in_view());
        if by_deg > ASKEW_MAX_DEG {
            return PointProgress::Failed(ReadyCause::HandleAskew { by_deg });
        }
        PointProgress::Passed(ReadyFigure { value: by_deg, limit: ASKEW_MAX_DEG, unit: FigureUnit::Degree })
    }

    fn late(&self) -> ReadyCause {
        match self.from_m {
            None => ReadyCause::HandlePulls { by_m: self.drifted_m },
            Some(_) => ReadyCause::HandleStuck { by_m: self.far_m.norm() },
        }
    }
}
