//! Checks that when the instrument of one side is moved by hand, its own arm and its own marker move, and those of the
//! other side rest.

use nalgebra::{Isometry3, Vector3};

use super::{
    CheckSubject, FigureUnit, PersonRequest, ReadyCause, ReadyFigure,
    item::{Item, PointProgress},
};
use crate::{
    messages::Tick,
    rig::{SIDES, Side, SideSwap},
};

/// The instrument was moved when its flange is this far from its earlier position, m; a marker on it moves by at least
/// half of that.
/// Far more than an arm that is brushed in passing.
const MOVED_M: f64 = 0.05;
/// A resting part moves by less than this, m.
/// A fifth of [`MOVED_M`], so that rest and motion cannot be confused.
const RESTS_M: f64 = 0.010;

#[derive(Clone, Copy, Debug, Default)]
struct PointTravel {
    from_m: Option<Vector3<f64>>,
    max_m: f64,
}

impl PointTravel {
    fn add(&mut self, pose: Option<&Isometry3<f64>>) {
        let Some(position_m) = pose.map(|pose| pose.translation.vector) else { return };
        let from_m = *self.from_m.get_or_insert(position_m);
        self.max_m = self.max_m.max((position_m - from_m).norm());
    }

    fn rests(&self) -> bool {
        self.from_m.is_some() && self.max_m <= RESTS_M
    }
}

#[derive(Debug)]
pub(super) struct Own {
    side: Side,
    has_markers: bool,
    flanges: [PointTravel; SIDES],
    markers: [PointTravel; SIDES],
}

impl Own {
    pub(super) fn of(side: Side, subject: &CheckSubject) -> Self {
        let tracker = subject.rig.devices.as_ref().and_then(|devices| devices.tracker.as_ref());
        let has_markers = tracker.is_some_and(|tracker| tracker.tools.len() >= SIDES);
        Self { side, has_markers, flanges: Default::default(), markers: Default::default() }
    }

    fn ways(ways: &[PointTravel; SIDES], side: Side) -> [PointTravel; SIDES] {
        [ways[side.index()], ways[side.other().index()]]
    }
}

impl Item for Own {
    fn tick(&mut self, tick: &Tick) {
        self.flanges[tick.side.index()].add(tick.calibration.frames.base_from_flange.as_ref());
        self.markers[tick.side.index()].add(tick.calibration.frames.c_from_m.as_ref());
    }

    fn look(&mut self, _now_s: f64) -> PointProgress {
        let [arm, other_arm] = Self::ways(&self.flanges, self.side);
        let [marker, other_marker] = Self::ways(&self.markers, self.side);
        if other_arm.max_m >= MOVED_M && arm.rests() {
            return PointProgress::Failed(ReadyCause::Exchanged(SideSwap::Arms));
        }
        let moved = arm.max_m >= MOVED_M && other_arm.rests();
        if moved && self.has_markers && marker.rests() && other_marker.max_m >= MOVED_M / 2.0 {
            return PointProgress::Failed(ReadyCause::Exchanged(SideSwap::Markers));
        }
        let followed = !self.has_markers || marker.max_m >= MOVED_M / 2.0 && other_marker.rests();
        if !(moved && followed) {
            return PointProgress::Asking(PersonRequest::Move(self.side));
        }
        let rested_m = if self.has_markers { other_arm.max_m.max(other_marker.max_m) } else { other_arm.max_m };
        PointProgress::Passed(ReadyFigure { value: 1e3 * rested_m, limit: 1e3 * RESTS_M, unit: FigureUnit::Millimetre })
    }

    fn late(&self) -> ReadyCause {
        let [arm, other_arm] = Self::ways(&self.flanges, self.side);
        if arm.max_m < MOVED_M || !other_arm.rests() {
            return ReadyCause::ArmStuck { by_m: arm.max_m };
        }
        ReadyCause::MarkerStuck { by_m: self.markers[self.side.index()].max_m }
    }
}
