//! A rig without passwords, for sessions and reports, which people pass on.

use nima_devices::kinova::KinovaSettings;
use nima_files::public_address;

use super::RigConfig;

impl RigConfig {
    /// Returns the rig without passwords: of arms, and in the address of the endoscope.
    #[must_use]
    pub fn without_secrets(mut self) -> Self {
        if let Some(endoscope) = &mut self.endoscope {
            endoscope.url = public_address(&endoscope.url);
        }
        let factory = KinovaSettings::default().password;
        let sets = self.devices.iter_mut().flat_map(|devices| [&mut devices.right, &mut devices.left]);
        for arm in sets.flatten().filter_map(|set| set.arm.kinova_mut()) {
            // The factory's password is in the manual.
            if arm.password != factory {
                arm.password.clear();
            }
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::EndoscopeConfig;

    #[test]
    fn a_rig_has_no_password_left_and_a_built_in_one_stays_as_it_is() {
        let mut rig = RigConfig::load("paper").unwrap();
        assert_eq!(rig.clone().without_secrets(), rig, "a built-in rig contains no secret");
        rig.endoscope =
            Some(EndoscopeConfig { url: "http://eva:s3cret@cam/".to_owned(), ..EndoscopeConfig::default() });
        let right = rig.devices.as_mut().unwrap().right.as_mut().unwrap();
        right.arm.kinova_mut().unwrap().password = "s3cret".to_owned();
        assert!(!toml::to_string(&rig.without_secrets()).unwrap().contains("s3cret"));
    }
}
