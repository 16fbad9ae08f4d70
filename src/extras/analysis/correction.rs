//! Several p-values of one family of questions, corrected so that the chance of any false positive stays at the level.

use crate::check;
use crate::error::{AnalysisError, Result};

/// Returns Holm's step-down p-values (A simple sequentially rejective multiple test procedure, Scandinavian Journal of
/// Statistics 6, 1979), in the order of `p_values`; R's `p.adjust(p, "holm")`. Never less powerful than [`bonferroni`],
/// and as general.
///
/// ```
/// use nima_analysis::{correction, AnalysisError};
///
/// assert_eq!(correction::holm(&[0.01, 0.04, 0.03])?, [0.03, 0.06, 0.06]);
/// # Ok::<(), AnalysisError>(())
/// ```
pub fn holm(p_values: &[f64]) -> Result<Vec<f64>> {
    probabilities(p_values)?;
    let mut order: Vec<usize> = (0..p_values.len()).collect();
    order.sort_by(|&a, &b| p_values[a].total_cmp(&p_values[b]));
    let mut corrected = vec![0.0; p_values.len()];
    let mut largest: f64 = 0.0;
    for (step, &at) in order.iter().enumerate() {
        largest = largest.max(((p_values.len() - step) as f64 * p_values[at]).min(1.0));
        corrected[at] = largest;
    }
    Ok(corrected)
}

/// Returns Bonferroni's p-values: each multiplied by their number, at most 1 (Dunn, Multiple comparisons among means,
/// JASA 56, 1961).
pub fn bonferroni(p_values: &[f64]) -> Result<Vec<f64>> {
    probabilities(p_values)?;
    Ok(p_values.iter().map(|p| (p * p_values.len() as f64).min(1.0)).collect())
}

fn probabilities(p_values: &[f64]) -> Result<()> {
    check::values("p-values", p_values, 1)?;
    match p_values.iter().find(|p| !(0.0..=1.0).contains(*p)) {
        Some(&value) => Err(AnalysisError::OutOfRange { what: "a p-value", range: "from 0 to 1", value }),
        None => Ok(()),
    }
}
