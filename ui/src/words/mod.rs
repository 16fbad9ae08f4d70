//! The words for what the library reports as values: faults, reasons, sources, verdicts. The window and the command line use the same
//! ones. The library itself holds the values only, so that all sentences that reach a person stand here or in `console/text`.
//!
//! Causes are sentences, cures are what the operator can do; reasons begin small, because they follow a colon.

mod calibration;
mod faults;
mod force;
mod refusals;

pub(crate) use calibration::{drift, refusal};
pub(crate) use refusals::{cure_of_refusal, refused_because};

/// A value that is reported with what happened and what to do.
pub(crate) trait Remedy {
    /// What happened, in one sentence.
    fn cause(self) -> &'static str;
    /// What the operator can do.
    fn cure(self) -> &'static str;
}

/// A value that is reported in a few words.
pub(crate) trait Words {
    /// Those words.
    fn words(self) -> &'static str;
}
