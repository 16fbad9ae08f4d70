use nima_devices::{
    DeviceError, DeviceSlot, Leader, Lever,
    discovery::{Probe, probes},
    external, force_dimension, haply,
};
use serde::{Deserialize, Serialize, Serializer};

use super::Opener;
use crate::rig::{
    DeviceRole, RigError, RigPart, RosterEntry, Side,
    places::{NamedPlace, Place},
};

#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LeaderSettings {
    /// `make = "force_dimension"`, the default: omega.7.
    ForceDimension(force_dimension::ForceDimensionSettings),
    /// `make = "haply"`: Inverse3 or Minverse.
    Haply(haply::HaplySettings),
    /// `make = "external"`: a user's program over UDP.
    External(external::ExternalSettings),
}

impl Serialize for LeaderSettings {
    /// Serialises the settings alone, as in a rig file.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::ForceDimension(settings) => settings.serialize(serializer),
            Self::Haply(settings) => settings.serialize(serializer),
            Self::External(settings) => settings.serialize(serializer),
        }
    }
}

impl LeaderSettings {
    /// Makes as named in a rig file, the default first.
    pub(super) const MAKES: &[&str] = &["force_dimension", "haply", "external"];
    /// The same on the screen.
    pub(crate) const MAKERS: &[&str] = &["Force Dimension", "Haply", "external"];

    /// Returns the settings if the handle is made by Force Dimension.
    pub const fn force_dimension(&self) -> Option<&force_dimension::ForceDimensionSettings> {
        match self {
            Self::ForceDimension(settings) => Some(settings),
            Self::Haply(_) | Self::External(_) => None,
        }
    }

    /// Returns the settings if the handle is made by Force Dimension.
    pub const fn force_dimension_mut(&mut self) -> Option<&mut force_dimension::ForceDimensionSettings> {
        match self {
            Self::ForceDimension(settings) => Some(settings),
            Self::Haply(_) | Self::External(_) => None,
        }
    }

