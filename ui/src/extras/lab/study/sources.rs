//! Inputs of an identification study: recordings and scenes.

use std::path::PathBuf;

use anyhow::{Context as _, bail};
use clap::Args;
use nima_core::limits::DELAY_S;
use nima_machine::{rig::Side, runtime::VirtualClock};
use nima_recording::csv::ColumnMapping;
use nima_simulation::scene::Scene;
use nima_study::tradeoff::TradeoffSource;

use crate::{command::rig_args::side, extras::lab::recording_input};

/// Rate of a scene, Hz.
pub(super) const RATE_HZ: f64 = 1000.0;

#[derive(Debug, Args)]
pub(super) struct SourceArguments {
    /// CSV file with motion and force, or session, as for `nima identify`; may be repeated
    #[arg(long, value_name = "FILE", num_args = 1..)]
    recording: Vec<PathBuf>,
    /// Arm of the sessions, right or left (required if a session has both)
    #[arg(long, value_name = "ARM", value_parser = side)]
    arm: Option<Side>,
    /// Column of a quantity that has another name in the recordings, with an optional factor: `x=px_mm*0.001`
    #[arg(long, value_name = "NAME=COLUMN[*SCALE]")]
    map: Vec<String>,
    /// Scene, recorded open-loop: built-in name or TOML file; may be repeated (default: scenes of this study, or none
    /// with --recording)
    #[arg(long, value_name = "SCENE")]
    scene: Vec<String>,
}

impl SourceArguments {
    /// Returns whether neither a recording nor a scene is given.
    pub(super) fn is_empty(&self) -> bool {
        self.recording.is_empty() && self.scene.is_empty()
    }

    /// Returns the files that are read; results must not overwrite them.
    pub(super) fn inputs(&self) -> Vec<PathBuf> {
        self.recording.iter().cloned().chain(self.scene.iter().map(PathBuf::from)).collect()
    }

    pub(super) fn recordings(&self) -> anyhow::Result<Vec<TradeoffSource>> {
        if !self.map.is_empty() && self.recording.is_empty() {
            bail!("--map requires a recording: add --recording");
        }
        if self.arm.is_some() && self.recording.is_empty() {
            bail!("--arm requires a session: add --recording SESSION");
        }
        let mapping = ColumnMapping::parse(&self.map)?;
        let forces = ["fx_n", "fy_n", "fz_n"];
        let unit = if forces.into_iter().any(|force| mapping.names(force)) { "recorded unit" } else { "N" };
        let read = |path: &PathBuf| {
            Ok(TradeoffSource::from_recording(recording_input::read(path, &self.map, self.arm)?, unit))
        };
        self.recording.iter().map(read).collect()
    }

    /// Returns the given scenes, each for this duration (s), on each of these clocks.
    pub(super) fn scenes(&self, clocks: &[VirtualClock], seconds: f64) -> anyhow::Result<Vec<TradeoffSource>> {
        let load = |name: &String| Scene::load(name).with_context(|| format!("--scene {name}"));
        let scenes = self.scene.iter().map(load).collect::<anyhow::Result<Vec<_>>>()?;
        let on = |scene| clocks.iter().map(move |clock| TradeoffSource::on_clock(*clock, scene, RATE_HZ, seconds));
        Ok(scenes.iter().flat_map(on).collect())
    }
}

/// Returns the delays in seconds from `--delay-ms`, all within the range of the link.
pub(super) fn delays_s(asked_ms: &[f64]) -> anyhow::Result<Vec<f64>> {
    let limits_ms = DELAY_S.per(1e-3, "ms");
    if let Some(delay_ms) = asked_ms.iter().find(|delay_ms| !limits_ms.contains(**delay_ms)) {
        bail!("--delay-ms {delay_ms}: enter {limits_ms}");
    }
    Ok(asked_ms.iter().map(|ms| ms * 1e-3).collect())
}
