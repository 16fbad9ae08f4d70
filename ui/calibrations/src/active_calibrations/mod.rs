//! The active calibrations of each side, for display and for the loop: those of the mounted sensor and tool.
//!
//! The rig determines sensor and tool. For a simulated rig they are named in the rig file. On a rig with devices each sensor
//! reports its serial number when it is opened; before that no calibration is active, and afterwards [`ActiveCalibrations::meet`]
//! updates the calibrations whenever a sensor connects or disconnects.

mod in_use;
mod of_side;
#[cfg(test)]
mod tests;

use std::path::{Path, PathBuf};

use nima_core::calibration::{
    frames::RigChange,
    gravity::{GravityDrift, GravityModel},
};
use nima_machine::{
    config::{RigConfig, RigFile, change_rig},
    messages::Tick,
    rig::{Roster, SIDES, Side},
    runtime::LoopHandle,
    teleop::Calibrations,
};
use nima_recording::store::{ReadyRecord, Store, WristId, utc_now};
use nima_simulation::scene::Scene;
use nima_words::{
    report_text::{chain, side_name},
    text,
};
use of_side::{SideBinding, SideCalibrations};

use crate::{
    Binding, SaveRequest,
    frames::{FrameSaving, FrameSubject},
    overview::OverviewLine,
};

/// The active calibrations, and problems with them.
#[derive(Debug)]
pub struct ActiveCalibrations {
    store: Option<Store>,
    sides: [SideCalibrations; SIDES],
    /// The arm that the wizards calibrate.
    side: Side,
    report: Option<String>,
    /// Calibrations of a recorded session, one line each.
    past: Vec<String>,
}

impl ActiveCalibrations {
    /// Loads the calibrations for the sensors and tools of this rig from the store in `folder` (or the user's own).
    pub fn load(folder: Option<&Path>, rig: &RigConfig, scene: &Scene) -> Self {
        let store = folder.map_or_else(|| Store::of_user().ok(), |folder| Some(Store::open(folder)));
        let mut this = Self { store, sides: Default::default(), side: Side::Right, report: None, past: Vec::new() };
        this.bind(rig, scene);
        this
    }

    /// Creates the calibrations of a recorded session, from its metadata; they cannot be changed.
    pub fn of_past(lines: Vec<String>) -> Self {
        Self { store: None, sides: Default::default(), side: Side::Right, report: None, past: lines }
    }

    /// Prepares for a loop of this rig and scene that is about to start.
    pub fn bind(&mut self, rig: &RigConfig, scene: &Scene) {
        for side in Side::ALL {
            let bound = if !scene.measures_at_wrist(rig, side) {
                SideBinding::Nothing
            } else if rig.devices.is_some() {
                SideBinding::Waiting
            } else {
                let nameless = SideBinding::Nameless(text::calibrations::RIG_WITHOUT_SENSOR.get());
                rig.simulated_wrist(side).map_or(nameless, |wrist| SideBinding::To(wrist.clone()))
            };
            self.go_over(side, bound);
        }
        if !scene.has(rig, self.side) {
            self.side = Side::Right;
        }
    }

    fn go_over(&mut self, side: Side, bound: SideBinding) {
        let now = &mut self.sides[side.index()];
        *now = SideCalibrations::load(self.store.as_ref(), bound, now.last.take());
    }

    /// Reads the identity of the sensors of a running loop, and activates their calibrations. Returns true for each side
    /// whose sensor has changed.
    pub fn meet(&mut self, handle: &LoopHandle, rig: &RigConfig) -> [bool; SIDES] {
        Side::ALL.map(|side| self.meet_one(side, handle, rig).unwrap_or(false))
    }

    fn meet_one(&mut self, side: Side, handle: &LoopHandle, rig: &RigConfig) -> Option<bool> {
        let tool = &rig.devices.as_ref()?.arm(side)?.tool;
        // Read the count first: if the sensor is swapped after this, the loop rejects the calibrations.
        let change = handle.wrist_change(side);
        let now = &self.sides[side.index()];
        if now.bound == SideBinding::Nothing || now.since == Some(change) {
            return None;
        }
        let before = now.last.clone();
        let bound = match handle.force_sensor(side).filter(|_| change.is_there()) {
            None => SideBinding::Waiting,
            Some(sensor) if sensor.serial.is_empty() => {
                SideBinding::Nameless(text::calibrations::SENSOR_WITHOUT_SERIAL.get())
            }
            Some(sensor) => SideBinding::To(WristId { serial_number: sensor.serial, tool: tool.clone() }),
        };
        self.go_over(side, bound);
        let now = &mut self.sides[side.index()];
        // If the loop rejects them, they are offered again in the next frame.
        let taken = handle.activate(change, &now.calibrations(rig.tip_force.fallback));
        now.since = taken.then_some(change);
        Some(before.is_some() && now.last != before)
    }

