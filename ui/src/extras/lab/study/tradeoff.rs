//! `nima study tradeoff`: computing time and accuracy for every parameter of the identification.

use std::path::PathBuf;

use clap::Args;
use nima_core::impedance::ImpedanceSettings;
use nima_simulation::scene::Scene;
use nima_study::{
    Experiment,
    tradeoff::{SweepError, SweepStudy, TradeoffPlan, TradeoffSource, sweep},
};

use super::{
    ExperimentArguments,
    clocks::StudyClocks,
    sources::{RATE_HZ, SourceArguments, delays_s},
};
use crate::shutdown::Leave;

/// Default scenes.
const SCENES: [&str; 2] = ["peg_transfer", "free_motion"];
/// Duration of a scene, s; the second constant is for `--quick`.
const SCENE_S: f64 = 10.0;
const QUICK_SCENE_S: f64 = 6.0;

#[derive(Debug, Args)]
pub(in crate::extras::lab) struct TradeoffArguments {
    #[command(flatten)]
    sources: SourceArguments,
    #[command(flatten)]
    clocks: StudyClocks,
    /// One-way delay of the link in ms; may be repeated (default: 10, 50, 100 and 300; with --quick 50)
    #[arg(long, value_name = "D", allow_negative_numbers = true)]
    delay_ms: Vec<f64>,
    /// Use fewer values of every setting, in one pass
    #[arg(long)]
    quick: bool,
}

/// The sweep over all sources; a signal ends it within milliseconds.
pub(in crate::extras::lab) struct TradeoffStudy {
    plan: TradeoffPlan,
    sources: Vec<TradeoffSource>,
    inputs: Vec<PathBuf>,
    leave: Leave,
}

impl ExperimentArguments for TradeoffArguments {
    type Experiment = TradeoffStudy;

    fn experiment(&self) -> anyhow::Result<TradeoffStudy> {
        let inputs = self.sources.inputs();
        Ok(TradeoffStudy { plan: plan(self)?, sources: sources(self)?, inputs, leave: Leave::on_signals()? })
    }
}

impl Experiment for TradeoffStudy {
    const NAME: &'static str = "tradeoff";
    const FILES: &'static [&'static str] = &[".csv"];
    type Findings = SweepStudy;
    type Error = SweepError;

    fn inputs(&self) -> Vec<PathBuf> {
        self.inputs.clone()
    }

    fn run(&self, progress: &mut dyn FnMut(usize, usize, &str)) -> Result<SweepStudy, SweepError> {
        sweep(&self.sources, &self.plan, self.leave.flag(), |done, of| progress(done, of, "points"))
    }
}

fn plan(arguments: &TradeoffArguments) -> anyhow::Result<TradeoffPlan> {
    let delays_s = delays_s(&arguments.delay_ms)?;
    let usual = ImpedanceSettings::default();
    // The base point uses the default delay if that is among the requested ones.
    let asked = delays_s.iter().copied().find(|delay_s| (delay_s - usual.delay_s).abs() < 1e-9);
    let base = ImpedanceSettings { delay_s: asked.or(delays_s.first().copied()).unwrap_or(usual.delay_s), ..usual };
    let mut plan = if arguments.quick { TradeoffPlan::quick(base) } else { TradeoffPlan::full(base) };
    if !delays_s.is_empty() {
        plan.delays_s = delays_s;
    }
    Ok(plan)
}

fn sources(arguments: &TradeoffArguments) -> anyhow::Result<Vec<TradeoffSource>> {
    let seconds = if arguments.quick { QUICK_SCENE_S } else { SCENE_S };
    let mut sources = arguments.sources.recordings()?;
    let clocks = arguments.clocks.chosen();
    sources.extend(arguments.sources.scenes(&clocks, seconds)?);
    if arguments.sources.is_empty() {
        for name in SCENES {
            let scene = Scene::load(name)?;
            sources.extend(clocks.iter().map(|clock| TradeoffSource::on_clock(*clock, &scene, RATE_HZ, seconds)));
        }
    }
    Ok(sources)
}
