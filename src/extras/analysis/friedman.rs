//! Friedman's test: several conditions, with each participant under each condition once.

use crate::distribution::{chi_square_above, f_above};
use crate::error::{AnalysisError, Result};
use crate::{check, ranks::Ranks};
use serde::Serialize;

/// Result of Friedman's test, corrected for ties.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Friedman {
    /// Mean rank of each condition; rank 1 is the smallest value.
    pub mean_ranks: Vec<f64>,
    /// Friedman's chi-square (Friedman, JASA 32, 1937; ties as in Conover, Practical Nonparametric Statistics, 1999, section 5.8).
    pub chi_square: f64,
    /// Degrees of freedom of `chi_square`, conditions - 1.
    pub df: f64,
    /// p-value of `chi_square`; conservative with few participants.
    pub p: f64,
    /// The F of Iman & Davenport (Approximations of the critical region of the Friedman statistic, Communications in
    /// Statistics A9, 1980), whose actual level is closer to the nominal one; `None` if all participants agree, because
    /// it is infinite then.
    pub f: Option<f64>,
    /// Degrees of freedom of its denominator, (conditions - 1)(participants - 1); its numerator has `df`.
    pub f_df: f64,
    /// p-value of `f`; if all participants agree, the probability of this agreement by chance (Conover).
    pub f_p: f64,
    /// Kendall's coefficient of concordance W, 0 (none) to 1 (all participants agree), corrected for ties (Kendall & Babington Smith, Annals of
    /// Mathematical Statistics 10, 1939).
    pub w: f64,
}

/// Tests data with one row per participant and one column per condition: at least two rows and two columns, and at
/// least one row whose values are not all equal.
///
/// ```
/// use nima_analysis::{friedman, AnalysisError};
///
/// // Workload of four participants without haptics, with delayed forces, and with matched ones.
/// let test = friedman::test(&[[55.0, 40.0, 35.0], [60.0, 62.0, 45.0], [70.0, 50.0, 30.0], [48.0, 45.0, 44.0]])?;
/// assert!((test.chi_square - 6.5).abs() < 1e-12 && (test.w - 0.8125).abs() < 1e-12);
/// # Ok::<(), AnalysisError>(())
/// ```
pub fn test<Row: AsRef<[f64]>>(rows: &[Row]) -> Result<Friedman> {
    check::enough("participants", rows.len(), 2)?;
    let conditions = rows[0].as_ref().len();
    check::enough("conditions", conditions, 2)?;
    check::not_too_many("conditions", conditions, 100)?;
    let mut doubled = vec![0; conditions];
    let mut ties = 0.0;
    let mut ranked = Vec::with_capacity(rows.len());
    for (at, row) in rows.iter().enumerate() {
        let (row, what) = (row.as_ref(), format!("the row of participant {}", at + 1));
        check::as_many(&format!("the values in {what}"), row.len(), "the conditions", conditions)?;
        check::finite(&what, row)?;
        let ranks = Ranks::of(row);
        doubled.iter_mut().zip(&ranks.doubled).for_each(|(sum, rank)| *sum += rank);
        ties += ranks.ties;
        ranked.push(ranks);
    }
    let n = rows.len() as f64;
    let k = conditions as f64;
    let spread = n * k * (k + 1.0) - ties / (k - 1.0);
    // Each row of equal values subtracts k (k + 1), so nothing remains if all rows have equal values.
    if spread < 0.5 {
        return Err(AnalysisError::NoVariation { what: "the values of every participant" });
    }
    let deviation = |sum: &usize| (*sum as f64 / 2.0 - n * (k + 1.0) / 2.0).powi(2);
    let chi_square = 12.0 * doubled.iter().map(deviation).sum::<f64>() / spread;
    let df = k - 1.0;
    let f_df = df * (n - 1.0);
    let agree = ranked.iter().all(|ranks| ranks.doubled == ranked[0].doubled);
    let f = (n - 1.0) * chi_square / (n * df - chi_square).max(0.0);
    let (f, f_p) = if agree { (None, by_chance(&ranked[0].doubled, n)) } else { (Some(f), f_above(f, df, f_df)) };
    let mean_ranks = doubled.iter().map(|sum| *sum as f64 / (2.0 * n)).collect();
    Ok(Friedman {
        mean_ranks,
        chi_square,
        df,
        p: chi_square_above(chi_square, df),
        f,
        f_df,
        f_p,
        w: chi_square / (n * df),
    })
}

/// Returns the probability that `n` participants give the same ranks by chance: each but the first hits one of the k!
/// orders, fewer with ties.
fn by_chance(doubled: &[usize], n: f64) -> f64 {
    let mut sorted = doubled.to_vec();
    sorted.sort_unstable();
    let factorial = |count: usize| (2..=count).map(|factor| factor as f64).product::<f64>();
    let orders =
        factorial(doubled.len()) / sorted.chunk_by(|a, b| a == b).map(|tie| factorial(tie.len())).product::<f64>();
    orders.powf(1.0 - n)
}
