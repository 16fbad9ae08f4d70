//! Checks that the handle is free: released, it rests; in idle it has no force; and its reading follows the hand.

use nalgebra::{UnitQuaternion, Vector3};
use nima_core::calibration::frames::Move;

use super::{
    Ask, Cause, Figure, Subject, Unit, angle_deg,
    item::{Item, Progress},
};
use crate::{
    messages::Tick,
    rig::{Exchange, Side},
};

/// A released handle rests within this distance, m, for this time, s.
const RESTS_M: f64 = 1e-3;
const RESTS_S: f64 = 0.6;
/// Travel after which its direction is evaluated, m: far more than a tremor (0.2 mm), so that the direction shows the
/// hand's motion.
const WAY_M: f64 = 0.010;
/// Maximum angle between the requested and the measured direction, degrees: allows for a person's hand, and is nearer
/// to this axis than to any other.
const ASKEW_MAX_DEG: f64 = 40.0;
/// The requested direction.
const WAY: Move = Move::Right;

#[derive(Debug)]
pub(super) struct Handle {
    side: Side,
    view_from_leader: UnitQuaternion<f64>,
    /// Position at which it rests, m (leader), and the time since which it rests, s on the loop's clock.
    rest: Option<(Vector3<f64>, f64)>,
    /// Position from which it is to be moved after resting, m.
    from_m: Option<Vector3<f64>>,
    /// Farthest displacement, m, in the image frame.
    far_m: Vector3<f64>,
    /// Distance that it moved by itself, m.
    drifted_m: f64,
    force_n: f64,
    /// Position of the other handle when this one was to be moved, and its farthest distance from it, m.
    other: Option<(Vector3<f64>, f64)>,
}

impl Handle {
    pub(super) fn of(side: Side, subject: &Subject) -> Self {
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

impl Item for Handle {
    fn tick(&mut self, tick: &Tick) {
        if tick.side != self.side {
            if let (Some(pose), Some(_)) = (tick.frames.leader_from_handle, self.from_m) {
                let at_m = pose.translation.vector;
                let (from_m, far_m) = self.other.get_or_insert((at_m, 0.0));
                *far_m = far_m.max((at_m - *from_m).norm());
            }
            return;
        }
        self.force_n = self.force_n.max(tick.rendered_n.norm());
        let Some(at_m) = tick.frames.leader_from_handle.map(|pose| pose.translation.vector) else { return };
        if let Some(from_m) = self.from_m {
            let way_m = self.view_from_leader * (at_m - from_m);
            if way_m.norm() > self.far_m.norm() {
                self.far_m = way_m;
            }
            return;
        }
        let (rest_m, since_s) = *self.rest.get_or_insert((at_m, tick.t_s));
        let by_m = (at_m - rest_m).norm();
        if by_m > RESTS_M {
            self.drifted_m = self.drifted_m.max(by_m);
            self.rest = Some((at_m, tick.t_s));
        } else if tick.t_s - since_s >= RESTS_S {
            self.from_m = Some(at_m);
        }
    }

    fn look(&mut self, _now_s: f64) -> Progress {
        if self.force_n > 0.0 {
            return Progress::Failed(Cause::HandleForce { force_n: self.force_n });
        }
        if self.from_m.is_none() {
            return Progress::Asking(Ask::LetGo(self.side));
        }
        if self.far_m.norm() <= RESTS_M && self.other.is_some_and(|(_, far_m)| far_m >= WAY_M) {
            return Progress::Failed(Cause::Exchanged(Exchange::Handles));
        }
        if self.far_m.norm() < WAY_M {
            return Progress::Asking(Ask::MoveHandle(self.side, WAY));
        }
        let by_deg = angle_deg(&self.far_m, &WAY.in_view());
        if by_deg > ASKEW_MAX_DEG {
            return Progress::Failed(Cause::HandleAskew { by_deg });
        }
        Progress::Passed(Figure { value: by_deg, limit: ASKEW_MAX_DEG, unit: Unit::Degree })
    }

    fn late(&self) -> Cause {
        match self.from_m {
            None => Cause::HandlePulls { by_m: self.drifted_m },
            Some(_) => Cause::HandleStuck { by_m: self.far_m.norm() },
        }
    }
}
