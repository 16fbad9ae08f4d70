//! Sensors and tools on the simulated arms. They belong to the rig file; a scene only describes their physics.

use nima_devices::DeviceError;
use nima_recording::store::{WristId, can_name_a_file};
use serde::{Deserialize, Serialize};

use super::RigConfig;
use crate::rig::Side;

/// Identities of the wrist sensors and tools on the arms of a simulated rig.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SimulatedWrists {
    pub right: Option<WristId>,
    pub left: Option<WristId>,
}

impl SimulatedWrists {
    /// Returns sensor and tool on the arm of this side.
    pub const fn of(&self, side: Side) -> Option<&WristId> {
        match side {
            Side::Right => self.right.as_ref(),
            Side::Left => self.left.as_ref(),
        }
    }
}

impl RigConfig {
    /// Returns sensor and tool on the simulated arm of this side, if the rig file names them; `None` on a rig with
    /// devices.
    pub fn simulated_wrist(&self, side: Side) -> Option<&WristId> {
        self.simulated.as_ref().filter(|_| self.devices.is_none())?.of(side)
    }

    pub(super) fn check_simulated_wrists(&self) -> Result<(), DeviceError> {
        let refuse = |key: &str, value: &str, allowed: &str| {
            Err(DeviceError::Setting { key: key.to_owned(), value: value.to_owned(), allowed: allowed.to_owned() })
        };
        let Some(wrists) = &self.simulated else { return Ok(()) };
        if self.devices.is_some() {
            let allowed = "omit it on a rig with [devices], where the sensors report their serial numbers";
            return refuse("simulated", "given", allowed);
        }
        for side in Side::ALL {
            let Some(WristId { serial_number, tool }) = wrists.of(side) else { continue };
            if !can_name_a_file(serial_number) {
                let allowed = "1 to 64 letters, digits, '-', '_' and '.', not beginning with '.'";
                return refuse(&format!("simulated.{}.serial_number", side.word()), serial_number, allowed);
            }
            if tool.trim().is_empty() {
                return refuse(&format!("simulated.{}.tool", side.word()), "empty", "the tool must have a name");
            }
        }
        match (&wrists.right, &wrists.left) {
            (Some(right), Some(left)) if right.serial_number == left.serial_number => {
                let allowed = "each arm has its own sensor: use different serial numbers";
                refuse("simulated.left.serial_number", &left.serial_number, allowed)
            }
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_no_calibration_could_have_are_refused_by_their_key() {
        let good = RigConfig::load("simulated").unwrap();
        let report = |change: fn(&mut WristId)| {
            let mut rig = good.clone();
            change(rig.simulated.as_mut().unwrap().left.as_mut().unwrap());
            rig.check_simulated_wrists().unwrap_err().to_string()
        };
        let path = report(|left| left.serial_number = "../x".to_owned());
        assert!(path.contains("simulated.left.serial_number") && path.contains("../x"), "{path}");
        let same = report(|left| left.serial_number = "SIM-S1-0001".to_owned());
        assert!(same.contains("simulated.left.serial_number") && same.contains("its own sensor"), "{same}");
        assert!(report(|left| left.tool = " ".to_owned()).contains("simulated.left.tool"));
        let mut real = RigConfig::load("paper").unwrap();
        real.simulated.clone_from(&good.simulated);
        assert!(real.validate().is_err());
        assert_eq!(real.simulated_wrist(Side::Right), None, "a rig with devices has no simulated sensor");
    }
}
