//! Baselines from the literature compared with the program's own modes, on recordings and scenes.
//!
//! Takes [`TradeoffSource`]s of motion and force. For every source, delay and mode it returns the mean prediction error at the
//! horizon (the force rendered for time t from data up to t - D and the motion at t, compared with the force measured
//! at t) as a ratio to the error of delayed reflection, start-up included: every sample counts from the first one that
//! has a delayed force, for all modes alike, and a mode without a valid force renders none. Then the mean over the
//! sources with its 95 % confidence interval, separately for the recordings used for choosing constants, for held-out
//! recordings, and for simulated scenes. Deterministic.

mod measure;
mod present;
mod statistics;
#[cfg(test)]
mod tests;

use std::path::PathBuf;

use nima_core::impedance::{Mode, SettingsError};
use serde::Serialize;

pub use statistics::MeanInterval;

use crate::{Experiment, tradeoff::TradeoffSource};

/// Prefixes of the names of recordings that were used to choose constants, both of the program's own modes and of the
/// baselines.
pub const CHOSEN_ON: [&str; 2] = ["m1_question1a_", "m1_question1b_"];

/// The modes of the table, the best known last.
const OWN: [Mode; 5] = [Mode::Dfr, Mode::Anchored, Mode::Matched, Mode::Nima, Mode::Best];

/// The part of the material to which a source belongs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Split {
    /// A recording on which no constant was chosen.
    HeldOut,
    /// A recording on which constants were chosen.
    ChosenOn,
    Scene,
}

impl Split {
    /// All parts, most conclusive first.
    pub const ALL: [Self; 3] = [Self::HeldOut, Self::ChosenOn, Self::Scene];

    /// Returns the part to which a recording with this name (its file name without the ending) belongs.
    pub fn of_recording(name: &str) -> Self {
        if CHOSEN_ON.iter().any(|chosen| name.starts_with(chosen)) { Self::ChosenOn } else { Self::HeldOut }
    }
}

#[derive(Debug, thiserror::Error)]
pub enum BaselinesError {
    #[error("{name}: {source}")]
    Settings { name: String, source: SettingsError },
    #[error(
        "{name} has {samples} samples; a delay of {delay_ms} ms at {rate_hz} Hz needs more than {needed}; record longer or use a shorter --delay-ms"
    )]
    TooShort { name: String, samples: usize, needed: usize, delay_ms: f64, rate_hz: f64 },
    /// Reflection has no error, so no ratio can be computed.
    #[error(
        "{name}: the delayed force is never wrong at a delay of {delay_ms} ms (no force, or less than half a sample of delay); use a recording with contact or a longer --delay-ms"
    )]
    NothingToCompare { name: String, delay_ms: f64 },
}

/// The sources and settings of the study.
#[derive(Clone, Debug)]
pub struct BaselineOptions {
    /// Recordings and scenes, each with its part.
    pub sources: Vec<(TradeoffSource, Split)>,
    pub delays_s: Vec<f64>,
    /// Whether the program's own modes learn the full matrix `M`.
    pub cross_talk: bool,
    /// Files that were read.
    pub inputs: Vec<PathBuf>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BaselineRow {
    pub source: String,
    pub split: Split,
    /// The requested delay.
    pub delay_ms: f64,
    /// The delay in whole samples of the source.
    pub used_delay_ms: f64,
    pub mode: Mode,
    /// Mean prediction error at the horizon, in the unit of the source.
    pub error: f64,
    /// The same for delayed reflection.
    pub held_error: f64,
    /// `error / held_error`.
    pub ratio: f64,
}

/// One mode at one delay over all sources of one part.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BaselineMean {
    pub split: Split,
    pub delay_ms: f64,
    pub mode: Mode,
    pub sources: usize,
    /// Mean of the ratios, and its 95 % confidence interval over the sources.
    #[serde(flatten)]
    pub ratio: MeanInterval,
}

#[derive(Clone, Debug, Serialize)]
pub struct BaselineReport {
    /// Description of the interval.
    pub interval: &'static str,
    /// Prefixes of the recordings on which constants were chosen.
    pub chosen_on: [&'static str; CHOSEN_ON.len()],
    pub means: Vec<BaselineMean>,
    pub rows: Vec<BaselineRow>,
}

impl Experiment for BaselineOptions {
    const NAME: &'static str = "baselines";
    const FILES: &'static [&'static str] = &[".md", ".csv"];
    type Findings = BaselineReport;
    type Error = BaselinesError;

    fn inputs(&self) -> Vec<PathBuf> {
        self.inputs.clone()
    }

    fn run(&self, progress: &mut dyn FnMut(usize, usize, &str)) -> Result<BaselineReport, BaselinesError> {
        let mut rows = Vec::new();
        let of = self.sources.len() * self.delays_s.len();
        let mut done = 0;
        for (source, split) in &self.sources {
            for &delay_s in &self.delays_s {
                progress(done, of, &source.name);
                rows.extend(measure::measure(source, *split, delay_s, self.cross_talk)?);
                done += 1;
            }
        }
        progress(of, of, "done");
        Ok(BaselineReport { interval: statistics::WORDS, chosen_on: CHOSEN_ON, means: means(&rows), rows })
    }
}

/// Returns the modes of the table, in its order.
fn modes() -> impl Iterator<Item = Mode> {
    OWN.into_iter().chain(Mode::BASELINES)
}

fn means(rows: &[BaselineRow]) -> Vec<BaselineMean> {
    let mut means: Vec<BaselineMean> = Vec::new();
    for row in rows {
        let same = |of: &BaselineMean| {
            of.split == row.split && of.mode == row.mode && of.delay_ms.total_cmp(&row.delay_ms).is_eq()
        };
        if means.iter().any(same) {
            continue;
        }
        let of = BaselineRow::is_of(row.split, row.mode, row.delay_ms);
        let ratios: Vec<f64> = rows.iter().filter(|row| of(row)).map(|row| row.ratio).collect();
        means.push(BaselineMean {
            split: row.split,
            delay_ms: row.delay_ms,
            mode: row.mode,
            sources: ratios.len(),
            ratio: MeanInterval::of_mean(&ratios),
        });
    }
    means
}

impl BaselineRow {
    fn is_of(split: Split, mode: Mode, delay_ms: f64) -> impl Fn(&Self) -> bool {
        move |row| row.split == split && row.mode == mode && row.delay_ms.total_cmp(&delay_ms).is_eq()
    }
}
