//! Arguments of `nima study baselines`.

use clap::Args;
use nima_machine::runtime::VirtualClock;
use nima_simulation::scene::Scene;
use nima_study::{
    baselines::{BaselineOptions, Split},
    tradeoff::TradeoffSource,
};

use super::{
    ExperimentArguments,
    sources::{RATE_HZ, SourceArguments, delays_s},
};

/// Scenes with contact for the comparison without a recording (in `bimanual` the right hand does the same as in
/// `peg_transfer`), each with this many seeds, which give different hand motions.
const SCENES: [&str; 2] = ["palpation", "peg_transfer"];
const SEEDS: u64 = 4;
/// Duration of a scene, s.
const SCENE_S: f64 = 20.0;
const DELAYS_MS: [f64; 4] = [10.0, 50.0, 100.0, 300.0];

#[derive(Debug, Args)]
pub(in crate::extras::lab) struct BaselinesArguments {
    #[command(flatten)]
    sources: SourceArguments,
    /// One-way delay of the link in ms; may be repeated (default: 10, 50, 100 and 300)
    #[arg(long, value_name = "D", allow_negative_numbers = true)]
    delay_ms: Vec<f64>,
    /// Let matched and best learn the force on each axis from the motion of all axes
    #[arg(long)]
    cross_talk: bool,
}

impl ExperimentArguments for BaselinesArguments {
    type Experiment = BaselineOptions;

    fn experiment(&self) -> anyhow::Result<BaselineOptions> {
        let delays_ms = if self.delay_ms.is_empty() { &DELAYS_MS[..] } else { &self.delay_ms };
        Ok(BaselineOptions {
            sources: sources(&self.sources)?,
            delays_s: delays_s(delays_ms)?,
            cross_talk: self.cross_talk,
            inputs: self.sources.inputs(),
        })
    }
}

fn sources(asked: &SourceArguments) -> anyhow::Result<Vec<(TradeoffSource, Split)>> {
    let recorded = asked.recordings()?.into_iter().map(|source| (Split::of_recording(&source.name), source));
    let scenes = asked.scenes(&[VirtualClock::PERFECT], SCENE_S)?.into_iter().map(|source| (Split::Scene, source));
    let mut sources: Vec<_> = recorded.chain(scenes).map(|(split, source)| (source, split)).collect();
    if asked.is_empty() {
        for (name, seed) in SCENES.into_iter().flat_map(|name| (1..=SEEDS).map(move |seed| (name, seed))) {
            let scene = Scene { seed, ..Scene::load(name)? };
            let mut source = TradeoffSource::from_scene(&scene, RATE_HZ, SCENE_S);
            source.name = format!("{name} {seed}");
            sources.push((source, Split::Scene));
        }
    }
    Ok(sources)
}