    /// Returns whether a sensor has yet to report its identity.
    pub fn is_waiting(&self) -> bool {
        self.sides.iter().any(|of_side| of_side.bound == SideBinding::Waiting)
    }

    /// Returns a known sensor and tool without the gravity calibration that they need.
    pub fn uncalibrated(&self) -> Option<&WristId> {
        self.sides.iter().find_map(SideCalibrations::without_gravity)
    }

    /// Returns the missing calibrations of each side whose sensor is known: sensor, tool and names.
    pub fn lacking(&self) -> Vec<(&WristId, Vec<&'static str>)> {
        self.sides
            .iter()
            .filter_map(|of_side| Some((of_side.wrist()?, of_side.lacks())))
            .filter(|(_, lacks)| !lacks.is_empty())
            .collect()
    }

    pub const fn side(&self) -> Side {
        self.side
    }

    pub const fn choose(&mut self, side: Side) {
        self.side = side;
    }

    pub fn watch(&mut self, tick: &Tick) {
        self.sides[tick.side.index()].watch(tick);
    }

    /// Returns the result of the bias check of the side that needs more attention; `None` if there is nothing to check.
    pub fn drift(&self) -> Option<GravityDrift> {
        let attention = |drift: &GravityDrift| match drift {
            GravityDrift::Fine { .. } => 0,
            GravityDrift::NotChecked(_) => 1,
            GravityDrift::Moved { .. } => 2,
            GravityDrift::Waiting => 3,
        };
        self.sides.iter().filter_map(SideCalibrations::drift).max_by_key(attention)
    }

    /// Returns the largest change of a bias since its calibration, N, and its arm; `None` if there is none.
    pub fn bias_moved(&self) -> Option<(Side, f64)> {
        let moved = |(side, of_side): (Side, &SideCalibrations)| match of_side.drift() {
            Some(GravityDrift::Moved { by_n }) => Some((side, by_n)),
            _ => None,
        };
        Side::ALL.into_iter().zip(&self.sides).filter_map(moved).max_by(|(_, one), (_, other)| one.total_cmp(other))
    }

    /// Returns the rig for a loop that is about to start, with the devices of its last passed ready check.
    #[must_use]
    pub fn with_checked(&self, mut rig: RigConfig) -> RigConfig {
        let last = self.store.as_ref().and_then(|store| store.last_passed_check(&rig.name));
        rig.remember(last.as_ref());
        rig
    }

    /// Returns the calibrations for a loop of this rig that is about to start.
    pub fn calibrations(&mut self, rig: &RigConfig) -> [Calibrations; SIDES] {
        self.sides.each_mut().map(|of_side| of_side.calibrations(rig.tip_force.fallback))
    }

    /// Returns the gravity calibration of a side, and the limit of the remaining force at rest, N.
    pub fn gravity(&self, side: Side) -> Option<(GravityModel, f64)> {
        self.sides[side.index()].gravity()
    }

    /// Returns whether the force of this side is measured at the wrist.
    pub fn is_at_wrist(&self, side: Side) -> bool {
        self.sides[side.index()].bound != SideBinding::Nothing
    }

    /// Returns the sensor and tool of a side, once known.
    pub const fn wrist(&self, side: Side) -> Option<&WristId> {
        self.sides[side.index()].wrist()
    }

    /// Returns the force calibrations of this side; `last` is the last ready check.
    pub fn kept(&self, side: Side, last: Option<&ReadyRecord>) -> Vec<OverviewLine> {
        self.sides[side.index()].kept(side, last)
    }

    /// Returns whether a calibration is dated in the future: this computer's date is wrong, or was.
    pub fn is_date_behind(&self) -> bool {
        self.sides.iter().any(SideCalibrations::is_from_the_future)
    }

    /// Returns the store of calibrations and checks; `None` without a folder.
    pub const fn store(&self) -> Option<&Store> {
        self.store.as_ref()
    }

    /// Returns the sensor and tool for which a new calibration would be saved.
    pub fn binding(&self) -> Binding {
        let of_side = &self.sides[self.side.index()];
        let (sensor, tool) =
            of_side.wrist().map(|wrist| (wrist.serial_number.clone(), wrist.tool.clone())).unwrap_or_default();
        let correspondence = of_side.correspondence.as_ref().map(|loaded| loaded.record.correspondence());
        let store = self.store.clone();
        Binding { sensor, tool, date: utc_now(), correspondence, store, ..Binding::default() }
    }

