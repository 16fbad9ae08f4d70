//! Tails and quantiles of the distributions that the tests refer to; the functions behind them are those of `statrs`.
//!
//! Tails are computed as tails, not as one minus the rest, so that small p-values keep their digits. What a distribution is not defined for has the
//! tail 1, which claims nothing; no caller asks for it.

use statrs::distribution::{ContinuousCDF, StudentsT};
use statrs::function::{beta::checked_beta_reg, erf, gamma::checked_gamma_ur};
use std::f64::consts::SQRT_2;

/// P(Z <= z) of the standard normal distribution.
pub(crate) fn normal_below(z: f64) -> f64 {
    erf::erfc(-z / SQRT_2) / 2.0
}

/// P(|Z| >= |z|) of the standard normal distribution.
pub(crate) fn normal_two_sided(z: f64) -> f64 {
    erf::erfc(z.abs() / SQRT_2)
}

/// The z with P(Z <= z) = `share`, a number between 0 and 1; outside of that, the nearest end (an infinity).
pub(crate) fn normal_quantile(share: f64) -> f64 {
    -SQRT_2 * erf::erfc_inv(2.0 * share.clamp(0.0, 1.0))
}

/// P(|T| >= |t|) of Student's t with `df` degrees of freedom (positive).
pub(crate) fn t_two_sided(t: f64, df: f64) -> f64 {
    beta_tail(df / 2.0, 0.5, df, t * t)
}

/// The t with P(|T| <= t) = `confidence` (between 0 and 1) with `df` degrees of freedom (positive).
pub(crate) fn t_critical(confidence: f64, df: f64) -> f64 {
    let share = f64::midpoint(1.0, confidence);
    if df > 1e4 {
        // The library's inverse loses its digits here, at a million degrees all but three; these terms leave 1e-10 (Abramowitz & Stegun, 26.7.5).
        let z = normal_quantile(share);
        return z + (z.powi(3) + z) / (4.0 * df) + (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / (96.0 * df * df);
    }
    let Ok(distribution) = StudentsT::new(0.0, 1.0, df) else { return normal_quantile(share) };
    distribution.inverse_cdf(share)
}

/// P(F >= f) of Fisher's F with `df1` and `df2` degrees of freedom (positive).
pub(crate) fn f_above(f: f64, df1: f64, df2: f64) -> f64 {
    beta_tail(df2 / 2.0, df1 / 2.0, df2, df1 * f)
}

/// P(X >= x) of chi-square with `df` degrees of freedom (positive).
pub(crate) fn chi_square_above(x: f64, df: f64) -> f64 {
    if x > 0.0 { checked_gamma_ur(df / 2.0, x / 2.0).unwrap_or(1.0) } else { 1.0 }
}

/// The regularised incomplete beta function at `df / (df + other)`.
fn beta_tail(a: f64, b: f64, df: f64, other: f64) -> f64 {
    if other > 0.0 { checked_beta_reg(a, b, df / (df + other)).unwrap_or(1.0) } else { 1.0 }
}
