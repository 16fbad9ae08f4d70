use nima_devices::{
    DeviceError, ForceSensor, ati, bota,
    discovery::{Probe, probes},
    external,
};
use serde::{Deserialize, Serialize, Serializer};

use super::Opener;
use crate::rig::places::{NamedPlace, Place};

#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SensorSettings {
    /// `make = "bota"`, the default.
    Bota(bota::BotaSettings),
    /// `make = "ati"`: Net F/T.
    Ati(ati::AtiSettings),
    /// `make = "external"`: a user's program over UDP.
    External(external::ExternalSettings),
}

impl Serialize for SensorSettings {
    /// Serialises the settings alone, as in a rig file.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Bota(settings) => settings.serialize(serializer),
            Self::Ati(settings) => settings.serialize(serializer),
            Self::External(settings) => settings.serialize(serializer),
        }
    }
}

impl SensorSettings {
    /// Makes as named in a rig file, the default first.
    pub(super) const MAKES: &[&str] = &["bota", "ati", "external"];
    /// The same on the screen.
    pub(crate) const MAKERS: &[&str] = &["Bota", "ATI", "external"];

    /// Returns the settings if the sensor is made by Bota.
    pub const fn bota(&self) -> Option<&bota::BotaSettings> {
        match self {
            Self::Bota(settings) => Some(settings),
            Self::Ati(_) | Self::External(_) => None,
        }
    }

    /// Returns the settings if the sensor is made by Bota.
    pub const fn bota_mut(&mut self) -> Option<&mut bota::BotaSettings> {
        match self {
            Self::Bota(settings) => Some(settings),
            Self::Ati(_) | Self::External(_) => None,
        }
    }

    /// Returns the serial number in the rig file.
    pub(in crate::rig) fn serial(&self) -> Option<String> {
        match self {
            Self::Bota(settings) => settings.serial_number.clone(),
            Self::Ati(settings) => settings.serial_number.clone(),
            Self::External(settings) => settings.serial_number.clone(),
        }
    }

    /// Returns the make for the screen, one of [`RigPart::makes`](crate::rig::RigPart::makes).
    pub(in crate::rig) const fn maker(&self) -> &'static str {
        match self {
            Self::Bota(_) => "Bota",
            Self::Ati(_) => "ATI",
            Self::External(_) => "external",
        }
    }

    /// Checks that an emulated rig has an emulated sensor.
    pub(in crate::rig) fn check_emulated(&self, rig_is_emulated: bool) -> Result<(), DeviceError> {
        match self {
            Self::Bota(_) => Ok(()),
            Self::Ati(_) => super::not_emulated("ati", rig_is_emulated),
            Self::External(_) => super::not_emulated("external", rig_is_emulated),
        }
    }

    /// Returns the places at which the sensor is reached.
    pub(in crate::rig) fn places(&self) -> Vec<NamedPlace> {
        match self {
            Self::Bota(settings) if settings.transport == bota::Transport::Socket => {
                vec![("port", Place::tcp_at(&settings.port, bota::TCP_PORT))]
            }
            Self::Bota(settings) => vec![("port", Place::file(&settings.port))],
            Self::Ati(settings) => vec![("host", Place::udp(&settings.host, settings.rdt_port))],
            Self::External(settings) => vec![("listen", Place::listens(settings.listen))],
        }
    }

    /// Checks every setting.
    ///
    /// # Errors
    /// [`DeviceError::Setting`] for the first invalid one.
    pub fn check(&self) -> Result<(), DeviceError> {
        match self {
            Self::Bota(settings) => settings.check(),
            Self::Ati(settings) => settings.check(),
            Self::External(settings) => settings.check(external::ExternalKind::Sensor),
        }
    }

    /// Returns the device file of the sensor, if it has one.
    pub(in crate::rig) const fn device_file(&mut self) -> Option<&mut String> {
        match self {
            Self::Bota(bota::BotaSettings { transport: bota::Transport::Socket, .. })
            | Self::Ati(_)
            | Self::External(_) => None,
            Self::Bota(settings) => Some(&mut settings.port),
        }
    }

    pub(in crate::rig) fn expected_hz(&self) -> f64 {
        match self {
            Self::Bota(settings) => settings.expected_hz(),
            Self::Ati(settings) => settings.rate_hz,
            Self::External(settings) => settings.rate_hz,
        }
    }

    pub(in crate::rig) fn is_inertial(&self) -> bool {
        match self {
            Self::Bota(settings) => settings.is_inertial(),
            Self::Ati(_) => false,
            Self::External(settings) => settings.is_inertial(),
        }
    }

    pub(in crate::rig) fn opener(&self) -> Opener<Box<dyn ForceSensor>> {
        match self.clone() {
            Self::Bota(settings) => Opener {
                driver: format!("Bota sensor, {}", settings.port),
                open: Box::new(move || Ok(Box::new(bota::BotaDriver::open(&settings)?))),
                clear_faults: None,
            },
            Self::Ati(settings) => Opener {
                driver: format!("ATI sensor, {}", settings.place()),
                open: Box::new(move || Ok(Box::new(ati::AtiDriver::open(&settings)?))),
                clear_faults: None,
            },
            Self::External(settings) => Opener {
                driver: format!("external sensor, {}", settings.place()),
                open: Box::new(move || Ok(Box::new(external::ExternalSensor::open(&settings)?))),
                clear_faults: None,
            },
        }
    }

    pub(in crate::rig) fn probe(&self, name: &str) -> Box<dyn Probe> {
        match self.clone() {
            Self::Bota(settings) => probes::sensor(name, settings),
            Self::Ati(settings) => probes::ati(name, settings),
            Self::External(settings) => probes::external(name, external::ExternalKind::Sensor, settings),
        }
    }
}
