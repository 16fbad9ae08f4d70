//! Arguments of `nima study validation`.

use std::path::PathBuf;

use clap::Args;
use nima_core::limits::DELAY_S;
use nima_machine::rig::Side;
use nima_recording::tip_force::MAX_ROWS;
use nima_study::validation::{ValidationOptions, isolation::ROWS, paper};

use super::{ExperimentArguments, Results, clocks::StudyClocks};
use crate::{command::rig_args::side, extras::lab::recording_input};

#[derive(Debug, Args)]
pub(in crate::extras::lab) struct Validation {
    /// Seed of the simulated rig and of the training
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Rows to train the tip force on
    #[arg(long, value_name = "N", default_value_t = ROWS, value_parser = rows, conflicts_with = "paper")]
    rows: usize,
    /// Delay of the link in the rendering part, ms
    #[arg(long, value_name = "D", default_value_t = 300.0, value_parser = delay_ms, conflicts_with = "paper")]
    delay_ms: f64,
    #[command(flatten)]
    clocks: StudyClocks,
    /// Run only the rendering part, on the perfect clock, under the paper's conditions and under others: in its window,
    /// at the prediction horizon, and when the hand releases the handle
    #[arg(long, conflicts_with_all = ["clock", "clock_seed"])]
    paper: bool,
    /// Duration of the task under each condition, s
    #[arg(long, value_name = "S", default_value_t = paper::SECONDS, value_parser = seconds, requires = "paper")]
    seconds: f64,
    /// CSV file with motion and force, or session, as for `nima identify`, to evaluate too; may be repeated
    #[arg(long, value_name = "FILE", requires = "paper")]
    recording: Vec<PathBuf>,
    /// Arm of the sessions, right or left (required if a session has both)
    #[arg(long, value_name = "ARM", value_parser = side, requires = "recording")]
    arm: Option<Side>,
    /// Column of a quantity that has another name in the recordings, with an optional factor: `x=px_mm*0.001`
    #[arg(long, value_name = "NAME=COLUMN[*SCALE]", requires = "recording")]
    map: Vec<String>,
}

fn rows(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(rows @ 2000..=MAX_ROWS) => Ok(rows),
        _ => Err(format!("enter a number of rows from 2000 to {MAX_ROWS}")),
    }
}

fn seconds(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(seconds) if (5.0..=3600.0).contains(&seconds) => Ok(seconds),
        _ => Err("enter a duration from 5 to 3600 s".to_owned()),
    }
}

fn delay_ms(text: &str) -> Result<f64, String> {
    let limits = DELAY_S.per(1e-3, "ms");
    let delay_ms = text.parse::<f64>().ok().filter(|delay_ms| limits.contains(*delay_ms));
    delay_ms.ok_or_else(|| format!("enter a delay from {limits}"))
}

impl ExperimentArguments for Validation {
    type Experiment = ValidationOptions;

    fn experiment(&self) -> anyhow::Result<ValidationOptions> {
        Ok(ValidationOptions {
            seed: self.seed,
            clocks: self.clocks.chosen(),
            rows: self.rows,
            delay_s: 1e-3 * self.delay_ms,
        })
    }

    fn carry_out(&self, results: &Results) -> anyhow::Result<()> {
        if !self.paper {
            return results.of(&self.experiment()?);
        }
        let read = |path: &PathBuf| recording_input::read(path, &self.map, self.arm);
        let recordings = self.recording.iter().map(read).collect::<Result<_, _>>()?;
        results.of(&paper::PaperOptions { seed: self.seed, seconds: self.seconds, recordings })
    }
}
