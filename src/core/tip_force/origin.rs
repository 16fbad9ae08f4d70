//! Where a trained network came from, and what it showed when it was judged: kept with the network.

use serde::{Deserialize, Serialize};

use crate::calibration::Judgement;

/// How to train.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrainingSettings {
    /// Seed of weights, folds and orders.
    pub seed: u64,
    /// Networks in the ensemble, 1 to 16.
    pub members: usize,
    /// Widths of the hidden layers, one to four of 1 to 256.
    pub hidden: Vec<usize>,
    /// Most epochs of a member; `None` chooses as many as give about 5000 steps.
    pub epochs: Option<usize>,
    /// Rows in a mini-batch.
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

/// Steps of the optimiser that a member gets where the caller names no epochs.
const STEPS: usize = 5000;

impl TrainingSettings {
    /// Most epochs for this many training rows.
    pub fn epochs_for(&self, rows: usize) -> usize {
        self.epochs.unwrap_or_else(|| (STEPS / rows.div_ceil(self.batch).max(1)).clamp(10, 500))
    }
}

/// What one member reached.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MemberFigures {
    /// Epoch whose weights were kept, from 1; 0 where the linear path alone was best.
    pub epoch: usize,
    /// Epochs run.
    pub epochs: usize,
    /// Mean square error on the training part in that epoch, in squares of the outputs' standard deviation.
    pub training_loss: f64,
    /// The same on the rows that stopped the training.
    pub validation_loss: f64,
}

/// What a check found. Kept inside the model's file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Check {
    /// May it be used?
    #[serde(flatten)]
    pub judgement: Judgement,
    /// When, UTC, ISO 8601.
    pub date: String,
    /// Rows it was judged by.
    pub rows: usize,
    /// Mean absolute error per axis, N (`s1`).
    pub mae_n: [f64; 3],
    /// Standard deviation of the error per axis, N.
    pub sd_n: [f64; 3],
    /// Mean answer per axis where nothing is touched, N.
    pub free_mean_n: [f64; 3],
    /// Standard deviation of the answer there, N.
    pub free_sd_n: [f64; 3],
    /// Share of samples in doubt.
    pub doubt_share: f64,
}

/// Where a model came from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Origin {
    /// Serial number of the sensor, as the caller gave it.
    pub sensor: Option<String>,
    /// The tool, as the caller gave it.
    pub tool: Option<String>,
    /// When it was trained, UTC, ISO 8601.
    pub date: String,
    /// Version of this software.
    pub software: String,
    /// Hash of the training files (FNV-1a over their bytes).
    pub data_hash: String,
    /// Rows trained on.
    pub rows: usize,
    /// Enough to repeat the training.
    pub settings: TrainingSettings,
    /// What the members reached.
    pub figures: Vec<MemberFigures>,
    /// Features that never changed in the training data; any other value of them is in doubt.
    pub constant: Vec<String>,
    /// What it showed on data recorded after the training.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub check: Option<Check>,
}
