//! What is kept of a gravity calibration: the model, where it belongs and how good it was.

use serde::{Deserialize, Deserializer, Serialize, de::Error as _};

use super::GravityModel;
use crate::calibration::{Judgement, Record, RecordHead, Residuals};

/// The only kind of this record: a file of another kind is refused on reading.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GravityKind {
    /// `kind = "gravity"`.
    #[default]
    Gravity,
}

/// A gravity calibration as it is written to a file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(missing_docs, reason = "the names say it")]
pub struct GravityRecord {
    pub kind: GravityKind,
    /// What it belongs to.
    #[serde(flatten)]
    pub head: RecordHead,
    /// Whether it may be used.
    #[serde(flatten)]
    pub judgement: Judgement,
    /// Still poses it was made of.
    pub poses: usize,
    /// Poses left out as outliers, counted from 0.
    pub outliers: Vec<usize>,
    /// Share of all directions of gravity with a pose within 45 degrees, 0 to 1.
    pub coverage: f64,
    /// Condition number of the design; none when the poses determine nothing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub condition: Option<f64>,
    #[serde(deserialize_with = "sound")]
    pub model: GravityModel,
    /// Errors of the force, N.
    pub residuals: Residuals,
    /// Errors of the torque, Nm, where it was measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub torque_residuals: Option<Residuals>,
}

/// A bias that moved by less than this is not told from the temperature of a sensor that just started, N.
const DRIFT_FLOOR_N: f64 = 0.10;
/// Whatever a calibration missed: this is no rest, N.
const DRIFT_MOST_N: f64 = 0.50;

impl GravityRecord {
    /// What the force left at rest may be before the bias has moved, N: what the model missed on poses held out, and a little.
    pub fn drift_limit_n(&self) -> f64 {
        // Written so that a NaN from a file gives the narrow limit.
        (DRIFT_FLOOR_N + self.residuals.held_out.largest().max(0.0)).min(DRIFT_MOST_N)
    }
}

impl Record for GravityRecord {
    const KIND: &'static str = "gravity";

    fn head(&self) -> &RecordHead {
        &self.head
    }

    fn judgement(&self) -> &Judgement {
        &self.judgement
    }
}

/// A model from a file is refused unless it can be used as it stands.
fn sound<'de, D: Deserializer<'de>>(deserializer: D) -> Result<GravityModel, D::Error> {
    let model = GravityModel::deserialize(deserializer)?;
    model.fault().map_or(Ok(model), |fault| Err(D::Error::custom(fault)))
}
