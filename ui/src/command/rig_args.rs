//! Arguments of every command that runs the loop: rig and scene.

use clap::Args;
use nima_machine::{
    config::{ConfigError, Ranges, RigConfig},
    rig::Side,
};
use nima_panels::rig_choice::RigChoice;
use nima_simulation::scene::Scene;

use crate::{console::start::drawn_anew, shutdown::Leave};

#[derive(Debug, Args)]
pub(crate) struct Setup {
    /// Rig: built-in name or TOML file
    #[arg(long, value_name = "RIG", default_value = "simulated")]
    rig: String,
    /// Scene: built-in name or TOML file (default: `bimanual` for a rig with two arms, else `peg_transfer`)
    #[arg(long, value_name = "SCENE")]
    scene: Option<String>,
    /// Seed of the scene: positions of hidden lumps, tremor, noise (default: the scene's seed; a console draws one if lumps
    /// are hidden)
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(..=i64::MAX as u64))]
    seed: Option<u64>,
    /// End when standard input closes, for a parent process that holds its other end
    #[arg(long, hide = true)]
    until_input_ends: bool,
}

impl Default for Setup {
    fn default() -> Self {
        Self { rig: "simulated".to_owned(), scene: None, seed: None, until_input_ends: false }
    }
}

impl Setup {
    pub(super) fn of(rig: &str, scene: Option<&str>) -> Self {
        Self { rig: rig.to_owned(), scene: scene.map(str::to_owned), seed: None, until_input_ends: false }
    }

    pub(super) fn rig(&self) -> &str {
        &self.rig
    }

    pub(super) fn scene(&self) -> &str {
        self.scene.as_deref().unwrap_or_else(|| default_scene(&self.rig))
    }

    /// Returns rig and scene as the console remembers them: files by their absolute paths.
    pub(super) fn choice(&self) -> RigChoice {
        let whole = |name: &str| {
            let path = std::fs::canonicalize(name).ok().filter(|path| path.is_file());
            path.map_or_else(|| name.to_owned(), |path| path.display().to_string())
        };
        RigChoice { rig: whole(&self.rig), scene: whole(self.scene()) }
    }

    /// Requests to end the run: signals, and the end of standard input if requested.
    pub(super) fn leave(&self) -> anyhow::Result<Leave> {
        let leave = Leave::on_signals()?;
        if self.until_input_ends {
            leave.with_input();
        }
        Ok(leave)
    }

    pub(super) fn load(&self) -> Result<(RigConfig, Scene), ConfigError> {
        let rig = RigConfig::load(&self.rig)?;
        let mut scene = Scene::load(self.scene())?.mounted_at(&rig)?;
        if let Some(seed) = self.seed {
            let ranges = Ranges { kind: "scene", name: &scene.name };
            let allowed = "omitted for a rig with devices: its emulators use the scene's seed";
            ranges.check("--seed", seed as f64, rig.devices.is_none(), allowed)?;
            scene.seed = seed;
            scene.validate()?;
        }
        Ok((rig, scene))
    }

    /// Like [`Setup::load`], for a window: hidden parts of a scene change with each start, unless a seed was given.
    pub(super) fn load_for_a_trial(&self) -> Result<(RigConfig, Scene), ConfigError> {
        let (rig, scene) = self.load()?;
        let scene = if self.seed.is_none() && rig.devices.is_none() { drawn_anew(scene) } else { scene };
        Ok((rig, scene))
    }
}

/// Returns the name or path of the default scene of a rig.
pub(crate) fn default_scene(rig: &str) -> &'static str {
    // A rig that cannot be loaded is rejected later.
    RigConfig::load(rig).map_or("peg_transfer", |rig| Scene::default_for(&rig))
}

pub(crate) fn side(word: &str) -> Result<Side, String> {
    Side::ALL.into_iter().find(|side| side.word() == word).ok_or_else(|| "enter right or left".to_owned())
}
