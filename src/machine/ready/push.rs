//! Checks one push in a known direction: the force must be measured in that direction, in the workspace.

use nalgebra::Vector3;

use super::{
    FigureUnit, PersonRequest, ReadyArm, ReadyCause, ReadyFigure, angle_deg,
    item::{Item, PointProgress},
};
use crate::{
    messages::{ForceSource, Tick},
    rig::{Side, SideSwap},
};

/// A push begins at this force, N, and is evaluated by its mean over this time, s: ten times the noise of a noisy
/// sensor, so that a touch in passing does not count.
const FELT_N: f64 = 1.0;
const FELT_S: f64 = 0.2;
/// Maximum angle between the push and the measured force, degrees: allows for a person's hand, and is far from any
/// other axis.
const ASKEW_MAX_DEG: f64 = 30.0;

/// Returns the direction to the right: it distinguishes a turn about the vertical from a turn about the axis away from
/// the person, which gravity cannot.
fn asked() -> nalgebra::UnitVector3<f64> {
    Vector3::x_axis()
}

#[derive(Debug)]
pub(super) struct ReadyPush {
    side: Side,
    /// A calibration exists, or none is needed.
    is_calibrated: bool,
    /// Reason why the force is currently unknown, for example while the sensor is being opened.
    source: Option<ForceSource>,
    max_n: f64,
    /// Time since which the push is measured, s on the loop's clock; sum of the forces, N.
    felt: Option<(f64, Vector3<f64>)>,
    by_deg: Option<f64>,
    /// Force of the other sensor when the push was requested, N, and the time since which it has changed.
    other_n: Option<Vector3<f64>>,
    other_felt_s: Option<f64>,
    other_felt: bool,
}

impl ReadyPush {
    pub(super) const fn of(side: Side, arm: &ReadyArm) -> Self {
        let is_calibrated = !arm.at_wrist || arm.gravity.is_some();
        Self {
            side,
            is_calibrated,
            source: Some(ForceSource::NoSample),
            max_n: 0.0,
            felt: None,
            by_deg: None,
            other_n: None,
            other_felt_s: None,
            other_felt: false,
        }
    }
}

/// Returns the force of the surroundings on the tip, N (`world`), without the network, which is valid only in the
/// trocar.
fn force_n(tick: &Tick) -> Option<Vector3<f64>> {
    match (&tick.force.gravity_free, tick.calibration.wrist.as_ref().and_then(|sample| sample.world_from_s1)) {
        (Some(wrench), Some(world_from_s1)) => Some(world_from_s1 * wrench.force_n),
        _ => tick.known_n(),
    }
}

impl ReadyPush {
    /// Monitors the other sensor: its instrument is at rest, so a changed force is a force on that instrument.
    fn other(&mut self, tick: &Tick) {
        let Some(force_n) = tick.calibration.wrist.as_ref().map(|sample| sample.raw.force_n).or_else(|| tick.known_n())
        else {
            self.other_felt_s = None;
            return;
        };
        let change_n = (force_n - *self.other_n.get_or_insert(force_n)).norm();
        if change_n < FELT_N || self.felt.is_some() {
            self.other_felt_s = None;
            return;
        }
        self.other_felt |= tick.t_s - *self.other_felt_s.get_or_insert(tick.t_s) >= FELT_S;
    }
}

impl Item for ReadyPush {
    fn tick(&mut self, tick: &Tick) {
        if self.by_deg.is_some() {
            return;
        }
        if tick.side != self.side {
            self.other(tick);
            return;
        }
        let force_n = force_n(tick);
        self.source = force_n.is_none().then_some(tick.force.source);
        let Some(force_n) = force_n.filter(|force_n| force_n.norm() >= FELT_N) else {
            self.max_n = force_n.map_or(self.max_n, |force_n| self.max_n.max(force_n.norm()));
            self.felt = None;
            return;
        };
        let (since_s, sum_n) = self.felt.get_or_insert((tick.t_s, Vector3::zeros()));
        *sum_n += force_n;
        if tick.t_s - *since_s >= FELT_S {
            // The object that is pushed exerts the opposite force.
            self.by_deg = Some(angle_deg(sum_n, &-asked().into_inner()));
        }
    }

    fn look(&mut self, _now_s: f64) -> PointProgress {
        match self.by_deg {
            Some(value) if value <= ASKEW_MAX_DEG => {
                PointProgress::Passed(ReadyFigure { value, limit: ASKEW_MAX_DEG, unit: FigureUnit::Degree })
            }
            Some(by_deg) => PointProgress::Failed(ReadyCause::PushAskew { by_deg }),
            None if self.other_felt => PointProgress::Failed(ReadyCause::Exchanged(SideSwap::Sensors)),
            None if !self.is_calibrated => PointProgress::Failed(ReadyCause::Uncalibrated),
            None => PointProgress::Asking(PersonRequest::Push(self.side, asked())),
        }
    }

    fn late(&self) -> ReadyCause {
        match self.source {
            Some(source) => ReadyCause::ForceUnknown(source),
            None => ReadyCause::NoPush { max_n: self.max_n },
        }
    }
}
