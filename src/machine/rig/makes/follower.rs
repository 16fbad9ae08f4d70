use nima_core::kinematics::{ArmModel, JointLimits};
use nima_devices::{
    ClearFaults, DeviceError, Follower,
    discovery::{DataTiming, DeviceProbe, Probe, probes},
    external, kinova, simulated_arm,
};
use serde::{Deserialize, Serialize, Serializer};

use super::Opener;
use crate::rig::places::{NamedPlace, Place};

/// The arm of a rig file.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FollowerSettings {
    /// `make = "kinova"`, the default: a Gen3.
    Kinova(kinova::KinovaSettings),
    /// `make = "simulated"`: no hardware.
    Simulated(simulated_arm::SimulatedArmSettings),
    /// `make = "external"`: a user's program over UDP.
    External(external::ExternalSettings),
}

impl Serialize for FollowerSettings {
    /// Serialises the settings alone, as in a rig file.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Kinova(settings) => settings.serialize(serializer),
            Self::Simulated(settings) => settings.serialize(serializer),
            Self::External(settings) => settings.serialize(serializer),
        }
    }
}

impl FollowerSettings {
    /// Makes as named in a rig file, the default first.
    pub(super) const MAKES: &[&str] = &["kinova", "simulated", "external"];
    /// Manufacturers, in the same order, for the screen.
    pub(crate) const MAKERS: &[&str] = &["Kinova", "simulated", "external"];

    /// Returns the settings if the arm is made by Kinova.
    pub const fn kinova(&self) -> Option<&kinova::KinovaSettings> {
        match self {
            Self::Kinova(settings) => Some(settings),
            Self::Simulated(_) | Self::External(_) => None,
        }
    }

    /// Returns the settings if the arm is made by Kinova.
    pub const fn kinova_mut(&mut self) -> Option<&mut kinova::KinovaSettings> {
        match self {
            Self::Kinova(settings) => Some(settings),
            Self::Simulated(_) | Self::External(_) => None,
        }
    }

    /// Returns the serial number in the rig file.
    pub(in crate::rig) fn serial(&self) -> Option<String> {
        match self {
            Self::Kinova(settings) => settings.serial_number.clone(),
            Self::Simulated(_) => None,
            Self::External(settings) => settings.serial_number.clone(),
        }
    }

    /// Returns the make for the screen, one of [`RigPart::makes`](crate::rig::RigPart::makes).
    pub(in crate::rig) const fn maker(&self) -> &'static str {
        match self {
            Self::Kinova(_) => "Kinova",
            Self::Simulated(_) => "simulated",
            Self::External(_) => "external",
        }
    }

    /// Returns whether there is no hardware; such arms cannot be swapped.
    pub(in crate::rig) const fn is_simulated(&self) -> bool {
        matches!(self, Self::Simulated(_))
    }

    /// Returns the places at which the arm is reached.
    pub(in crate::rig) fn places(&self) -> Vec<NamedPlace> {
        match self {
            Self::Kinova(settings) => vec![
                ("host", Place::tcp(&settings.host, settings.tcp_port)),
                ("udp_port", Place::udp(&settings.host, settings.udp_port)),
            ],
            Self::Simulated(_) => Vec::new(),
            Self::External(settings) => vec![("listen", Place::listens(settings.listen))],
        }
    }

    /// Checks every setting of an arm of this model.
    ///
    /// # Errors
    /// [`DeviceError::Setting`] for the first invalid one.
    pub fn check(&self, model: &ArmModel) -> Result<(), DeviceError> {
        match self {
            Self::Kinova(settings) => settings.check(),
            Self::Simulated(settings) => settings.check(model),
            Self::External(settings) => settings.check(external::ExternalKind::Arm),
        }
    }

    /// Checks that an emulated rig has an emulated arm: the arm moves the emulated world to which handle and sensor
    /// belong, and a simulated arm has no such world.
    pub(in crate::rig) fn check_emulated(&self, rig_is_emulated: bool) -> Result<(), DeviceError> {
        match self {
            Self::Kinova(_) | Self::External(_) => Ok(()),
            Self::Simulated(_) => super::not_emulated("simulated", rig_is_emulated),
        }
    }

    /// Returns the limits of position, speed and acceleration of the joints.
    pub(in crate::rig) fn joint_limits(&self, model: &ArmModel) -> JointLimits {
        match self {
            Self::Kinova(settings) => settings.joint_limits(model),
            Self::Simulated(settings) => settings.joint_limits(model),
            Self::External(settings) => settings.joint_limits(model),
        }
    }

    pub(in crate::rig) fn opener(&self, model: &ArmModel) -> Opener<Box<dyn Follower>> {
        let model = *model;
        match self.clone() {
            Self::Kinova(settings) => {
                let clearing = kinova::FaultClearing::default();
                let of_opening = clearing.clone();
                Opener {
                    driver: format!("Kinova Gen3, {}", settings.host),
                    open: Box::new(move || Ok(Box::new(kinova::open_clearing(&settings, &model, &of_opening)?))),
                    clear_faults: Some(ClearFaults::by(move || clearing.command())),
                }
            }
            Self::Simulated(settings) => Opener {
                driver: "simulated arm".to_owned(),
                open: Box::new(move || Ok(Box::new(simulated_arm::SimulatedArmDriver::open(&settings, &model)?))),
                clear_faults: None,
            },
            Self::External(settings) => Opener {
                driver: format!("external arm, {}", settings.place()),
                open: Box::new(move || Ok(Box::new(external::ExternalArm::open(&settings, &model)?))),
                clear_faults: None,
            },
        }
    }

    pub(in crate::rig) fn probe(&self, name: &str, model: &ArmModel) -> Box<dyn Probe> {
        let model = *model;
        match self.clone() {
            Self::Kinova(settings) => probes::arm(name, settings, Some(model)),
            Self::Simulated(settings) => {
                let open = move || simulated_arm::SimulatedArmDriver::open(&settings, &model);
                Box::new(DeviceProbe::new(name, "this program".to_owned(), DataTiming::Always, open))
            }
            Self::External(settings) => probes::external_arm(name, settings, model),
        }
    }
}