    /// Returns the make for the screen, one of [`RigPart::makes`](crate::rig::RigPart::makes).
    pub(crate) const fn maker(&self) -> &'static str {
        match self {
            Self::ForceDimension(_) => "Force Dimension",
            Self::Haply(_) => "Haply",
            Self::External(_) => "external",
        }
    }

    /// Checks every setting.
    ///
    /// # Errors
    /// [`DeviceError::Setting`] for the first invalid one.
    pub fn check(&self) -> Result<(), DeviceError> {
        match self {
            Self::ForceDimension(settings) => settings.check(),
            Self::Haply(settings) => settings.check(),
            Self::External(settings) => settings.check(external::ExternalKind::Handle),
        }
    }

    /// Checks that the handle is emulated if and only if the rig is. An emulated handle must never replace a real one
    /// unnoticed, and an emulated rig, which engages automatically, must never move a real handle.
    pub(in crate::rig) fn check_emulated(&self, rig_is_emulated: bool) -> Result<(), DeviceError> {
        let settings = match self {
            Self::ForceDimension(settings) => settings,
            Self::Haply(_) => return super::not_emulated("haply", rig_is_emulated),
            Self::External(_) => return super::not_emulated("external", rig_is_emulated),
        };
        if settings.emulator.is_some() == rig_is_emulated {
            return Ok(());
        }
        let value = settings.emulator.map_or_else(|| "not given".to_owned(), |address| address.to_string());
        let allowed =
            "127.0.0.1:PORT for each handle of an emulated rig (emulated = true), omitted on any other rig".to_owned();
        Err(DeviceError::Setting { key: "emulator".to_owned(), value, allowed })
    }

    /// Checks that the settings distinguish the two handles.
    pub(in crate::rig) fn check_beside(&self, other: &Self) -> Result<(), DeviceError> {
        // Ports and addresses are checked together with those of all parts.
        let (Self::ForceDimension(one), Self::ForceDimension(other)) = (self, other) else { return Ok(()) };
        if one.serial.is_some() && one.serial != other.serial {
            return Ok(());
        }
        let value = one.serial.map_or_else(|| "not given".to_owned(), |serial| serial.to_string());
        let allowed = "a different serial number for each of two handles".to_owned();
        Err(DeviceError::Setting { key: "serial".to_owned(), value, allowed })
    }

    /// Returns the places at which the handle is reached.
    pub(in crate::rig) fn places(&self) -> Vec<NamedPlace> {
        match self {
            Self::ForceDimension(settings) => {
                let emulator = settings.emulator.map(|at| Place::tcp(&at.ip().to_string(), at.port()));
                emulator.into_iter().map(|place| ("emulator", place)).collect()
            }
            Self::Haply(settings) => vec![("port", Place::file(&settings.port))],
            Self::External(settings) => vec![("listen", Place::listens(settings.listen))],
        }
    }

    pub(in crate::rig) const fn rate_hz(&self) -> f64 {
        match self {
            Self::ForceDimension(settings) => settings.rate_hz,
            // The handle is queried once per tick, whatever the rate of the loop.
            Self::Haply(_) => f64::INFINITY,
            Self::External(settings) => settings.rate_hz,
        }
    }

    /// Returns these settings for the handle of a side: unless the file specifies otherwise, the handle must be built
    /// for that hand.
    #[must_use]
    pub(in crate::rig) fn for_hand_of(&self, side: Side) -> Self {
        let mut of_side = self.clone();
        if let Self::ForceDimension(settings) = &mut of_side {
            settings.hand = settings.hand.or(Some(side));
        }
        of_side
    }

    /// Returns the hand for which the handle must be built, if the settings specify one.
    pub(in crate::rig) fn hand(&self) -> Option<Side> {
        self.force_dimension().and_then(|settings| settings.hand)
    }

    /// Returns the serial number in the rig file.
    pub(in crate::rig) fn serial(&self) -> Option<String> {
        match self {
            Self::ForceDimension(settings) => settings.serial.map(|serial| serial.to_string()),
            Self::Haply(settings) => settings.serial_number.clone(),
            Self::External(settings) => settings.serial_number.clone(),
        }
    }

    pub(in crate::rig) fn opener(&self) -> Opener<Box<dyn Leader>> {
        match self.clone() {
            Self::ForceDimension(settings) => {
                let which = settings.serial.map_or_else(|| "any".to_owned(), |serial| serial.to_string());
                Opener {
                    driver: format!("Force Dimension omega.7, {which}"),
                    open: Box::new(move || Ok(Box::new(force_dimension::open(&settings)?))),
                    clear_faults: None,
                }
            }
            Self::Haply(settings) => Opener {
                driver: format!("Haply handle, {}", settings.port),
                open: Box::new(move || Ok(Box::new(haply::HaplyDriver::open(&settings)?))),
                clear_faults: None,
            },
            Self::External(settings) => Opener {
                driver: format!("external handle, {}", settings.place()),
                open: Box::new(move || Ok(Box::new(external::ExternalHandle::open(&settings)?))),
                clear_faults: None,
            },
        }
    }

    /// Starts opening the handle that controls a simulated rig; `lever` releases its force from another thread.
    ///
    /// # Errors
    /// [`RigError`] if no thread can be created.
    pub fn start(&self, lever: &Lever) -> Result<(DeviceSlot<Box<dyn Leader>>, RosterEntry), RigError> {
        let Opener { driver, mut open, clear_faults } = self.opener();
        let lever = lever.clone();
        let role = DeviceRole::Part(RigPart::Handle(Side::Right));
        let slot = DeviceSlot::start(role.name(), move || open().inspect(|handle| handle.attach(&lever)))?;
        let entry = RosterEntry { clear_faults, ..RosterEntry::new(role, driver, slot.view()) };
        Ok((slot, entry))
    }

    /// Returns a test of the handle, under this name.
    pub fn probe(&self, name: &str) -> Box<dyn Probe> {
        match self.clone() {
            Self::ForceDimension(settings) => probes::handle(name, settings),
            Self::Haply(settings) => probes::haply(name, settings),
            Self::External(settings) => probes::external(name, external::ExternalKind::Handle, settings),
        }
    }
}
