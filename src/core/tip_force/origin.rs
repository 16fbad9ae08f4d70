//! The origin of a trained network and the result of its check, stored with the network.

use serde::{Deserialize, Serialize};

use crate::calibration::Judgement;

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrainingSettings {
    /// Seed of the initial weights, the folds and the order of rows.
    pub seed: u64,
    /// Networks in the ensemble, 1 to 16.
    pub members: usize,
    /// Widths of the hidden layers, one to four of 1 to 256.
    pub hidden: Vec<usize>,
    /// Maximum number of epochs of a member; `None` chooses the number that gives about 5000 steps.
    pub epochs: Option<usize>,
    pub batch: usize,
    /// Learning rate at the start; it falls along a half cosine to a fiftieth.
    pub learning_rate: f64,
    /// Weight decay of `AdamW`.
    pub weight_decay: f64,
}

impl Default for TrainingSettings {
    fn default() -> Self {
        Self {
            seed: 1,
            members: 4,
            hidden: vec![32, 32],
            epochs: None,
            batch: 256,
            learning_rate: 3e-3,
            weight_decay: 1e-3,
        }
    }
}

/// Optimiser steps of a member if the caller sets no number of epochs.
const STEPS: usize = 5000;

impl TrainingSettings {
    /// Returns the maximum number of epochs for this many training rows.
    /// 10 epochs at the least, for the stop by validation to choose from; 500 at most for tiny data.
    pub fn epochs_for(&self, rows: usize) -> usize {
        self.epochs.unwrap_or_else(|| (STEPS / rows.div_ceil(self.batch).max(1)).clamp(10, 500))
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MemberFigures {
    /// Epoch whose weights were kept, starting at 1; 0 if the linear path alone was best.
    pub epoch: usize,
    pub epochs: usize,
    /// Mean square error on the training rows in that epoch, in units of the outputs' variance.
    pub training_loss: f64,
    /// The same on the validation rows, which decide when the training stops.
    pub validation_loss: f64,
}

/// Result of a check, stored in the model's file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OriginCheck {
    #[serde(flatten)]
    pub judgement: Judgement,
    /// Date of the check, UTC, ISO 8601.
    pub date: String,
    pub rows: usize,
    pub mae_n: [f64; 3],
    /// Standard deviation of the error per axis, N.
    pub sd_n: [f64; 3],
    /// Mean prediction per axis without contact, N.
    pub free_mean_n: [f64; 3],
    /// Standard deviation of the prediction without contact, N.
    pub free_sd_n: [f64; 3],
    /// Fraction of the samples flagged as uncertain.
    #[serde(rename = "doubt_share")]
    pub doubt_fraction: f64,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModelOrigin {
    /// Serial number of the sensor, if the caller gave one.
    pub sensor: Option<String>,
    pub tool: Option<String>,
    /// Date of the training, UTC, ISO 8601.
    pub date: String,
    pub software: String,
    /// Hash of each training file (FNV-1a over its bytes).
    pub data_hashes: Vec<String>,
    pub rows: usize,
    /// Settings of the training, sufficient to repeat it.
    pub settings: TrainingSettings,
    pub figures: Vec<MemberFigures>,
    /// Features that were constant in the training data; a sample in which they differ is flagged as uncertain.
    pub constant: Vec<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub check: Option<OriginCheck>,
}
