//! What a loop is made of.

use nima_core::impedance::SettingsError;

use super::{Calibrations, Loop};
use crate::{
    config::RigConfig,
    rig::{SIDES, Side},
};

/// All that a loop is made of. Two loops of the same origin that are fed alike return the same to the last bit.
#[derive(Clone, Debug)]
pub struct Origin {
    /// The rig.
    pub rig: RigConfig,
    /// Calibrations of each side that has an arm pair.
    pub calibrations: [Option<Calibrations>; SIDES],
    /// The calibrations are suspended from the start: the sensors are yet to tell who they are.
    pub suspended: bool,
}

impl Origin {
    /// The loop.
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
