//! Handles.

use nima_devices::{
    Leader, Trouble,
    discovery::{Probe, probes},
    force_dimension,
};
use serde::{Deserialize, Serialize, Serializer};

use super::Opener;
use crate::rig::Side;

/// The handle of a rig file.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LeaderSettings {
    /// `make = "force_dimension"`, the default: omega.7.
    ForceDimension(force_dimension::Settings),
}

impl Serialize for LeaderSettings {
    /// As a rig file has it: the settings alone.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::ForceDimension(settings) => settings.serialize(serializer),
        }
    }
}

impl LeaderSettings {
    /// Its makes as a rig file names them, the usual one first.
    pub(super) const MAKES: &[&str] = &["force_dimension"];

    /// The settings, if it is a handle by Force Dimension.
    pub const fn force_dimension(&self) -> Option<&force_dimension::Settings> {
        let Self::ForceDimension(settings) = self;
        Some(settings)
    }

    /// The settings, if it is a handle by Force Dimension.
    pub const fn force_dimension_mut(&mut self) -> Option<&mut force_dimension::Settings> {
        let Self::ForceDimension(settings) = self;
        Some(settings)
    }

    /// Checks every setting.
    ///
    /// # Errors
    /// [`Trouble::Setting`] for the first invalid one.
    pub fn check(&self) -> Result<(), Trouble> {
        match self {
            Self::ForceDimension(settings) => settings.check(),
        }
    }

    /// Checks that the handle is emulated if and only if the rig is. A real handle must never be replaced by an
    /// emulated one unnoticed, and an emulated rig, which engages by itself, must never move a real one.
    pub(in crate::rig) fn check_emulated(&self, rig_is_emulated: bool) -> Result<(), Trouble> {
        let Self::ForceDimension(settings) = self;
        if settings.emulator.is_some() == rig_is_emulated {
            return Ok(());
        }
        let value = settings.emulator.map_or_else(|| "not given".to_owned(), |address| address.to_string());
        let allowed =
            "an emulated rig (emulated = true) gives each handle its 127.0.0.1:PORT, and no other rig does".to_owned();
        Err(Trouble::Setting { key: "emulator".to_owned(), value, allowed })
    }

    /// Checks that the settings tell the two handles apart.
    pub(in crate::rig) fn check_beside(&self, other: &Self) -> Result<(), Trouble> {
        let (Self::ForceDimension(one), Self::ForceDimension(other)) = (self, other);
        if one.serial.is_some() && one.serial != other.serial {
            return Ok(());
        }
        let value = one.serial.map_or_else(|| "not given".to_owned(), |serial| serial.to_string());
        let allowed = "two handles are told apart by their serial numbers: give each its own".to_owned();
        Err(Trouble::Setting { key: "serial".to_owned(), value, allowed })
    }

    /// Rate of its readings, Hz.
    pub(in crate::rig) const fn rate_hz(&self) -> f64 {
        let Self::ForceDimension(settings) = self;
        settings.rate_hz
    }

    /// These settings for the handle of a side: without a word in the file it must be made for that hand.
    #[must_use]
    pub(in crate::rig) fn for_hand_of(&self, side: Side) -> Self {
        let Self::ForceDimension(mut settings) = self.clone();
        settings.hand = settings.hand.or(Some(match side {
            Side::Right => force_dimension::Hand::Right,
            Side::Left => force_dimension::Hand::Left,
        }));
        Self::ForceDimension(settings)
    }

    /// The hand that it must be made for, if the settings say so.
    pub(in crate::rig) const fn hand(&self) -> Option<force_dimension::Hand> {
        let Self::ForceDimension(settings) = self;
        settings.hand
    }

    /// Its serial number in the rig file.
    pub(in crate::rig) fn serial(&self) -> Option<String> {
        let Self::ForceDimension(settings) = self;
        settings.serial.map(|serial| serial.to_string())
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
        }
    }

    pub(in crate::rig) fn probe(&self, name: &str) -> Box<dyn Probe> {
        match self.clone() {
            Self::ForceDimension(settings) => probes::handle(name, settings),
        }
    }
}
