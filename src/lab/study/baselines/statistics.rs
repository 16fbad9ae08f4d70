//! The mean of a few numbers and its uncertainty.

use serde::Serialize;

/// Description of the interval.
pub(super) const WORDS: &str =
    "95 % confidence interval of the mean over the sources, by Student's t with n - 1 degrees of freedom";

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MeanInterval {
    pub mean: f64,
    /// Lower and upper end; `None` for a single number.
    pub low: Option<f64>,
    /// `None` for a single number.
    pub high: Option<f64>,
}

impl MeanInterval {
    /// Computes the interval for the mean of independent numbers.
    pub fn of_mean(values: &[f64]) -> Self {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        if values.len() < 2 {
            return Self { mean, low: None, high: None };
        }
        let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (n - 1.0);
        let half = t_975(values.len() - 1) * (variance / n).sqrt();
        Self { mean, low: Some(mean - half), high: Some(mean + half) }
    }
}

/// Returns the 97.5 % quantile of Student's t: a table for few degrees of freedom, beyond it the expansion about the
/// normal one (Abramowitz and Stegun, 26.7.5), accurate to 0.001.
fn t_975(freedom: usize) -> f64 {
    const TABLE: [f64; 8] = [12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306];
    if let Some(t) = freedom.checked_sub(1).and_then(|index| TABLE.get(index)) {
        return *t;
    }
    let z = 1.959_964_f64;
    let n = freedom.max(1) as f64;
    let first = (z.powi(3) + z) / 4.0;
    let second = (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / 96.0;
    let third = (3.0 * z.powi(7) + 19.0 * z.powi(5) + 17.0 * z.powi(3) - 15.0 * z) / 384.0;
    z + first / n + second / n.powi(2) + third / n.powi(3)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_the_tables() {
        for (freedom, expected) in [(1, 12.706), (8, 2.306), (9, 2.262), (15, 2.131), (30, 2.042), (1000, 1.962)] {
            assert!((t_975(freedom) - expected).abs() < 1.5e-3, "{freedom}: {}", t_975(freedom));
        }
    }

    #[test]
    fn an_interval_by_hand() {
        let MeanInterval { mean, low, high } = MeanInterval::of_mean(&[1.0, 2.0, 3.0]);
        let half = 4.303 / 3.0_f64.sqrt();
        assert!((mean - 2.0).abs() < 1e-12);
        assert!((low.unwrap() - (2.0 - half)).abs() < 1e-9 && (high.unwrap() - (2.0 + half)).abs() < 1e-9);
        assert_eq!(MeanInterval::of_mean(&[0.4]).low, None, "a single number has no spread");
    }
}
