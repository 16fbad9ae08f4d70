//! Settings and result of a fit.

use serde::{Deserialize, Serialize};

use super::{GravityModel, GravityRecord, GravitySource, ModelKind};
use crate::calibration::{Judgement, RecordHead, Residuals, Verdict};

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct GravityLimits {
    #[serde(rename = "least_poses")]
    pub min_poses: usize,
    #[serde(rename = "least_coverage")]
    pub min_coverage: f64,
    /// Maximum condition number of the design. 30 corresponds to a shaft tilted by about 30 degrees in all directions.
    #[serde(rename = "most_condition")]
    pub max_condition: f64,
    #[serde(rename = "most_outliers")]
    pub max_outliers: f64,
    /// Maximum mean absolute error of the force on held-out poses, N; `mae_fraction` may allow more.
    pub mae_n: f64,
    /// Maximum of the same error as a fraction of the tool's weight, if that is larger: heavy tools bend their mounts.
    #[serde(rename = "mae_share")]
    pub mae_fraction: f64,
    /// Maximum absolute error of the force on a held-out pose, N; `max_fraction` may allow more.
    pub max_n: f64,
    /// Maximum of the same error as a fraction of the tool's weight, if that is larger.
    #[serde(rename = "max_share")]
    pub max_fraction: f64,
    /// Maximum mean absolute error of the torque on held-out poses, Nm.
    pub torque_mae_nm: f64,
    #[serde(rename = "least_weight_n")]
    pub min_weight_n: f64,
    /// Minimum weight as a multiple of the poses' disagreement: a sensor that delivers no readings shows no weight.
    #[serde(rename = "least_signal")]
    pub min_signal: f64,
    /// A pose whose force deviates from the model by less than this is never an outlier, N.
    pub outlier_floor_n: f64,
}

impl Default for GravityLimits {
    fn default() -> Self {
        Self {
            // Six poses give 18 equations for the seven unknowns of the physical model.
            min_poses: 6,
            min_coverage: 0.30,
            // A condition of 30 lets noise grow thirtyfold in the weakest direction.
            max_condition: 30.0,
            max_outliers: 0.25,
            // Within the noise of a good sensor (0.01 to 0.05 N).
            mae_n: 0.05,
            // 2 % of the weight correspond to an error of the orientation of about a degree.
            mae_fraction: 0.02,
            max_n: 0.20,
            max_fraction: 0.08,
            torque_mae_nm: 0.02,
            min_weight_n: 0.05,
            // Three standard deviations.
            min_signal: 3.0,
            // The noise of the noisiest sensor that passes the check.
            outlier_floor_n: 0.10,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GravitySettings {
    /// The model to use; `None` selects the physical one, or the gain model if the poses clearly support it.
    pub model: Option<ModelKind>,
    /// +1 if the accelerometer points away from the ground at rest, -1 if it points towards it.
    pub imu_sign: i8,
    /// Mass of the tool as weighed, kg, with which the fitted mass must agree.
    pub weighed_kg: Option<f64>,
    pub limits: GravityLimits,
}

impl Default for GravitySettings {
    fn default() -> Self {
        Self { model: None, imu_sign: 1, weighed_kg: None, limits: GravityLimits::default() }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ModelFit {
    pub kind: ModelKind,
    /// The model, fitted to all poses except the outliers.
    pub model: GravityModel,
    pub force_n: Residuals,
    /// Errors of the torque, Nm, if all poses have torque.
    pub torque_nm: Option<Residuals>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GravityReport {
    pub verdict: Verdict,
    /// The reason for the verdict, one sentence for the operator.
    pub reason: String,
    /// Selected model; `None` if there are too few poses.
    pub chosen: Option<ModelKind>,
    pub poses: usize,
    pub source: GravitySource,
    /// Indices of poses that do not agree with the others, from 0; not used in the fit.
    pub outliers: Vec<usize>,
    /// Fraction of all directions of gravity within 45 degrees of a pose, 0 to 1.
    pub coverage: f64,
    /// Condition number of the design; `None` if the poses do not determine a model.
    pub condition: Option<f64>,
    /// Mass of the tool in the physical model, kg.
    pub mass_kg: Option<f64>,
    /// Centre of mass of the tool in `s1`, m.
    pub com_m: Option<[f64; 3]>,
    pub folds: usize,
    /// Change of the bias from the first pose to the last, N, if the poses disagree because of it. It is removed from the
    /// poses: the models have the bias of the last pose.
    pub drift_n: Option<f64>,
    pub fits: Vec<ModelFit>,
}

impl GravityReport {
    pub fn fit_of(&self, kind: ModelKind) -> Option<&ModelFit> {
        self.fits.iter().find(|fit| fit.kind == kind)
    }

    pub fn chosen_fit(&self) -> Option<&ModelFit> {
        self.fit_of(self.chosen?)
    }

    /// Returns the record of the chosen model; `None` without a model. `date` in ISO 8601, UTC.
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
