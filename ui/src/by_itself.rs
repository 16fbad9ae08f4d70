//! Decides whether a loop engages automatically at its start. No other place decides it.
//!
//! Force is dangerous, so a person engages. There are two exceptions, both without a real device that renders force or moves:
//! - the window, on the built-in rigs `simulated` and `emulated`, so that a newcomer sees them run. A rig file belongs to a
//!   user, whatever its content: it waits for its ready check and for **Engage**;
//! - `nima run`, because it is a command to run this rig, without a person at a screen.
//!
//! Every other command starts an idle loop. An arm at another machine may be real, whatever the local rig is. `Plan` ignores
//! a request to engage on a rig with real devices.

use nima_machine::config::RigConfig;

/// Rigs that the window engages.
const BUILT_IN: [&str; 2] = ["simulated", "emulated"];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Starter {
    Window,
    Run,
}

/// Location of the rig's arm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ArmLocation {
    Here,
    /// A `nima follower` on this machine, to try out the two-machine setup.
    Loopback,
    Elsewhere,
}

/// Returns whether the loop of this rig, loaded by this name or path, engages automatically.
pub(crate) fn engages(starter: Starter, name: &str, rig: &RigConfig, arm: ArmLocation) -> bool {
    let may = match (starter, arm) {
        (Starter::Window, ArmLocation::Here) => BUILT_IN.contains(&name),
        (Starter::Run, ArmLocation::Here | ArmLocation::Loopback) => true,
        (Starter::Window, ArmLocation::Loopback | ArmLocation::Elsewhere) | (Starter::Run, ArmLocation::Elsewhere) => {
            false
        }
    };
    may && rig.is_harmless()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn engaging(starter: Starter, arm: ArmLocation, names: &[String]) -> Vec<String> {
        let engages = |name: &&String| engages(starter, name, &RigConfig::load(name).unwrap(), arm);
        names.iter().filter(engages).cloned().collect()
    }

    #[test]
    fn the_window_engages_two_built_in_rigs_and_no_file() {
        let folder = tempfile::tempdir().unwrap();
        let built_in: Vec<String> = RigConfig::names().map(str::to_owned).collect();
        let file = |(name, text): (&str, &str)| {
            let path = folder.path().join(name);
            std::fs::write(&path, text).unwrap();
            path.display().to_string()
        };
        let emulated = include_str!("../../config/rigs/emulated.toml");
        let files: Vec<String> = [
            ("simulated.toml", include_str!("../../config/rigs/simulated.toml")),
            ("emulated.toml", emulated),
            ("at_tip.toml", &emulated.replace("sensor_at = \"wrist\"", "sensor_at = \"tip\"")),
            ("desk.toml", include_str!("../../config/rigs/desk.toml")),
            ("paper.toml", include_str!("../../config/rigs/paper.toml")),
        ]
        .map(file)
        .into();
        assert_eq!(engaging(Starter::Window, ArmLocation::Here, &built_in), ["simulated", "emulated"]);
        assert_eq!(engaging(Starter::Window, ArmLocation::Here, &files), [""; 0]);
        // For rigs that cannot hurt anyone, the command `nima run` is enough.
        assert_eq!(engaging(Starter::Run, ArmLocation::Here, &built_in), ["simulated", "desk", "emulated"]);
        assert_eq!(engaging(Starter::Run, ArmLocation::Here, &files), files[..4]);
    }

    #[test]
    fn an_arm_at_another_machine_may_be_a_real_one() {
        let simulated = ["simulated".to_owned()];
        for arm in [ArmLocation::Loopback, ArmLocation::Elsewhere] {
            assert_eq!(engaging(Starter::Window, arm, &simulated), [""; 0]);
        }
        assert_eq!(engaging(Starter::Run, ArmLocation::Loopback, &simulated), simulated);
        assert_eq!(engaging(Starter::Run, ArmLocation::Elsewhere, &simulated), [""; 0]);
    }
}
