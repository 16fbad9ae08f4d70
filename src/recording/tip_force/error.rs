//! Errors of training, storing, loading and using a tip-force model.

use std::path::PathBuf;

use crate::store::StoreError;

#[derive(Debug, thiserror::Error)]
pub enum TipForceError {
    #[error("cannot read {path}: {reason}")]
    Open { path: PathBuf, reason: String },
    #[error("data set {path} has no column \"{column}\": its columns are {available}; rename or add the column")]
    NoColumn { path: PathBuf, column: String, available: String },
    #[error(
        "data set {path}, line {line}, column \"{column}\": \"{field}\" is not a finite number; remove or repair the row"
    )]
    NotANumber {
        path: PathBuf,
        /// From 1.
        line: u64,
        column: String,
        field: String,
    },
    #[error("the data set has too few rows: {found} instead of at least {needed}; record longer")]
    TooFewRows { found: usize, needed: usize },
    #[error(
        "output column \"{column}\" is constant over the whole data set, so there is nothing to learn; record with contact, or leave it out"
    )]
    ConstantOutput { column: String },
    #[error("the selected columns cannot be used: {reason}")]
    Columns { reason: String },
    #[error("{name} is {value}: it must be {allowed}")]
    Setting { name: &'static str, value: String, allowed: &'static str },
    #[error("training was cancelled; nothing was written")]
    Cancelled,
    #[error(
        "training of member {member} diverged to numbers that are not finite; lower the learning rate or remove outliers from the data"
    )]
    Diverged {
        /// From 1.
        member: usize,
    },
    #[error("the trained networks differ in their numbers of inputs and outputs; train them with the same columns")]
    Shapes,
    #[error("{path} is not a usable tip-force model: {reason}; train it again with `nima train tip-force`")]
    Model { path: PathBuf, reason: String },
    #[error(transparent)]
    NotLive(#[from] nima_core::tip_force::NotLive),
    #[error("the tip-force model must not be used: {reason}; check it on a new recording")]
    NotProven { reason: String },
    #[error(transparent)]
    Store(#[from] StoreError),
    #[error("cannot write the model {path}: {reason}")]
    Write { path: PathBuf, reason: String },
}
