//! Arguments of `nima study hands`.

use clap::Args;
use nima_study::hands::HandOptions;

use super::{ExperimentArguments, clocks::StudyClocks};

#[derive(Debug, Args)]
pub(in crate::extras::lab) struct HandsStudy {
    /// Number of simulated hands of each kind, for each clock
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u64).range(1..=100_000))]
    hands: u64,
    /// Time for which each hand holds the handle, s
    #[arg(long, value_name = "S", default_value_t = 20.0, value_parser = seconds)]
    seconds: f64,
    /// Number of releases at each force, for each clock
    #[arg(long, value_name = "N", default_value_t = 60, value_parser = clap::value_parser!(u64).range(1..=100_000))]
    releases: u64,
    /// Seed of the simulated hands
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    clocks: StudyClocks,
}

fn seconds(text: &str) -> Result<f64, String> {
    let seconds = text.parse::<f64>().ok().filter(|seconds| (1.0..=3600.0).contains(seconds));
    seconds.ok_or_else(|| "enter a time from 1 to 3600 s".to_owned())
}

impl ExperimentArguments for HandsStudy {
    type Experiment = HandOptions;

    fn experiment(&self) -> anyhow::Result<HandOptions> {
        let Self { hands, seconds, releases, seed, .. } = *self;
        Ok(HandOptions { clocks: self.clocks.chosen(), hands, seconds, releases, seed })
    }
}
