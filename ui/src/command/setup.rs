//! What every command that runs the loop must be told: which rig, which scene.

use clap::Args;
use nima::config::{ConfigError, Rig, Scene};

#[derive(Debug, Args)]
pub(super) struct Setup {
    /// Rig: an embedded name or a TOML file
    #[arg(long, value_name = "RIG", default_value = "simulated")]
    rig: String,
    /// Scene: an embedded name or a TOML file
    #[arg(long, value_name = "SCENE", default_value = "peg_transfer")]
    scene: String,
}

impl Default for Setup {
    fn default() -> Self {
        Self { rig: "simulated".to_owned(), scene: "peg_transfer".to_owned() }
    }
}

impl Setup {
    /// The rig as it was named.
    pub(super) fn rig(&self) -> &str {
        &self.rig
    }

    /// The scene as it was named.
    pub(super) fn scene(&self) -> &str {
        &self.scene
    }

    /// Reads and checks both.
    pub(super) fn load(&self) -> Result<(Rig, Scene), ConfigError> {
        Ok((Rig::load(&self.rig)?, Scene::load(&self.scene)?))
    }
}
