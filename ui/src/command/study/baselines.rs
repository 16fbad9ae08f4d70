//! Arguments of `nima study baselines`.

use std::path::PathBuf;

use anyhow::{Context as _, bail};
use clap::Args;
use nima_core::impedance::MAX_DELAY_S;
use nima_recording::csv::{Mapping, Recording};
use nima_study::{
    baselines::{Options, Split},
    tradeoff::Source,
};
use nima_world::scene::Scene;

use super::Asked;

/// Scenes with contact, compared on where no recording is given (in `bimanual` the right hand does what it does in `peg_transfer`),
/// each with this many seeds: hands that move differently.
const SCENES: [&str; 2] = ["palpation", "peg_transfer"];
const SEEDS: u64 = 4;
/// Duration of a scene (s) and its rate (Hz).
const SCENE_S: f64 = 20.0;
const RATE_HZ: f64 = 1000.0;
const DELAYS_MS: [f64; 4] = [10.0, 50.0, 100.0, 300.0];

#[derive(Debug, Args)]
pub(in crate::command) struct Arguments {
    /// CSV file with motion and force, as for `nima identify`; one or several
    #[arg(long, value_name = "FILE", num_args = 1..)]
    recording: Vec<PathBuf>,
    /// Other column names in the recordings, with an optional factor: `x=px_mm*0.001`
    #[arg(long, value_name = "NAME=COLUMN[*SCALE]")]
    map: Vec<String>,
    /// Scene, recorded open-loop: built-in name or TOML file; may be given several times (default: palpation and peg transfer with
    /// four seeds each, or none with --recording)
    #[arg(long, value_name = "SCENE")]
    scene: Vec<String>,
    /// One-way delay of the link in ms; may be given several times (default: 10, 50, 100 and 300)
    #[arg(long, value_name = "D", allow_negative_numbers = true)]
    delay_ms: Vec<f64>,
    /// Let the program's own modes learn the force on each axis from the motion of all axes
    #[arg(long)]
    cross_talk: bool,
}

impl Asked for Arguments {
    type Experiment = Options;

    fn experiment(&self) -> anyhow::Result<Options> {
        Ok(Options {
            sources: sources(self)?,
            delays_s: delays_s(&self.delay_ms)?,
            cross_talk: self.cross_talk,
            inputs: self.recording.iter().cloned().chain(self.scene.iter().map(PathBuf::from)).collect(),
        })
    }
}

fn delays_s(asked_ms: &[f64]) -> anyhow::Result<Vec<f64>> {
    let most_ms = MAX_DELAY_S * 1e3;
    if let Some(delay_ms) = asked_ms.iter().find(|delay_ms| !(0.0..=most_ms).contains(*delay_ms)) {
        bail!("--delay-ms {delay_ms}: the delay must lie between 0 and {most_ms} ms");
    }
    let delays_ms = if asked_ms.is_empty() { &DELAYS_MS[..] } else { asked_ms };
    Ok(delays_ms.iter().map(|ms| ms * 1e-3).collect())
}

fn sources(arguments: &Arguments) -> anyhow::Result<Vec<(Source, Split)>> {
    if !arguments.map.is_empty() && arguments.recording.is_empty() {
        bail!("--map names columns of a recording: give one with --recording");
    }
    let mapping = Mapping::parse(&arguments.map)?;
    let unit = if arguments.map.is_empty() { "N" } else { "recorded unit" };
    let mut sources = Vec::new();
    for path in &arguments.recording {
        let source = Source::from_recording(Recording::read(path, &mapping)?, unit);
        let split = Split::of_recording(&source.name);
        sources.push((source, split));
    }
    for name in &arguments.scene {
        let scene = Scene::load(name).with_context(|| format!("--scene {name}"))?;
        sources.push((Source::from_scene(&scene, RATE_HZ, SCENE_S), Split::Scene));
    }
    if sources.is_empty() {
        for (name, seed) in SCENES.into_iter().flat_map(|name| (1..=SEEDS).map(move |seed| (name, seed))) {
            let scene = Scene { seed, ..Scene::load(name)? };
            let mut source = Source::from_scene(&scene, RATE_HZ, SCENE_S);
            source.name = format!("{name} {seed}");
            sources.push((source, Split::Scene));
        }
    }
    Ok(sources)
}
