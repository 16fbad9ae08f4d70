//! The number of participants that a study needs: studies are simulated and analysed like the real one.
//!
//! ```
//! use nima_analysis::{power::{PairedTest, Population, PowerSimulation}, AnalysisError};
//!
//! // Differences of a pilot, N. How likely is it that 16 participants show a true difference of 0.4 N?
//! let pilot = [0.9, 0.6, -0.1, 2.2, 0.5, 1.1, 0.4, 1.7];
//! let population = Population::from_pilot(&pilot)?;
//! let power = PowerSimulation::default().paired(&population, 0.4, 16, PairedTest::Wilcoxon)?;
//! assert!(power.fraction > 0.4 && power.fraction < 0.7 && power.interval.contains(power.fraction));
//! # Ok::<(), AnalysisError>(())
//! ```

mod minimum;
mod paired;
mod study;

use crate::check;
use crate::distribution::normal_quantile;
use crate::error::Result;
use crate::interval::ConfidenceInterval;
use serde::Serialize;

pub use minimum::MinimumSample;
pub use paired::{PairedTest, Population};
pub use study::MixedStudy;

/// Settings of the simulated studies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PowerSimulation {
    /// Number of studies, 1 to a million.
    pub runs: usize,
    /// Seed of the first; the same seed gives the same studies.
    pub seed: u64,
    /// Significance level: a study counts as significant if its p-value is at most this.
    pub level: f64,
}

impl Default for PowerSimulation {
    fn default() -> Self {
        Self { runs: 2000, seed: 1, level: 0.05 }
    }
}

/// Fraction of the simulated studies that were significant.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Power {
    /// 0 to 1.
    #[serde(rename = "share")]
    pub fraction: f64,
    /// Wilson's interval of the fraction at 95 % confidence (Probable inference, JASA 22, 1927): the uncertainty of the
    /// simulation, not of the pilot.
    pub interval: ConfidenceInterval,
    pub runs: usize,
    /// Number of studies that could not be analysed (all differences zero, or variances without a maximum); they count
    /// as not significant.
    pub refused: usize,
}

impl PowerSimulation {
    /// Runs `study`, which returns the p-value of one simulated study, or `None` if it cannot be analysed.
    fn run(&self, mut study: impl FnMut(&mut fastrand::Rng) -> Option<f64>) -> Result<Power> {
        check::enough("simulated studies", self.runs, 1)?;
        check::not_too_many("simulated studies", self.runs, 1_000_000)?;
        check::fraction("the level of significance", self.level)?;
        let mut rng = fastrand::Rng::with_seed(self.seed);
        let mut significant = 0;
        let mut refused = 0;
        for _ in 0..self.runs {
            match study(&mut rng) {
                // Rounding must not exclude a p-value exactly at the level.
                Some(p) if p <= self.level + 1e-12 => significant += 1,
                Some(_) => {}
                None => refused += 1,
            }
        }
        let fraction = f64::from(significant) / self.runs as f64;
        Ok(Power { fraction, interval: wilson(fraction, self.runs as f64), runs: self.runs, refused })
    }
}

pub(crate) fn wilson(fraction: f64, runs: f64) -> ConfidenceInterval {
    let confidence = 0.95;
    let z = normal_quantile(f64::midpoint(1.0, confidence));
    let shrink = 1.0 + z * z / runs;
    let centre = (fraction + z * z / (2.0 * runs)) / shrink;
    let half = z / shrink * (fraction * (1.0 - fraction) / runs + z * z / (4.0 * runs * runs)).sqrt();
    ConfidenceInterval { lower: (centre - half).max(0.0), upper: (centre + half).min(1.0), confidence }
}

/// Returns a draw from the standard normal distribution.
fn normal(rng: &mut fastrand::Rng) -> f64 {
    // The middle of one of 2^52 equal steps: never 0 or 1, whose quantiles are infinite.
    let fraction = ((rng.u64(..) >> 12) as f64 + 0.5) / (1_u64 << 52) as f64;
    normal_quantile(fraction)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normal_draws_have_the_moments_of_a_normal_distribution() {
        let mut rng = fastrand::Rng::with_seed(3);
        let draws: Vec<f64> = (0..20_000).map(|_| normal(&mut rng)).collect();
        let moment = |power| draws.iter().map(|draw: &f64| draw.powi(power)).sum::<f64>() / 20_000.0;
        // Three standard errors each.
        let errors = [(1, 0.0, 1.0), (2, 1.0, 2.0), (3, 0.0, 15.0), (4, 3.0, 96.0)];
        for (power, expected, variance) in errors {
            assert!((moment(power) - expected).abs() < 3.0 * f64::sqrt(variance / 20_000.0), "{power}");
        }
    }
}
