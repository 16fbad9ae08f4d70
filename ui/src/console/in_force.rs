//! The calibrations in force on each side, as the screen tells them and as the loop gets them: those of the sensor and tool that are
//! mounted there.
//!
//! The rig says which these are. On a simulated one the rig file names them. On one with devices each sensor tells its serial number
//! once it is open; until then nothing is in force, and [`InForce::meet`] sees to it afterwards, whenever a sensor comes or goes.

mod of_side;
#[cfg(test)]
mod tests;

use std::path::Path;

use nima_core::calibration::gravity::Drift;
use nima_machine::{
    config::RigConfig,
    messages::Tick,
    rig::{SIDES, Side},
    runtime::Handle,
    teleop::Calibrations,
};
use nima_recording::store::{Store, WristId, utc_now};
use nima_world::scene::Scene;
use of_side::{Bound, OfSide};

use super::{
    scene3d::side_name,
    wizards::{Binding, Saving},
};
use crate::console::text;

/// What is in force, and what stood in the way.
#[derive(Debug)]
pub struct InForce {
    store: Option<Store>,
    sides: [OfSide; SIDES],
    /// The arm that the wizards calibrate.
    side: Side,
    told: Option<String>,
}

impl InForce {
    /// What the store in `folder` (or the user's own) holds for the sensors and tools of this rig.
    pub fn load(folder: Option<&Path>, rig: &RigConfig, scene: &Scene) -> Self {
        let store = folder.map_or_else(|| Store::of_user().ok(), |folder| Some(Store::open(folder)));
        let mut this = Self { store, sides: Default::default(), side: Side::Right, told: None };
        this.bind(rig, scene);
        this
    }

    /// Goes over to a loop of this rig and scene that is about to begin.
    pub fn bind(&mut self, rig: &RigConfig, scene: &Scene) {
        for side in Side::ALL {
            let bound = if !scene.measures_at_wrist(rig, side) {
                Bound::Nothing
            } else if rig.devices.is_some() {
                Bound::Waiting
            } else {
                let nameless = Bound::Nameless(text::calibrations::RIG_WITHOUT_SENSOR);
                rig.simulated_wrist(side).map_or(nameless, |wrist| Bound::To(wrist.clone()))
            };
            self.go_over(side, bound);
        }
        if !scene.has(rig, self.side) {
            self.side = Side::Right;
        }
    }

    fn go_over(&mut self, side: Side, bound: Bound) {
        let now = &mut self.sides[side.index()];
        *now = OfSide::load(self.store.as_ref(), bound, now.last.take());
    }

    /// Looks who the sensors of a running loop are, and puts in force what is known of them. True for each side whose sensor is
    /// another one than before.
    pub fn meet(&mut self, handle: &Handle, rig: &RigConfig) -> [bool; SIDES] {
        Side::ALL.map(|side| self.meet_one(side, handle, rig).unwrap_or(false))
    }

    fn meet_one(&mut self, side: Side, handle: &Handle, rig: &RigConfig) -> Option<bool> {
        let tool = &rig.devices.as_ref()?.arm(side)?.tool;
        // The change first: if the sensor is exchanged after this, what is found now is refused.
        let change = handle.wrist_change(side);
        let now = &self.sides[side.index()];
        if now.bound == Bound::Nothing || now.since == Some(change) {
            return None;
        }
        let before = now.last.clone();
        let bound = match handle.force_sensor(side).filter(|_| change.is_there()) {
            None => Bound::Waiting,
            Some(sensor) if sensor.serial.is_empty() => Bound::Nameless(text::calibrations::SENSOR_WITHOUT_SERIAL),
            Some(sensor) => Bound::To(WristId { serial_number: sensor.serial, tool: tool.clone() }),
        };
        self.go_over(side, bound);
        let now = &mut self.sides[side.index()];
        // What the loop did not take is offered again.
        let taken = handle.put_in_force(change, &now.calibrations(rig.tip_force.fallback));
        now.since = taken.then_some(change);
        Some(before.is_some() && now.last != before)
    }

