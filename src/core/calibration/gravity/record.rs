//! Content of a gravity calibration file: the model, its devices, and its quality.

use serde::{Deserialize, Deserializer, Serialize, de::Error as _};

use super::GravityModel;
use crate::calibration::{CalibrationRecord, Judgement, RecordHead, Residuals};

/// Type of the record; a file of another kind is refused on reading.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GravityKind {
    #[default]
    Gravity,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GravityRecord {
    pub kind: GravityKind,
    #[serde(flatten)]
    pub head: RecordHead,
    #[serde(flatten)]
    pub judgement: Judgement,
    pub poses: usize,
    /// Indices of the poses left out as outliers, from 0.
    pub outliers: Vec<usize>,
    /// Fraction of all directions of gravity within 45 degrees of a pose, 0 to 1.
    pub coverage: f64,
    /// Condition number of the design; absent if the poses do not determine a model.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub condition: Option<f64>,
    #[serde(deserialize_with = "sound")]
    pub model: GravityModel,
    /// Errors of the force, N.
    pub residuals: Residuals,
    /// Errors of the torque, Nm, if the torque was measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub torque_residuals: Option<Residuals>,
}

/// A smaller change of bias cannot be distinguished from the temperature drift of a recently started sensor, N.
const DRIFT_FLOOR_N: f64 = 0.10;
/// Upper limit for any calibration, N, because a model with a larger error would otherwise excuse any bias.
const DRIFT_MAX_N: f64 = 0.50;

impl GravityRecord {
    /// Returns the limit of the force remaining at rest above which the bias has changed, N: the model's error on
    /// held-out poses plus a margin.
    pub fn drift_limit_n(&self) -> f64 {
        // Written so that NaN from a file gives the strict limit.
        (DRIFT_FLOOR_N + self.residuals.held_out.largest().max(0.0)).min(DRIFT_MAX_N)
    }
}

impl CalibrationRecord for GravityRecord {
    const KIND: &'static str = "gravity";

    fn head(&self) -> &RecordHead {
        &self.head
    }

    fn judgement(&self) -> &Judgement {
        &self.judgement
    }
}

/// Rejects a model read from a file if it is not usable.
fn sound<'de, D: Deserializer<'de>>(deserializer: D) -> Result<GravityModel, D::Error> {
    let model = GravityModel::deserialize(deserializer)?;
    model.fault().map_or(Ok(model), |fault| Err(D::Error::custom(fault)))
}
