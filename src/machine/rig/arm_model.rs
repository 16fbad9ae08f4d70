//! The model of an arm that is not a Gen3 with seven joints, from a URDF file that the rig file names.

use std::path::{Path, PathBuf};

use nima_core::kinematics::{Arm, ArmChain, ArmError, ArmModel};
use nima_devices::DeviceError;
use serde::{Deserialize, Serialize};

use super::{ArmSet, RigSettings, Side, settings::below};
use crate::config::urdf::{ChainEnds, chain_of};

/// The `model` section of an arm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ArmModelSettings {
    /// The URDF file; a relative path begins at the rig file's folder.
    pub urdf: PathBuf,
    /// The link that is mounted at `mount`.
    pub base_link: String,
    /// The link that carries the sensor; its z points away from the arm.
    pub flange_link: String,
    /// Maximum acceleration of every joint, rad/s^2. URDF has none.
    #[serde(default = "ArmModelSettings::usual_acceleration_rad_s2")]
    pub acceleration_rad_s2: f64,
    /// The joints, as read from the file. A recorded rig contains them, so that it can be read without the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub chain: Option<ArmChain>,
}

impl ArmModelSettings {
    /// Below the published limits of the arms in `assets/arms`, because the limit of an unknown arm is unknown.
    const fn usual_acceleration_rad_s2() -> f64 {
        2.0
    }

    /// Reads the joints from the file, unless they are already known.
    ///
    /// # Errors
    /// [`DeviceError::File`] with the cause.
    pub(crate) fn read(&mut self, rig_file: &Path) -> Result<(), DeviceError> {
        if self.chain.is_some() {
            return Ok(());
        }
        let path = rig_file.parent().unwrap_or(rig_file).join(&self.urdf);
        let refused = |reason: String| DeviceError::File {
            key: "urdf".to_owned(),
            path: self.urdf.display().to_string(),
            reason,
        };
        let text = nima_files::read_text(&path, nima_files::CONFIG_MAX).map_err(|error| refused(error.to_string()))?;
        let ends = ChainEnds { base_link: &self.base_link, flange_link: &self.flange_link };
        let chain = chain_of(&text, ends, self.acceleration_rad_s2).map_err(|error| refused(error.to_string()))?;
        ArmModel::new(&chain).map_err(|error| refused(error.to_string()))?;
        self.chain = Some(chain);
        Ok(())
    }
}

impl ArmSet {
    /// Returns the model of the arm: that of its URDF, else a Gen3 with seven joints.
    ///
    /// # Errors
    /// [`ArmError`] if the URDF has not been read or does not describe an arm.
    pub fn model(&self) -> Result<ArmModel, ArmError> {
        let Some(model) = &self.model else { return Ok(ArmModel::GEN3) };
        let chain = model.chain.as_ref().ok_or(ArmError::NoModel)?;
        Ok(ArmModel::new(chain)?)
    }

    /// Returns the arm with its instrument, in its mounting.
    ///
    /// # Errors
    /// [`ArmError`] if model or mounting are invalid.
    pub fn kinematics(&self) -> Result<Arm, ArmError> {
        Ok(Arm::new(&self.mount)?.of_model(self.model()?))
    }

    pub(super) fn checked_model(&self) -> Result<ArmModel, DeviceError> {
        self.model().map_err(|error| DeviceError::Setting {
            key: "chain".to_owned(),
            value: "of the arm".to_owned(),
            allowed: error.to_string(),
        })
    }
}

impl RigSettings {
    /// Reads the URDF files of the arms, whose relative paths begin at the rig file's folder.
    pub(crate) fn read_models(&mut self, rig_file: &Path) -> Result<(), DeviceError> {
        for (set, side) in [(&mut self.right, Side::Right), (&mut self.left, Side::Left)] {
            let Some(model) = set.as_mut().and_then(|set| set.model.as_mut()) else { continue };
            model.read(rig_file).map_err(|trouble| below(&format!("{}.model", side.word()), trouble))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::{RigConfig, RigFile};

    const EXAMPLE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/arms/ur5e.toml");

    fn model(rig: &RigConfig) -> ArmModel {
        rig.devices.as_ref().unwrap().right.as_ref().unwrap().model().unwrap()
    }

    #[test]
    fn a_description_is_read_next_to_the_rig_file_and_a_recorded_rig_does_not_need_it() {
        let rig = RigConfig::load(EXAMPLE).unwrap();
        assert_eq!(model(&rig).joints(), 6);
        let text = toml::to_string(&rig).unwrap();
        assert_eq!(RigConfig::parse("in the journal".as_ref(), &text).unwrap(), rig);
    }

    #[test]
    fn a_copy_in_another_folder_still_finds_its_description() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("copy.toml");
        RigFile::of(EXAMPLE).unwrap().save(&path).unwrap();
        let copy = RigConfig::load(path.to_str().unwrap()).unwrap();
        assert_eq!(model(&copy), model(&RigConfig::load(EXAMPLE).unwrap()));
    }

    #[test]
    fn a_rig_without_its_description_is_refused_with_key_and_cause() {
        let text = std::fs::read_to_string(EXAMPLE).unwrap();
        let report = |text: &str| RigConfig::parse(EXAMPLE.as_ref(), text).map(|_| ()).unwrap_err();
        let cause = |text: &str| std::error::Error::source(&report(text)).unwrap().to_string();
        let absent = cause(&text.replace("ur5e.urdf", "ur6.urdf"));
        assert!(absent.starts_with("devices.right.model.urdf = ur6.urdf: "), "{absent}");
        let link = cause(&text.replace("tool0", "tool1"));
        assert!(link.contains("flange_link") && !link.contains('\n'), "{link}");
        let fast = cause(&text.replace("acceleration_rad_s2 = 5.0", "acceleration_rad_s2 = 500.0"));
        assert!(fast.contains("acceleration"), "{fast}");
        let mut set = RigConfig::load(EXAMPLE).unwrap().devices.unwrap().right.unwrap();
        set.model.as_mut().unwrap().chain = None;
        assert_eq!(set.model(), Err(ArmError::NoModel), "never a Gen3 by default");
    }
}
