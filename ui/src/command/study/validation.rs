//! Arguments of `nima study validation`.

use clap::Args;
use nima_core::impedance::MAX_DELAY_S;
use nima_recording::tip_force::MOST_ROWS;
use nima_study::validation::{Options, isolation::ROWS};

use super::Asked;

#[derive(Debug, Args)]
pub(in crate::command) struct Validation {
    /// Seed of the simulated rig and of the training
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Rows to train the tip force on
    #[arg(long, value_name = "N", default_value_t = ROWS, value_parser = rows)]
    rows: usize,
    /// Delay of the link in the rendering part, ms
    #[arg(long, value_name = "D", default_value_t = 300.0, value_parser = delay_ms)]
    delay_ms: f64,
}

fn rows(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(rows @ 2000..=MOST_ROWS) => Ok(rows),
        _ => Err(format!("give a number of rows from 2000 to {MOST_ROWS}")),
    }
}

fn delay_ms(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(delay_ms) if (0.0..=1e3 * MAX_DELAY_S).contains(&delay_ms) => Ok(delay_ms),
        _ => Err(format!("give a delay from 0 to {:.0} ms", 1e3 * MAX_DELAY_S)),
    }
}

impl Asked for Validation {
    type Experiment = Options;

    fn experiment(&self) -> anyhow::Result<Options> {
        Ok(Options { seed: self.seed, rows: self.rows, delay_s: 1e-3 * self.delay_ms })
    }
}
