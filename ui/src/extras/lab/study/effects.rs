//! `nima study effects`.

use clap::Args;
use nima_study::effects::Effects;

use super::ExperimentArguments;
use crate::command::run::positive_seconds;

#[derive(Debug, Args)]
pub(in crate::extras::lab) struct EffectsArguments {
    /// Scenes, built-in name or TOML file; may be repeated (default: all built-in scenes)
    #[arg(long, value_name = "SCENE")]
    scene: Vec<String>,
    /// Length of the motion, s
    #[arg(long, value_name = "S", value_parser = positive_seconds, default_value = "20")]
    seconds: f64,
}

impl ExperimentArguments for EffectsArguments {
    type Experiment = Effects;

    fn experiment(&self) -> anyhow::Result<Effects> {
        Ok(Effects { scenes: self.scene.clone(), seconds: self.seconds })
    }
}
