//! The loop of a replay.

use std::collections::BTreeMap;

use nima_core::impedance::SettingsError;
use nima_machine::{
    messages::{Event, Tick},
    rig::{Outputs, SIDES},
    runtime::Operation,
    teleop::{Calibrations, ForcePath, Loop, LoopOrigin},
};

use super::{ReplayError, side_by_side::RunOutput};
use crate::journal::TickRow;

/// A loop that is fed from a journal.
#[derive(Clone, Debug)]
pub struct ReplayMachine {
    control: Loop,
    calibrations: BTreeMap<u64, Calibrations>,
    period_s: f64,
}

impl ReplayMachine {
    /// Builds a loop.
    ///
    /// # Errors
    /// [`SettingsError`] if the settings of the identification are invalid.
    pub fn new(origin: &LoopOrigin) -> Result<Self, SettingsError> {
        let period_s = 1.0 / origin.rig.rate_hz;
        Ok(Self { control: origin.control()?, calibrations: BTreeMap::new(), period_s })
    }

    /// Stores calibrations that become active later.
    pub fn know(&mut self, number: u64, calibrations: Calibrations) {
        self.calibrations.insert(number, calibrations);
    }

    /// Applies the operation that preceded this tick.
    ///
    /// # Errors
    /// [`ReplayError::NoCalibrations`] if they were not in the journal.
    pub fn apply(&mut self, operation: Operation, tick: u64) -> Result<(), ReplayError> {
        match operation {
            Operation::Command { command, t_s } => self.control.obey(command, t_s),
            Operation::Device(event) => self.control.notice(&event),
            Operation::Suspend(side) => self.control.suspend_calibrations(side),
            Operation::Calibrations { side, number } => {
                let known = self.calibrations.remove(&number).ok_or(ReplayError::NoCalibrations { number, tick })?;
                let mut path = ForcePath::new(&known, self.period_s);
                self.control.exchange_force_path(side, &mut path);
            }
            Operation::Stall { silent_s, t_s } => self.control.notice_stall(silent_s, t_s),
        }
        Ok(())
    }

    pub fn step(&mut self, row: &TickRow) -> ([Outputs; SIDES], [Option<Tick>; SIDES]) {
        self.control.step(row.inputs, &row.timing)
    }

    /// Steps over these ticks, between which there is no operation; those before `from_s` (s) are not compared.
    pub(super) fn run(&mut self, rows: &[Vec<TickRow>], from_s: f64) -> Result<RunOutput, ReplayError> {
        RunOutput::of(&mut self.control, rows, from_s)
    }

    /// Returns the events of this tick; call it after every tick.
    pub fn take_events(&mut self, into: &mut Vec<Event>) {
        into.clear();
        into.extend(self.control.events().copied());
        self.control.clear_events();
    }
}
