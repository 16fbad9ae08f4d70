//! Force-torque sensors.

use nima_devices::{
    ForceSensor, Trouble, bota,
    discovery::{Probe, probes},
};
use serde::{Deserialize, Serialize, Serializer};

use super::Opener;

/// A force-torque sensor of a rig file.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SensorSettings {
    /// `make = "bota"`, the default.
    Bota(bota::Settings),
}

impl Serialize for SensorSettings {
    /// As a rig file has it: the settings alone.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Bota(settings) => settings.serialize(serializer),
        }
    }
}

impl SensorSettings {
    /// Its makes as a rig file names them, the usual one first.
    pub(super) const MAKES: &[&str] = &["bota"];

    /// Of a sensor by Bota.
    pub const fn bota(&self) -> Option<&bota::Settings> {
        let Self::Bota(settings) = self;
        Some(settings)
    }

    /// The settings, if it is a sensor by Bota.
    pub const fn bota_mut(&mut self) -> Option<&mut bota::Settings> {
        let Self::Bota(settings) = self;
        Some(settings)
    }

    /// Its serial number in the rig file.
    pub(in crate::rig) fn serial(&self) -> Option<String> {
        self.bota().and_then(|settings| settings.serial_number.clone())
    }

    /// Checks every setting.
    ///
    /// # Errors
    /// [`Trouble::Setting`] for the first invalid one.
    pub fn check(&self) -> Result<(), Trouble> {
        match self {
            Self::Bota(settings) => settings.check(),
        }
    }

    /// The device file through which it is reached, if it has one.
    pub(in crate::rig) const fn device_file(&mut self) -> Option<&mut String> {
        let Self::Bota(settings) = self;
        match settings.transport {
            bota::Transport::Socket => None,
            bota::Transport::Gen0 | bota::Transport::GenA => Some(&mut settings.port),
        }
    }

    /// Rate of its readings, Hz.
    pub(in crate::rig) fn expected_hz(&self) -> f64 {
        let Self::Bota(settings) = self;
        settings.expected_hz()
    }

    /// Whether its readings have an acceleration.
    pub(in crate::rig) const fn is_inertial(&self) -> bool {
        let Self::Bota(settings) = self;
        settings.is_inertial()
    }

    pub(in crate::rig) fn opener(&self) -> Opener<Box<dyn ForceSensor>> {
        match self.clone() {
            Self::Bota(settings) => Opener {
                driver: format!("Bota sensor, {}", settings.port),
                open: Box::new(move || Ok(Box::new(bota::Driver::open(&settings)?))),
                clear_faults: None,
            },
        }
    }

    pub(in crate::rig) fn probe(&self, name: &str) -> Box<dyn Probe> {
        match self.clone() {
            Self::Bota(settings) => probes::sensor(name, settings),
        }
    }
}