    /// Like [`ActiveCalibrations::binding`], for the arm of this rig, with this name and these devices.
    pub fn binding_of(&self, name: &str, rig: &RigConfig, roster: &Roster) -> Binding {
        let subject = FrameSubject::of(rig, self.side, roster);
        Binding { subject, rig: name.to_owned(), has_image: rig.endoscope.is_some(), ..self.binding() }
    }

    /// Saves a frame calibration: its record and changes into the store, and the values into the rig file of this name, or
    /// into a copy in `folder` if the rig is built in. Returns the new rig, its path, and a text for the screen.
    ///
    /// # Errors Returns one line for the screen.
    pub fn save_frame(
        &self,
        saving: FrameSaving,
        rig: &str,
        folder: Option<&Path>,
    ) -> Result<(RigConfig, PathBuf, String), String> {
        let store = self.store.as_ref().ok_or(text::calibrations::NO_FOLDER.get())?;
        if self.sides[self.side.index()].wrist().is_none() {
            return Err(text::calibrations::NO_SENSOR_TO_SAVE_FOR.get().to_owned());
        }
        let file = RigFile::of(rig).map_err(|error| chain(&error))?;
        let FrameSaving { mut record, numbers } = saving;
        let change = |(key, after): (String, String)| RigChange { before: file.value(&key), after: Some(after), key };
        let changes: Vec<RigChange> = numbers.into_iter().map(change).collect();
        record.rig_mut().clone_from(&changes);
        let kept = record.save(store).map_err(|error| chain(&error))?;
        let (path, rig) = self.change_rig(&changes, rig, folder)?;
        let words = text::frames::written(&kept, &path);
        Ok((rig, path, words))
    }

    /// Changes the rig file of this name, or a copy in `folder` if the rig is built in.
    ///
    /// # Errors Returns one line for the screen.
    pub fn change_rig(
        &self,
        changes: &[RigChange],
        rig: &str,
        folder: Option<&Path>,
    ) -> Result<(PathBuf, RigConfig), String> {
        let folder = folder.ok_or(text::calibrations::NO_FOLDER.get())?;
        if changes.is_empty() {
            let config = RigConfig::load(rig).map_err(|error| chain(&error))?;
            return Ok((PathBuf::from(rig), config));
        }
        change_rig(rig, &folder.join("rigs"), changes).map_err(|error| chain(&error))
    }

    /// Saves a record and activates it; returns a text for the screen.
    pub fn save(&mut self, saving: SaveRequest) -> Result<String, String> {
        let store = self.store.as_ref().ok_or(text::calibrations::NO_FOLDER.get())?;
        let of_side = &mut self.sides[self.side.index()];
        if of_side.wrist().is_none() {
            return Err(text::calibrations::NO_SENSOR_TO_SAVE_FOR.get().to_owned());
        }
        let path = of_side.save(store, saving)?;
        self.report = None;
        Ok(text::calibrations::saved(&path))
    }

    pub fn notify(&mut self, words: String) {
        self.report = Some(words);
    }

    /// Problems, with remedies.
    pub fn report(&self) -> Vec<String> {
        let [right, left] = &self.sides;
        let exchanged = right.is_exchanged_with(left).zip(left.is_exchanged_with(right));
        if let Some((of_right, of_left)) = exchanged {
            let words = text::calibrations::sensors_are_exchanged(of_right, of_left);
            return self.report.clone().into_iter().chain([words]).collect();
        }
        let of_sides = [right.report(left.wrist()), left.report(right.wrist())];
        self.report.clone().into_iter().chain(of_sides.into_iter().flatten()).collect()
    }

    /// Returns one line for each calibration that this rig needs.
    pub fn lines(&self) -> Vec<String> {
        if !self.past.is_empty() {
            return self.past.clone();
        }
        let at_wrist = |side: &Side| self.sides[side.index()].bound != SideBinding::Nothing;
        let sides: Vec<_> = Side::ALL.into_iter().filter(at_wrist).collect();
        let name = |side: Side| (sides.len() > 1).then(|| side_name(side));
        let lines: Vec<_> = sides.iter().flat_map(|side| self.sides[side.index()].lines(name(*side))).collect();
        if lines.is_empty() { vec![text::calibrations::NOT_NEEDED.get().to_owned()] } else { lines }
    }
}
