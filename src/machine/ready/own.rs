//! Checks that when the instrument of one side is moved by hand, its own arm and its own marker move, and those of the
//! other side rest.

use nalgebra::{Isometry3, Vector3};

use super::{
    Ask, Cause, Figure, Subject, Unit,
    item::{Item, Progress},
};
use crate::{
    messages::Tick,
    rig::{Exchange, SIDES, Side},
};

/// The instrument was moved when its flange is this far from its earlier position, m; a marker on it moves by at least
/// half of that.
const MOVED_M: f64 = 0.05;
/// A resting part moves by less than this, m.
const RESTS_M: f64 = 0.010;

#[derive(Clone, Copy, Debug, Default)]
struct Way {
    from_m: Option<Vector3<f64>>,
    most_m: f64,
}

impl Way {
    fn add(&mut self, pose: Option<&Isometry3<f64>>) {
        let Some(at_m) = pose.map(|pose| pose.translation.vector) else { return };
        let from_m = *self.from_m.get_or_insert(at_m);
        self.most_m = self.most_m.max((at_m - from_m).norm());
    }

    fn rests(&self) -> bool {
        self.from_m.is_some() && self.most_m <= RESTS_M
    }
}

#[derive(Debug)]
pub(super) struct Own {
    side: Side,
    has_markers: bool,
    flanges: [Way; SIDES],
    markers: [Way; SIDES],
}

impl Own {
    pub(super) fn of(side: Side, subject: &Subject) -> Self {
        let tracker = subject.rig.devices.as_ref().and_then(|devices| devices.tracker.as_ref());
        let has_markers = tracker.is_some_and(|tracker| tracker.tools.len() >= SIDES);
        Self { side, has_markers, flanges: Default::default(), markers: Default::default() }
    }

    fn ways(ways: &[Way; SIDES], side: Side) -> [Way; SIDES] {
        [ways[side.index()], ways[side.other().index()]]
    }
}

impl Item for Own {
    fn tick(&mut self, tick: &Tick) {
        self.flanges[tick.side.index()].add(tick.frames.base_from_flange.as_ref());
        self.markers[tick.side.index()].add(tick.frames.c_from_m.as_ref());
    }

    fn look(&mut self, _now_s: f64) -> Progress {
        let [arm, other_arm] = Self::ways(&self.flanges, self.side);
        let [marker, other_marker] = Self::ways(&self.markers, self.side);
        if other_arm.most_m >= MOVED_M && arm.rests() {
            return Progress::Failed(Cause::Exchanged(Exchange::Arms));
        }
        let moved = arm.most_m >= MOVED_M && other_arm.rests();
        if moved && self.has_markers && marker.rests() && other_marker.most_m >= MOVED_M / 2.0 {
            return Progress::Failed(Cause::Exchanged(Exchange::Markers));
        }
        let followed = !self.has_markers || marker.most_m >= MOVED_M / 2.0 && other_marker.rests();
        if !(moved && followed) {
            return Progress::Asking(Ask::Move(self.side));
        }
        let rested_m = if self.has_markers { other_arm.most_m.max(other_marker.most_m) } else { other_arm.most_m };
        Progress::Passed(Figure { value: 1e3 * rested_m, limit: 1e3 * RESTS_M, unit: Unit::Millimetre })
    }

    fn late(&self) -> Cause {
        let [arm, other_arm] = Self::ways(&self.flanges, self.side);
        if arm.most_m < MOVED_M || !other_arm.rests() {
            return Cause::ArmStuck { by_m: arm.most_m };
        }
        Cause::MarkerStuck { by_m: self.markers[self.side.index()].most_m }
    }
}
