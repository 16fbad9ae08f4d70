//! Arms.

use nima_core::kinematics::JointLimits;
use nima_devices::{
    ClearFaults, Follower, Trouble,
    discovery::{DeviceProbe, Probe, Speaks, probes},
    kinova, simulated_arm,
};
use serde::{Deserialize, Serialize, Serializer};

use super::Opener;

/// The arm of a rig file. Both makes have the joints of a Gen3.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FollowerSettings {
    /// `make = "kinova"`, the default: Gen3 with seven joints.
    Kinova(kinova::Settings),
    /// `make = "simulated"`: no hardware.
    Simulated(simulated_arm::Settings),
}

impl Serialize for FollowerSettings {
    /// As a rig file has it: the settings alone.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Kinova(settings) => settings.serialize(serializer),
            Self::Simulated(settings) => settings.serialize(serializer),
        }
    }
}

impl FollowerSettings {
    /// Its makes as a rig file names them, the usual one first.
    pub(super) const MAKES: &[&str] = &["kinova", "simulated"];

    /// Of an arm by Kinova.
    pub const fn kinova(&self) -> Option<&kinova::Settings> {
        match self {
            Self::Kinova(settings) => Some(settings),
            Self::Simulated(_) => None,
        }
    }

    /// The settings, if it is an arm by Kinova.
    pub const fn kinova_mut(&mut self) -> Option<&mut kinova::Settings> {
        match self {
            Self::Kinova(settings) => Some(settings),
            Self::Simulated(_) => None,
        }
    }

    /// Its serial number in the rig file.
    pub(in crate::rig) fn serial(&self) -> Option<String> {
        self.kinova().and_then(|settings| settings.serial_number.clone())
    }

    /// Checks every setting.
    ///
    /// # Errors
    /// [`Trouble::Setting`] for the first invalid one.
    pub fn check(&self) -> Result<(), Trouble> {
        match self {
            Self::Kinova(settings) => settings.check(),
            Self::Simulated(settings) => settings.check(),
        }
    }

    /// Checks that an emulated rig has an emulated arm: handle and sensor of an emulated rig belong to a world that
    /// this arm moves, and a simulated arm has no such world.
    pub(in crate::rig) fn check_emulated(&self, rig_is_emulated: bool) -> Result<(), Trouble> {
        match self {
            Self::Simulated(_) if rig_is_emulated => Err(Trouble::Setting {
                key: "make".to_owned(),
                value: "simulated".to_owned(),
                allowed: "an emulated rig (emulated = true) emulates its arm: leave `make` out".to_owned(),
            }),
            _ => Ok(()),
        }
    }

    /// Limits of position, speed and acceleration of its joints.
    pub(in crate::rig) fn joint_limits(&self) -> JointLimits {
        match self {
            Self::Kinova(settings) => settings.joint_limits(),
            Self::Simulated(settings) => settings.joint_limits(),
        }
    }

    pub(in crate::rig) fn opener(&self) -> Opener<Box<dyn Follower>> {
        match self.clone() {
            Self::Kinova(settings) => {
                let clearing = kinova::FaultClearing::default();
                let of_opening = clearing.clone();
                Opener {
                    driver: format!("Kinova Gen3, {}", settings.host),
                    open: Box::new(move || Ok(Box::new(kinova::open_clearing(&settings, &of_opening)?))),
                    clear_faults: Some(ClearFaults::by(move || clearing.command())),
                }
            }
            Self::Simulated(settings) => Opener {
                driver: "simulated arm".to_owned(),
                open: Box::new(move || Ok(Box::new(simulated_arm::Driver::open(&settings)?))),
                clear_faults: None,
            },
        }
    }

    pub(in crate::rig) fn probe(&self, name: &str) -> Box<dyn Probe> {
        match self.clone() {
            Self::Kinova(settings) => probes::arm(name, settings),
            Self::Simulated(settings) => {
                let open = move || simulated_arm::Driver::open(&settings);
                Box::new(DeviceProbe::new(name, "this program".to_owned(), Speaks::Always, open))
            }
        }
    }
}
