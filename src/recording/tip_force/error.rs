//! Errors of training, storing, loading and using a tip-force model.

use std::path::PathBuf;

use crate::store::StoreError;

/// What happened, where, and what to do about it, in one line.
#[derive(Debug, thiserror::Error)]
pub enum TipForceError {
    /// A file could not be opened or read.
    #[error("cannot read {path}: {reason}")]
    Open {
        path: PathBuf,
        /// Text of the error.
        reason: String,
    },
    /// A required column is missing.
    #[error("data set {path} has no column \"{column}\"; its columns are {available}")]
    NoColumn { path: PathBuf, column: String, available: String },
    /// A field is not a finite number.
    #[error(
        "data set {path}, line {line}, column \"{column}\": \"{field}\" is not a finite number; remove or repair the row"
    )]
    NotANumber {
        path: PathBuf,
        /// Line of the file, from 1.
        line: u64,
        column: String,
        field: String,
    },
    /// Too few rows for training or evaluation.
    #[error("the data set has {found} rows, at least {needed} are needed; record longer")]
    TooFewRows { found: usize, needed: usize },
    /// An output is constant.
    #[error(
        "output column \"{column}\" is constant over the whole data set: there is nothing to learn; record with contact or leave it out"
    )]
    ConstantOutput { column: String },
    /// The choice of columns is not usable.
    #[error("the choice of columns is not usable: {reason}")]
    Columns { reason: String },
    /// A setting is out of its range.
    #[error("{name} is {value}, it must be {allowed}")]
    Setting { name: &'static str, value: String, allowed: &'static str },
    /// The training was cancelled.
    #[error("training was cancelled; nothing was written")]
    Cancelled,
    /// The training diverged.
    #[error(
        "training of member {member} ran away to numbers that are not finite; lower the learning rate or look for outliers in the data"
    )]
    Diverged {
        /// Number of the member, from 1.
        member: usize,
    },
    #[error("the trained networks do not fit together; check the numbers of inputs and outputs")]
    Shapes,
    /// A file is not a model, or its parts are inconsistent.
    #[error("{path} is not a usable tip-force model: {reason}; train it again with `nima train tip-force`")]
    Model {
        path: PathBuf,
        /// What is wrong or missing.
        reason: String,
    },
    /// The model cannot be used in the loop.
    #[error(transparent)]
    NotLive(#[from] nima_core::tip_force::NotLive),
    /// The model has no accepted check.
    #[error("the tip-force model may not be used: {reason}; check it on a new recording")]
    NotProven { reason: String },
    /// Error of the store of calibrations.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// The file could not be written.
    #[error("cannot write the model {path}: {reason}")]
    Write { path: PathBuf, reason: String },
}
