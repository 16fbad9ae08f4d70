//! Student's paired t-test: the parametric companion of [`crate::signed_rank`].

use crate::distribution::{t_critical, t_two_sided};
use crate::error::{AnalysisError, Result};
use crate::interval::ConfidenceInterval;
use crate::{check, summary};
use serde::Serialize;

/// Result of a paired t-test (Student, The probable error of a mean, Biometrika 6, 1908).
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TTest {
    /// Mean difference, in the unit of the differences.
    pub mean: f64,
    /// Confidence interval of `mean`.
    pub interval: ConfidenceInterval,
    /// Mean divided by its standard error.
    pub t: f64,
    /// n - 1.
    pub df: f64,
    pub p: f64,
}

/// Tests `first - second`, pair by pair.
pub fn paired(first: &[f64], second: &[f64], confidence: f64) -> Result<TTest> {
    of_differences(&check::differences(first, second)?, confidence)
}

/// Tests at least two differences that are not all equal against zero.
pub fn of_differences(differences: &[f64], confidence: f64) -> Result<TTest> {
    check::values("differences", differences, 2)?;
    check::fraction("the confidence", confidence)?;
    let n = differences.len() as f64;
    let mean = summary::raw_mean(differences);
    let sd = summary::raw_sd(differences);
    let error = sd / n.sqrt();
    let t = mean / error;
    if !check::varies(differences) || !t.is_finite() {
        return Err(AnalysisError::NoVariation { what: "the differences" });
    }
    let df = n - 1.0;
    let interval = ConfidenceInterval::around(mean, t_critical(confidence, df) * error, confidence);
    Ok(TTest { mean, interval, t, df, p: t_two_sided(t, df) })
}
