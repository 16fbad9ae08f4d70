//! Initial data of a loop.

use nima_core::impedance::SettingsError;

use super::{Calibrations, Loop};
use crate::{
    config::RigConfig,
    rig::{SIDES, Side},
};

/// All initial data of a loop. Two loops with the same origin and the same input return identical results to the last
/// bit.
#[derive(Clone, Debug)]
pub struct LoopOrigin {
    pub rig: RigConfig,
    /// Calibrations of each side that has an arm pair.
    pub calibrations: [Option<Calibrations>; SIDES],
    /// The calibrations are suspended from the start, because the sensors have not been identified yet.
    pub suspended: bool,
}

impl LoopOrigin {
    /// Creates the loop.
    ///
    /// # Errors
    /// [`SettingsError`] if the settings of the identification are invalid.
    pub fn control(&self) -> Result<Loop, SettingsError> {
        let mut control = Loop::new(&self.rig, &self.calibrations)?;
        if self.suspended {
            for side in Side::ALL {
                control.suspend_calibrations(side);
            }
        }
        Ok(control)
    }
}
