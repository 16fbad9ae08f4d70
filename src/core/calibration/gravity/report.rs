//! What a fit is asked for and what it answers.

use serde::{Deserialize, Serialize};

use super::{GravityModel, GravityRecord, ModelKind, Source};
use crate::calibration::{Judgement, RecordHead, Residuals, Verdict};

/// Limits of the verdict.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Limits {
    /// Fewest poses left after outliers.
    pub least_poses: usize,
    /// Smallest coverage, 0 to 1.
    pub least_coverage: f64,
    /// Largest condition number of the design. 30 is a shaft tilted by about 30 degrees all round.
    pub most_condition: f64,
    /// Largest share of poses left out as outliers.
    pub most_outliers: f64,
    /// Largest mean absolute error of the force on held-out poses, N ...
    pub mae_n: f64,
    /// ... or this share of the tool's weight, whichever is more: heavy tools bend mounts.
    pub mae_share: f64,
    /// Largest absolute error of the force on a held-out pose, N ...
    pub max_n: f64,
    /// ... or this share of the tool's weight, whichever is more.
    pub max_share: f64,
    /// Largest mean absolute error of the torque on held-out poses, Nm.
    pub torque_mae_nm: f64,
    /// Least weight of the tool, N ...
    pub least_weight_n: f64,
    /// ... and in multiples of what the poses disagree by: a sensor that sends no readings has no weight.
    pub least_signal: f64,
    /// A pose whose force is within this of the model is never an outlier, N.
    pub outlier_floor_n: f64,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            least_poses: 6,
            least_coverage: 0.30,
            most_condition: 30.0,
            most_outliers: 0.25,
            mae_n: 0.05,
            mae_share: 0.02,
            max_n: 0.20,
            max_share: 0.08,
            torque_mae_nm: 0.02,
            least_weight_n: 0.05,
            least_signal: 3.0,
            outlier_floor_n: 0.10,
        }
    }
}

/// How to fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// The model to use; `None` takes the physical one, or the gain where the poses clearly support it.
    pub model: Option<ModelKind>,
    /// +1 when the accelerometer reads the support at rest, -1 when it reads towards gravity.
    pub imu_sign: i8,
    /// Limits of the verdict.
    pub limits: Limits,
}

impl Default for Settings {
    fn default() -> Self {
        Self { model: None, imu_sign: 1, limits: Limits::default() }
    }
}

/// One fitted model and its errors.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ModelFit {
    /// Determines what the parameters mean.
    pub kind: ModelKind,
    /// Fitted on all poses but the outliers.
    pub model: GravityModel,
    /// Errors of the force, N.
    pub force_n: Residuals,
    /// Errors of the torque, Nm, where all poses have it.
    pub torque_nm: Option<Residuals>,
}

/// The answer of a fit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GravityReport {
    /// Whether the chosen model may be used.
    pub verdict: Verdict,
    /// One sentence for the operator: what led to the verdict.
    pub reason: String,
    /// The chosen model; `None` when there are too few poses for it.
    pub chosen: Option<ModelKind>,
    /// Poses given.
    pub poses: usize,
    /// Where their orientation comes from.
    pub source: Source,
    /// Poses left out because they do not agree with the others, counted from 0.
    pub outliers: Vec<usize>,
    /// Share of all directions of gravity with a pose within 45 degrees, 0 to 1.
    pub coverage: f64,
    /// Condition number of the design; `None` when the poses determine nothing.
    pub condition: Option<f64>,
    /// Mass on the sensor by the physical model, kg.
    pub mass_kg: Option<f64>,
    /// Its centre in `s1`, m.
    pub com_m: Option<[f64; 3]>,
    /// Parts of the poses held out in turn.
    pub folds: usize,
    /// All models that could be fitted.
    pub fits: Vec<ModelFit>,
}

impl GravityReport {
    /// The fit of one model.
    pub fn fit_of(&self, kind: ModelKind) -> Option<&ModelFit> {
        self.fits.iter().find(|fit| fit.kind == kind)
    }

    /// The fit of the chosen model.
    pub fn chosen_fit(&self) -> Option<&ModelFit> {
        self.fit_of(self.chosen?)
    }

    /// The record of the chosen model; `None` when there is none. `date` in ISO 8601, UTC.
    pub fn record(&self, sensor: &str, tool: &str, date: &str) -> Option<GravityRecord> {
        let fit = self.chosen_fit()?;
        Some(GravityRecord {
            kind: super::GravityKind::Gravity,
            head: RecordHead::new(sensor, tool, date),
            judgement: Judgement::new(self.verdict, self.reason.clone()),
            poses: self.poses,
            outliers: self.outliers.clone(),
            coverage: self.coverage,
            condition: self.condition,
            model: fit.model,
            residuals: fit.force_n,
            torque_residuals: fit.torque_nm,
        })
    }
}
