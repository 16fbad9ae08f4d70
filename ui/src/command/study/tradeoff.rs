//! `nima study tradeoff`: computing time and accuracy for every parameter of the identification.

use std::path::PathBuf;

use anyhow::bail;
use clap::Args;
use nima_core::impedance::{MAX_DELAY_S, Settings};
use nima_recording::csv::{Mapping, Recording};
use nima_study::{
    Experiment,
    tradeoff::{Plan, Source, Study, SweepError, sweep},
};
use nima_world::scene::Scene;

use super::Asked;
use crate::leaving::Leave;

/// Scenes that are measured by default.
const SCENES: [&str; 2] = ["peg_transfer", "free_motion"];
/// Duration of a scene, s; the second constant is for `--quick`.
const SCENE_S: f64 = 10.0;
const QUICK_SCENE_S: f64 = 6.0;
const RATE_HZ: f64 = 1000.0;

#[derive(Debug, Args)]
pub(in crate::command) struct Arguments {
    /// CSV file with motion and force, as for `nima identify`; may be given several times
    #[arg(long, value_name = "FILE")]
    recording: Vec<PathBuf>,
    /// Other column names in the recordings, with an optional factor: `x=px_mm*0.001`
    #[arg(long, value_name = "NAME=COLUMN[*SCALE]")]
    map: Vec<String>,
    /// Scene, recorded open-loop: built-in name or TOML file; may be given several times (default: all built-in scenes, or none with --recording)
    #[arg(long, value_name = "SCENE")]
    scene: Vec<String>,
    /// One-way delay of the link in ms; may be given several times (default: 10, 50, 100 and 300; with --quick 50)
    #[arg(long, value_name = "D", allow_negative_numbers = true)]
    delay_ms: Vec<f64>,
    /// Fewer values of every setting, one pass
    #[arg(long)]
    quick: bool,
}

/// The sweep over all sources; a signal ends it within milliseconds.
pub(in crate::command) struct Tradeoff {
    plan: Plan,
    sources: Vec<Source>,
    inputs: Vec<PathBuf>,
    leave: Leave,
}

impl Asked for Arguments {
    type Experiment = Tradeoff;

    fn experiment(&self) -> anyhow::Result<Tradeoff> {
        let inputs = self.recording.iter().cloned().chain(self.scene.iter().map(PathBuf::from)).collect();
        Ok(Tradeoff { plan: plan(self)?, sources: sources(self)?, inputs, leave: Leave::on_signals()? })
    }
}

impl Experiment for Tradeoff {
    const NAME: &'static str = "tradeoff";
    const FILES: &'static [&'static str] = &[".csv"];
    type Findings = Study;
    type Error = SweepError;

    fn inputs(&self) -> Vec<PathBuf> {
        self.inputs.clone()
    }

    fn run(&self, progress: &mut dyn FnMut(usize, usize, &str)) -> Result<Study, SweepError> {
        sweep(&self.sources, &self.plan, self.leave.flag(), |done, of| progress(done, of, "points"))
    }
}

fn plan(arguments: &Arguments) -> anyhow::Result<Plan> {
    let most_ms = MAX_DELAY_S * 1e3;
    if let Some(delay_ms) = arguments.delay_ms.iter().find(|delay_ms| !(0.0..=most_ms).contains(*delay_ms)) {
        bail!("--delay-ms {delay_ms}: the delay must lie between 0 and {most_ms} ms");
    }
    let delays_s: Vec<f64> = arguments.delay_ms.iter().map(|ms| ms * 1e-3).collect();
    let usual = Settings::default();
    // The base point uses the default delay if that is among the requested ones.
    let asked = delays_s.iter().copied().find(|delay_s| (delay_s - usual.delay_s).abs() < 1e-9);
    let base = Settings { delay_s: asked.or(delays_s.first().copied()).unwrap_or(usual.delay_s), ..usual };
    let mut plan = if arguments.quick { Plan::quick(base) } else { Plan::full(base) };
    if !delays_s.is_empty() {
        plan.delays_s = delays_s;
    }
    Ok(plan)
}

fn sources(arguments: &Arguments) -> anyhow::Result<Vec<Source>> {
    let mapping = Mapping::parse(&arguments.map)?;
    if !arguments.map.is_empty() && arguments.recording.is_empty() {
        bail!("--map names columns of a recording: give one with --recording");
    }
    let unit =
        if ["fx_n", "fy_n", "fz_n"].into_iter().any(|force| mapping.names(force)) { "recorded unit" } else { "N" };
    let mut sources = Vec::new();
    for path in &arguments.recording {
        sources.push(Source::from_recording(Recording::read(path, &mapping)?, unit));
    }
    let all = SCENES.map(str::to_owned);
    let scenes = if arguments.scene.is_empty() && sources.is_empty() { &all[..] } else { &arguments.scene[..] };
    let seconds = if arguments.quick { QUICK_SCENE_S } else { SCENE_S };
    for name in scenes {
        sources.push(Source::from_scene(&Scene::load(name)?, RATE_HZ, seconds));
    }
    Ok(sources)
}
