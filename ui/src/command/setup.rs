//! Arguments of every command that runs the loop: rig and scene.

use clap::Args;
use nima_machine::config::{ConfigError, RigConfig};
use nima_world::scene::Scene;

use crate::{console::start::Choice, leaving::Leave};

#[derive(Debug, Args)]
pub(super) struct Setup {
    /// Rig: built-in name or TOML file
    #[arg(long, value_name = "RIG", default_value = "simulated")]
    rig: String,
    /// Scene: built-in name or TOML file (default: `bimanual` for a rig with two arms, else `peg_transfer`)
    #[arg(long, value_name = "SCENE")]
    scene: Option<String>,
    /// End with standard input: whoever started this holds its other end
    #[arg(long, hide = true)]
    until_input_ends: bool,
}

impl Default for Setup {
    fn default() -> Self {
        Self { rig: "simulated".to_owned(), scene: None, until_input_ends: false }
    }
}

impl Setup {
    /// Of this rig and scene.
    pub(super) fn of(rig: &str, scene: Option<&str>) -> Self {
        Self { rig: rig.to_owned(), scene: scene.map(str::to_owned), until_input_ends: false }
    }

    /// The name or path of the rig.
    pub(super) fn rig(&self) -> &str {
        &self.rig
    }

    /// The name or path of the scene.
    pub(super) fn scene(&self) -> &str {
        self.scene.as_deref().unwrap_or_else(|| default_scene(&self.rig))
    }

    /// Both, as the console remembers them: files by their whole paths.
    pub(super) fn choice(&self) -> Choice {
        let whole = |name: &str| {
            let path = std::fs::canonicalize(name).ok().filter(|path| path.is_file());
            path.map_or_else(|| name.to_owned(), |path| path.display().to_string())
        };
        Choice { rig: whole(&self.rig), scene: whole(self.scene()) }
    }

    /// Requests to end the run: signals, and the end of standard input if that was requested.
    pub(super) fn leave(&self) -> anyhow::Result<Leave> {
        let leave = Leave::on_signals()?;
        if self.until_input_ends {
            leave.with_input();
        }
        Ok(leave)
    }

    /// Loads and checks both.
    pub(super) fn load(&self) -> Result<(RigConfig, Scene), ConfigError> {
        let rig = RigConfig::load(&self.rig)?;
        let scene = Scene::load(self.scene())?.mounted_at(&rig)?;
        Ok((rig, scene))
    }
}

/// The scene of a rig, by its name or path, for which none was given.
pub(super) fn default_scene(rig: &str) -> &'static str {
    // A rig that cannot be loaded is refused when it is.
    RigConfig::load(rig).map_or("peg_transfer", |rig| Scene::default_for(&rig))
}
