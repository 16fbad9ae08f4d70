//! The arms of a rig in a scene, and where their forces are measured. Sensors and tools belong to the rig.

use nima_machine::{
    config::{ConfigError, Ranges, RigConfig},
    rig::{ArmSet, RigSettings, SensorPlace, Side},
};

use super::Scene;

impl Scene {
    /// Returns the default built-in scene of a rig: two arms have two tasks.
    pub fn default_for(rig: &RigConfig) -> &'static str {
        if rig.devices.as_ref().is_some_and(has_both_arms) { "bimanual" } else { "peg_transfer" }
    }

    /// Returns the scene adapted to this rig: a hand for each of its arms, with the trocars from the rig file.
    ///
    /// # Errors
    /// [`ConfigError::Range`] for a scene with rings or a wire at a rig with devices: only simulated instruments touch them.
    pub fn mounted_at(self, rig: &RigConfig) -> Result<Self, ConfigError> {
        let Some(devices) = &rig.devices else { return Ok(self) };
        let rings = self.objects.as_ref().map_or(0, |objects| objects.rings.len());
        let allowed = "none on a rig with devices: only simulated instruments have jaws that hold rings";
        Ranges { kind: "scene", name: &self.name }.check("objects.rings (count)", rings as f64, rings == 0, allowed)?;
        let wires = if self.wire.is_some() { 1.0 } else { 0.0 };
        let allowed = "none on a rig with devices: only simulated instruments have loops";
        Ranges { kind: "scene", name: &self.name }.check("number of [wire]", wires, self.wire.is_none(), allowed)?;
        let mut scene = if devices.arm(Side::Left).is_some() { self.with_left_hand() } else { self };
        if let Some(set) = devices.arm(Side::Right) {
            scene.trocar_m = set.rcm.trocar_m;
        }
        if let (Some(set), Some(left)) = (devices.arm(Side::Left), &mut scene.left) {
            left.trocar_m = set.rcm.trocar_m;
        }
        Ok(scene)
    }

    /// Returns whether this rig has an arm pair on this side in this scene.
    pub fn has(&self, rig: &RigConfig, side: Side) -> bool {
        match &rig.devices {
            Some(devices) => devices.arm(side).is_some(),
            None => side == Side::Right || self.left.is_some(),
        }
    }

    /// Returns whether it has an arm pair with its force measured at the wrist.
    pub fn measures_at_wrist(&self, rig: &RigConfig, side: Side) -> bool {
        match &rig.devices {
            // Also for emulated devices: a scene without a wrist gets the paper's wrist. The force of an arm on another
            // machine is measured there.
            Some(devices) => {
                let at_wrist = |arm: &ArmSet| arm.sensor_at == SensorPlace::Wrist;
                devices.ends.have_follower() && devices.arm(side).is_some_and(at_wrist)
            }
            None => self.has(rig, side) && self.wrist.is_some(),
        }
    }
}

fn has_both_arms(devices: &RigSettings) -> bool {
    Side::ALL.into_iter().all(|side| devices.arm(side).is_some())
}

/// Older scene files contained sensor and tool: adds their new location to the error.
pub(super) fn moved_to_the_rig(error: ConfigError) -> ConfigError {
    let ConfigError::Parse { kind, path, message } = error else { return error };
    let moved = ["serial", "tool"].into_iter().find(|key| {
        // Only for keys of [wrist], which are recognised by the list of expected keys.
        message.contains(&format!("unknown field `{key}`")) && message.contains("`tool_mass_kg`")
    });
    let message = match (moved, message.split_once(": ")) {
        (Some(key), Some((line, _))) => format!(
            "{line}: wrist.{key} is now part of the rig file: delete the lines \"serial\" and \"tool\" here; a simulated rig has them in \
             [simulated.right]"
        ),
        _ => message,
    };
    ConfigError::Parse { kind, path, message }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rig_with_two_arms_has_two_hands_in_every_scene_and_its_own_trocars() {
        let [one, two] = ["simulated", "emulated"].map(|rig| RigConfig::load(rig).unwrap());
        assert_eq!([&one, &two].map(Scene::default_for), ["peg_transfer", "bimanual"]);
        let scene = Scene::load("peg_transfer").unwrap();
        assert!(scene.clone().mounted_at(&one).unwrap().left.is_none());
        let mounted = scene.mounted_at(&two).unwrap();
        let devices = two.devices.as_ref().unwrap();
        let trocars_m = Side::ALL.map(|side| mounted.of_side(side).unwrap().trocar_m);
        assert_eq!(trocars_m, Side::ALL.map(|side| devices.arm(side).unwrap().rcm.trocar_m));
        assert!((trocars_m[0] - trocars_m[1]).norm() > 0.05, "two instruments do not fit through one trocar");
        let rings = || Scene::load("rings").unwrap();
        assert!(rings().mounted_at(&one).is_ok());
        let refused = rings().mounted_at(&two).unwrap_err().to_string();
        assert!(refused.contains("objects.rings") && refused.contains("simulated"), "{refused}");
    }

    #[test]
    fn a_scene_that_names_its_sensor_is_told_where_that_belongs() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("old.toml");
        let text = include_str!("../../../config/scenes/palpation.toml");
        for key in ["serial", "tool"] {
            std::fs::write(&path, text.replace("[wrist]\n", &format!("[wrist]\n{key} = \"SIM-S1-0001\"\n"))).unwrap();
            let message = Scene::load(path.to_str().unwrap()).unwrap_err().to_string();
            let report = message.contains("line 36") && message.contains("[simulated.right]");
            assert!(report && message.contains(&format!("wrist.{key}")) && message.lines().count() == 1, "{message}");
        }
        std::fs::write(&path, text.replace("[hand]\n", "[hand]\ntool = \"SIM\"\n")).unwrap();
        let message = Scene::load(path.to_str().unwrap()).unwrap_err().to_string();
        assert!(!message.contains("[simulated.right]"), "{message}");
    }
}
