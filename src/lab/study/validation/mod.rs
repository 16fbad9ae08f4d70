//! The paper's three validations, in simulation: the paper's results, those of this project, and the reasons for the
//! differences.

pub mod experiment;
pub mod isolation;
pub mod paper;
pub mod rendering;
mod table;

use nalgebra::Vector3;
use nima_core::{calibration::AxisStats, impedance::SettingsError};
use nima_machine::{config::ConfigError, runtime::VirtualClock};
use nima_recording::tip_force::TipForceError;
use rendering::ValidationRendering;
use serde::Serialize;

pub use table::ValidationRow;

use crate::validation::isolation::Isolation;

/// Why a validation could not run.
#[derive(Debug, thiserror::Error)]
pub enum ValidationError {
    #[error(transparent)]
    Config(#[from] ConfigError),
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// A calibration on the simulated rig failed.
    #[error("the simulated calibration failed: {0}; try another --seed")]
    Calibration(String),
    #[error(transparent)]
    TipForce(#[from] TipForceError),
    /// The release study failed.
    #[error(transparent)]
    Release(#[from] crate::release::ReleaseError),
    #[error("cannot store the simulated session")]
    Scratch(#[source] std::io::Error),
}

#[derive(Clone, Debug)]
pub struct ValidationOptions {
    /// Seed of every scene and of the training.
    pub seed: u64,
    /// Clocks of the loop in Validation III, in the order of the table.
    pub clocks: Vec<VirtualClock>,
    /// Rows of the training session.
    pub rows: usize,
    /// Delay of the link in Validation III, s.
    pub delay_s: f64,
}

/// Validation I: agreement of the two sensors after the correspondence, on pushes that were not used for the fit.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct ValidationAgreement {
    /// Error per axis, sample by sample, N (`s1`).
    pub error_n: AxisStats,
    /// Coefficient of determination of all axes together.
    pub r2: f64,
    pub samples: usize,
}

#[derive(Clone, Debug, Serialize)]
pub struct ValidationReport {
    pub correspondence: ValidationAgreement,
    pub isolation: Isolation,
    /// Validation III, for each clock.
    pub rendering: Vec<ValidationRendering>,
    /// The paper's results and those of this project.
    pub table: Vec<ValidationRow>,
}

/// Duration of the pushes that Validation I uses, s.
const PUSHES_S: f64 = 60.0;

/// Runs the validations; `progress` is called with the number of parts done, their total, and the name of the next. Validation III is
/// run on each clock.
///
/// # Errors
/// [`ValidationError`] if a scene or setting is invalid, a calibration fails, or the network cannot be trained.
pub fn study(
    options: &ValidationOptions,
    mut progress: impl FnMut(usize, usize, &str),
) -> Result<ValidationReport, ValidationError> {
    let all = 2 + options.clocks.len();
    progress(0, all, "correspondence");
    let gravity = experiment::gravity(options.seed)?;
    let correspondence = agreement(&experiment::correspondence(&gravity, options.seed, PUSHES_S)?.unseen_s1_n);
    progress(1, all, "tip force through the trocar");
    let isolation = isolation::study(options.seed, options.rows)?;
    let mut rendering = Vec::new();
    for clock in &options.clocks {
        progress(2 + rendering.len(), all, "rendering");
        rendering.push(rendering::study(*clock, options.seed, options.delay_s)?);
    }
    progress(all, all, "");
    let table = table::rows(&correspondence, &isolation, &rendering);
    Ok(ValidationReport { correspondence, isolation, rendering, table })
}

fn agreement(pairs: &[[Vector3<f64>; 2]]) -> ValidationAgreement {
    let count = pairs.len().max(1) as f64;
    let mean_n = pairs.iter().map(|[wrist_n, _]| wrist_n).sum::<Vector3<f64>>() / count;
    let squares =
        |of: &dyn Fn(&[Vector3<f64>; 2]) -> Vector3<f64>| pairs.iter().map(|p| of(p).norm_squared()).sum::<f64>();
    let varied = squares(&|[wrist_n, _]| wrist_n - mean_n);
    let unexplained = squares(&|[wrist_n, tissue_n]| wrist_n - tissue_n);
    ValidationAgreement {
        error_n: AxisStats::of(pairs.iter().map(|[wrist_n, tissue_n]| wrist_n - tissue_n)),
        r2: if varied > 0.0 { 1.0 - unexplained / varied } else { 0.0 },
        samples: pairs.len(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_study_fills_every_row_and_separates_friction_from_tissue() {
        let options = ValidationOptions { seed: 5, clocks: vec![VirtualClock::PERFECT], rows: 4000, delay_s: 0.05 };
        let report = study(&options, |_, _, _| {}).unwrap();
        assert!(report.table.iter().all(|row| row.ours.iter().all(|value| value.is_finite())), "{:?}", report.table);
        assert!(report.correspondence.r2 > 0.95, "{:?}", report.correspondence);
        let worst = |reached: &isolation::NetworkErrors, method: usize| {
            let stats = reached.truth.methods[method].outputs.iter();
            stats.map(|stats| stats.map_or(f64::INFINITY, |stats| stats.mae)).fold(0.0, f64::max)
        };
        let ours = &report.isolation.our_inputs;
        assert!(worst(ours, 0) < 0.10, "network {}", worst(ours, 0));
        assert!(4.0 * worst(ours, 0) < worst(ours, 1), "no model {}", worst(ours, 1));
        let foreign = &report.isolation.foreign;
        assert!(foreign[..2].iter().all(|set| set.rows > 100 && set.flagged > 0.95), "{foreign:?}");
    }
}