    /// A sensor that has not told who it is decides what is in force.
    pub fn is_waiting(&self) -> bool {
        self.sides.iter().any(|of_side| of_side.bound == Bound::Waiting)
    }

    /// A known sensor and tool that need a gravity calibration and have none.
    pub fn uncalibrated(&self) -> Option<&WristId> {
        self.sides.iter().find_map(OfSide::without_gravity)
    }

    /// The arm that the wizards calibrate.
    pub const fn side(&self) -> Side {
        self.side
    }

    /// Chooses the arm that the wizards calibrate.
    pub const fn choose(&mut self, side: Side) {
        self.side = side;
    }

    /// Takes in one tick of the loop.
    pub fn watch(&mut self, tick: &Tick) {
        self.sides[tick.side.index()].watch(tick);
    }

    /// How gravity stands since the loop began, on the side that needs more attention; none where nothing is to be checked.
    pub fn drift(&self) -> Option<Drift> {
        let attention = |drift: &Drift| match drift {
            Drift::Fine { .. } => 0,
            Drift::NotChecked(_) => 1,
            Drift::Moved { .. } => 2,
            Drift::Waiting => 3,
        };
        self.sides.iter().filter_map(OfSide::drift).max_by_key(attention)
    }

    /// By how much a bias has moved, if one has, N.
    pub fn bias_moved_n(&self) -> Option<f64> {
        let moved = |of_side: &OfSide| match of_side.drift() {
            Some(Drift::Moved { by_n }) => Some(by_n),
            _ => None,
        };
        self.sides.iter().filter_map(moved).max_by(f64::total_cmp)
    }

    /// For a loop of this rig that is about to begin.
    pub fn calibrations(&mut self, rig: &RigConfig) -> [Calibrations; SIDES] {
        self.sides.each_mut().map(|of_side| of_side.calibrations(rig.tip_force.fallback))
    }

    /// What a new calibration would belong to.
    pub fn binding(&self) -> Binding {
        let of_side = &self.sides[self.side.index()];
        let (sensor, tool) =
            of_side.wrist().map(|wrist| (wrist.serial_number.clone(), wrist.tool.clone())).unwrap_or_default();
        let correspondence = of_side.correspondence.as_ref().map(|loaded| loaded.record.correspondence());
        Binding { sensor, tool, date: utc_now(), correspondence, store: self.store.clone() }
    }

    /// Keeps a record and takes it into force; words for the screen.
    pub fn save(&mut self, saving: Saving) -> Result<String, String> {
        let store = self.store.as_ref().ok_or(text::calibrations::NO_FOLDER)?;
        let of_side = &mut self.sides[self.side.index()];
        if of_side.wrist().is_none() {
            return Err(text::calibrations::NO_SENSOR_TO_SAVE_FOR.to_owned());
        }
        let path = of_side.save(store, saving)?;
        self.told = None;
        Ok(text::calibrations::saved(&path))
    }

    /// Something that went wrong, for the card.
    pub fn tell(&mut self, words: String) {
        self.told = Some(words);
    }

    /// What is wrong, and what can be done.
    pub fn told(&self) -> Vec<String> {
        let [right, left] = &self.sides;
        let of_sides = [right.told(left.wrist()), left.told(right.wrist())];
        self.told.clone().into_iter().chain(of_sides.into_iter().flatten()).collect()
    }

    /// One line for each calibration that matters to this rig.
    pub fn lines(&self) -> Vec<String> {
        let at_wrist = |side: &Side| self.sides[side.index()].bound != Bound::Nothing;
        let sides: Vec<_> = Side::ALL.into_iter().filter(at_wrist).collect();
        let name = |side: Side| (sides.len() > 1).then(|| side_name(side));
        let lines: Vec<_> = sides.iter().flat_map(|side| self.sides[side.index()].lines(name(*side))).collect();
        if lines.is_empty() { vec![text::calibrations::NOT_NEEDED.to_owned()] } else { lines }
    }
}
