//! Refuses input that cannot be analysed, before anything is computed.

use crate::error::{AnalysisError, Result};

/// Larger numbers are refused: their squares, summed, would not be finite.
const LARGEST: f64 = 1e150;

/// Checks that all of `values` are finite, and that there are at least `needed`.
pub(crate) fn values(what: &'static str, values: &[f64], needed: usize) -> Result<()> {
    enough(what, values.len(), needed)?;
    finite(what, values)
}

pub(crate) fn finite(what: &str, values: &[f64]) -> Result<()> {
    match values.iter().position(|value| !usable(*value)) {
        Some(at) => Err(AnalysisError::NotFinite { what: what.to_owned(), position: at + 1 }),
        None => Ok(()),
    }
}

pub(crate) fn enough(what: &'static str, found: usize, needed: usize) -> Result<()> {
    if found < needed { Err(AnalysisError::TooFew { what, needed, found }) } else { Ok(()) }
}

pub(crate) fn not_too_many(what: &'static str, found: usize, max: usize) -> Result<()> {
    if found > max { Err(AnalysisError::TooMany { what, max, found }) } else { Ok(()) }
}

pub(crate) fn as_many(what: &str, found: usize, with: &'static str, expected: usize) -> Result<()> {
    if found == expected {
        Ok(())
    } else {
        Err(AnalysisError::UnequalLengths { what: what.to_owned(), with, found, expected })
    }
}

/// Returns whether the values differ.
pub(crate) fn varies(values: &[f64]) -> bool {
    values.windows(2).any(|two| (two[0] - two[1]).abs() > 0.0)
}

/// Checks for a value strictly between 0 and 1, such as a confidence level.
pub(crate) fn fraction(what: &'static str, value: f64) -> Result<()> {
    // Written so that NaN is refused too.
    if value > 0.0 && value < 1.0 {
        Ok(())
    } else {
        Err(AnalysisError::OutOfRange { what, range: "between 0 and 1", value })
    }
}

/// Checks for a positive number of usable size.
pub(crate) fn positive(what: &'static str, value: f64) -> Result<()> {
    if value > 0.0 && usable(value) {
        Ok(())
    } else {
        Err(AnalysisError::OutOfRange { what, range: "a positive number", value })
    }
}

/// Returns `first - second`, pair by pair.
pub(crate) fn differences(first: &[f64], second: &[f64]) -> Result<Vec<f64>> {
    as_many("the second values", second.len(), "the first ones", first.len())?;
    finite("the first values", first)?;
    finite("the second values", second)?;
    Ok(first.iter().zip(second).map(|(a, b)| a - b).collect())
}

fn usable(value: f64) -> bool {
    value.abs() < LARGEST
}
