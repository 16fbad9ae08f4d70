//! Tails and quantiles of the tests' distributions, using the functions of `statrs`.
//!
//! Tails are computed directly, not as one minus the rest, so that small p-values keep their digits. For arguments
//! outside its domain a distribution has the tail 1, which claims nothing; no caller passes such arguments.

use statrs::distribution::{ContinuousCDF, StudentsT};
use statrs::function::{beta::checked_beta_reg, erf, gamma::checked_gamma_ur};
use std::f64::consts::SQRT_2;

/// Returns P(Z <= z) of the standard normal distribution.
pub(crate) fn normal_below(z: f64) -> f64 {
    erf::erfc(-z / SQRT_2) / 2.0
}

/// Returns P(|Z| >= |z|) of the standard normal distribution.
pub(crate) fn normal_two_sided(z: f64) -> f64 {
    erf::erfc(z.abs() / SQRT_2)
}

/// Returns the z with P(Z <= z) = `fraction`, a number between 0 and 1; outside that range, the nearest end (an infinity).
pub(crate) fn normal_quantile(fraction: f64) -> f64 {
    -SQRT_2 * erf::erfc_inv(2.0 * fraction.clamp(0.0, 1.0))
}

/// Returns P(|T| >= |t|) of Student's t with `df` degrees of freedom (positive).
pub(crate) fn t_two_sided(t: f64, df: f64) -> f64 {
    beta_tail(df / 2.0, 0.5, df, t * t)
}

/// Returns the t with P(|T| <= t) = `confidence` (between 0 and 1) with `df` degrees of freedom (positive).
pub(crate) fn t_critical(confidence: f64, df: f64) -> f64 {
    let fraction = f64::midpoint(1.0, confidence);
    if df > 1e4 {
        // Here the library's inverse loses digits, all but three at a million degrees; these terms leave an error of
        // 1e-10 (Abramowitz & Stegun, 26.7.5).
        let z = normal_quantile(fraction);
        return z + (z.powi(3) + z) / (4.0 * df) + (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / (96.0 * df * df);
    }
    let Ok(distribution) = StudentsT::new(0.0, 1.0, df) else { return normal_quantile(fraction) };
    distribution.inverse_cdf(fraction)
}

/// Returns P(F >= f) of Fisher's F with `df1` and `df2` degrees of freedom (positive).
pub(crate) fn f_above(f: f64, df1: f64, df2: f64) -> f64 {
    beta_tail(df2 / 2.0, df1 / 2.0, df2, df1 * f)
}

/// Returns P(X >= x) of chi-square with `df` degrees of freedom (positive).
pub(crate) fn chi_square_above(x: f64, df: f64) -> f64 {
    if x > 0.0 { checked_gamma_ur(df / 2.0, x / 2.0).unwrap_or(1.0) } else { 1.0 }
}

/// Returns the regularised incomplete beta function at `df / (df + other)`.
fn beta_tail(a: f64, b: f64, df: f64, other: f64) -> f64 {
    if other > 0.0 { checked_beta_reg(a, b, df / (df + other)).unwrap_or(1.0) } else { 1.0 }
}
