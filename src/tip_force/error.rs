//! Why a tip-force model could not be trained, stored, loaded or used.

use std::path::PathBuf;

use crate::calibration::store::StoreError;

/// What happened, where, and what to do about it, in one line.
#[derive(Debug, thiserror::Error)]
pub enum TipForceError {
    /// A file could not be opened or read.
    #[error("cannot read {path}: {reason}")]
    Open {
        /// Its path.
        path: PathBuf,
        /// Why, in the reader's words.
        reason: String,
    },
    /// A needed column is not there.
    #[error(
        "data set {path} has no column \"{column}\"; its columns are {available}; name others with --inputs and --outputs"
    )]
    NoColumn {
        /// Its path.
        path: PathBuf,
        /// The column looked for.
        column: String,
        /// The columns there are.
        available: String,
    },
    /// A field is no finite number.
    #[error(
        "data set {path}, line {line}, column \"{column}\": \"{field}\" is not a finite number; remove or repair the row"
    )]
    NotANumber {
        /// Its path.
        path: PathBuf,
        /// Line of the file, from 1.
        line: u64,
        /// Its column.
        column: String,
        /// The text found.
        field: String,
    },
    /// Too few rows to learn from, or to judge by.
    #[error("the data set has {found} rows, at least {needed} are needed; record longer")]
    TooFewRows {
        /// Rows found.
        found: usize,
        /// Rows needed.
        needed: usize,
    },
    /// An output never changes.
    #[error(
        "output column \"{column}\" is constant over the whole data set: there is nothing to learn; record with contact or leave it out"
    )]
    ConstantOutput {
        /// Its name.
        column: String,
    },
    /// The choice of columns makes no model.
    #[error("the choice of columns is not usable: {reason}")]
    Columns {
        /// Why.
        reason: String,
    },
    /// A setting is out of its range.
    #[error("{name} is {value}, it must be {allowed}")]
    Setting {
        /// Which.
        name: &'static str,
        /// Its value.
        value: String,
        /// What is allowed.
        allowed: &'static str,
    },
    /// Somebody asked to stop; nothing was kept.
    #[error("training was cancelled; nothing was written")]
    Cancelled,
    /// Weights ran away.
    #[error(
        "training of member {member} ran away to numbers that are not finite; lower the learning rate or look for outliers in the data"
    )]
    Diverged {
        /// Which member, from 1.
        member: usize,
    },
    /// The tensor library failed.
    #[error("training failed inside the tensor library: {reason}")]
    Tensor {
        /// In its words.
        reason: String,
    },
    /// A file is no model of ours, or one that does not fit together.
    #[error("{path} is not a usable tip-force model: {reason}; train it again with `nima train tip-force`")]
    Model {
        /// Its path.
        path: PathBuf,
        /// What is wrong or absent.
        reason: String,
    },
    /// A good model whose columns a live wrist does not deliver.
    #[error("the model works with {found}, which the live loop does not know; train one on the default columns")]
    NotLive {
        /// What the loop does not know.
        found: String,
    },
    /// Nobody may feel what is not proven.
    #[error("the tip-force model may not be used: {reason}; check it on a new recording")]
    NotProven {
        /// Why.
        reason: String,
    },
    /// The store of calibrations refused.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// The file could not be written.
    #[error("cannot write the model {path}: {reason}")]
    Write {
        /// Its path.
        path: PathBuf,
        /// Why.
        reason: String,
    },
}

impl From<candle_core::Error> for TipForceError {
    fn from(error: candle_core::Error) -> Self {
        Self::Tensor { reason: error.to_string() }
    }
}
