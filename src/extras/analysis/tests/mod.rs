//! Comparison with other programs, closed forms and simulated studies; and refusals.

mod closed_forms;
mod peers;
mod refused;
mod simulated;

use crate::error::Result;

#[track_caller]
fn near(found: f64, expected: f64, error: f64) {
    assert!((found - expected).abs() <= error * expected.abs().max(1.0), "{found}, not {expected}");
}

/// Runs Wilcoxon's test with default settings.
fn wilcoxon(differences: &[f64]) -> Result<crate::signed_rank::SignedRank> {
    crate::signed_rank::of_differences(differences, &crate::signed_rank::SignedRankOptions::default())
}
