//! A rig and a scene that the operator has chosen.

use nima_machine::config::RigConfig;
use nima_simulation::scene::Scene;
use serde::{Deserialize, Serialize};

/// A rig and a scene, by name or path.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct RigChoice {
    /// Name of an embedded rig, or the path of a file.
    pub rig: String,
    /// Name of a built-in scene, or the path of a file.
    pub scene: String,
}

impl Default for RigChoice {
    fn default() -> Self {
        Self { rig: "simulated".to_owned(), scene: "peg_transfer".to_owned() }
    }
}

/// Number of choices that are remembered.
const RECENT_MAX: usize = 5;

impl RigChoice {
    /// Selects another rig. The scene stays, unless it was specific to the previous rig, or the new one has a real arm, for
    /// which no scene is chosen.
    #[must_use]
    pub fn with_rig(&self, rig: &str) -> Self {
        let default = |rig: &str| RigConfig::load(rig).map(|rig| Scene::default_for(&rig)).ok();
        let untouched = default(&self.rig) == Some(self.scene.as_str());
        let own = untouched || RigConfig::load(rig).is_ok_and(|rig| has_real_arm(&rig));
        let scene = default(rig).filter(|_| own).map_or_else(|| self.scene.clone(), str::to_owned);
        Self { rig: rig.to_owned(), scene }
    }

    /// Puts this choice in front of earlier ones.
    pub fn remember(&self, recent: &mut Vec<Self>) {
        recent.retain(|choice| choice != self);
        recent.insert(0, self.clone());
        recent.truncate(RECENT_MAX);
    }
}

/// Returns whether the arm is real: then the instrument works on a real field, not in a scene.
pub fn has_real_arm(rig: &RigConfig) -> bool {
    rig.devices.as_ref().is_some_and(|devices| !devices.emulated)
}
