//! `nima console`: the window over a running loop.

use std::{path::PathBuf, time::Duration};

use clap::Args;
use nima::{
    config::{Rig, Scene},
    runtime::{self, Plan},
};

use crate::console::{self, Options};

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Rig: an embedded name or a TOML file
    #[arg(long, value_name = "RIG", default_value = "simulated")]
    rig: String,
    /// Scene: an embedded name or a TOML file
    #[arg(long, value_name = "SCENE", default_value = "peg_transfer")]
    scene: String,
    /// Close after this many seconds
    #[arg(long, value_name = "S", value_parser = super::run::positive_seconds)]
    exit_after: Option<f64>,
    /// Save a picture of the window (PNG) just before closing; needs --exit-after
    #[arg(long, value_name = "FILE", requires = "exit_after")]
    screenshot: Option<PathBuf>,
}

impl Default for Arguments {
    fn default() -> Self {
        Self { rig: "simulated".to_owned(), scene: "peg_transfer".to_owned(), exit_after: None, screenshot: None }
    }
}

pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let rig = Rig::load(&arguments.rig)?;
    let scene = Scene::load(&arguments.scene)?;
    // The simulated hand cannot be hurt: the demo runs at once.
    let handle = runtime::start(&Plan { rig: rig.clone(), scene: scene.clone(), engage: true })?;
    let options = Options {
        exit_after: arguments.exit_after.map(Duration::from_secs_f64),
        screenshot: arguments.screenshot.clone(),
    };
    console::run(handle, rig, scene, options)
}
