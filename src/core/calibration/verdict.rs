//! Verdicts and error statistics, common to all calibrations.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Accurate on data that were not used for the fit.
    Accepted,
    /// The data do not determine the result: too few, or too similar.
    InsufficientMotion,
    /// The data determine a result, but the result does not explain the data.
    PoorData,
}

/// Errors per axis (x, y, z): mean absolute error, standard deviation, and largest absolute error, in the unit of the
/// compared quantity (N or Nm).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AxisStats {
    pub mae: [f64; 3],
    /// Standard deviation about the mean error.
    pub sd: [f64; 3],
    /// Largest absolute error.
    pub max: [f64; 3],
}

impl AxisStats {
    /// Returns the statistics of these errors; zeros without errors.
    pub fn of(errors: impl IntoIterator<Item = Vector3<f64>>) -> Self {
        let mut count = 0.0;
        let [mut sum, mut squares, mut absolute, mut max] = [Vector3::<f64>::zeros(); 4];
        for error in errors {
            count += 1.0;
            sum += error;
            squares += error.component_mul(&error);
            absolute += error.abs();
            max = max.sup(&error.abs());
        }
        if count == 0.0 {
            return Self::default();
        }
        let mean = sum / count;
        let variance = (squares / count - mean.component_mul(&mean)).map(|v| v.max(0.0));
        Self { mae: (absolute / count).into(), sd: variance.map(f64::sqrt).into(), max: max.into() }
    }

    /// Returns the mean over the axes of the mean absolute error.
    pub fn mean_mae(&self) -> f64 {
        self.mae.iter().sum::<f64>() / 3.0
    }

    pub fn largest(&self) -> f64 {
        self.max.iter().copied().fold(0.0, f64::max)
    }
}

/// Errors on the data used for a fit, and on held-out data.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Residuals {
    pub fitted: AxisStats,
    pub held_out: AxisStats,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statistics_of_known_errors() {
        let stats = AxisStats::of([Vector3::new(1.0, 0.0, -2.0), Vector3::new(-1.0, 0.0, -4.0)]);
        let near = |got: [f64; 3], want: [f64; 3]| (Vector3::from(got) - Vector3::from(want)).norm() < 1e-12;
        assert!(near(stats.mae, [1.0, 0.0, 3.0]), "{stats:?}");
        assert!(near(stats.sd, [1.0, 0.0, 1.0]), "{stats:?}");
        assert!(near(stats.max, [1.0, 0.0, 4.0]), "{stats:?}");
        assert!((stats.mean_mae() - 4.0 / 3.0).abs() < 1e-12);
        assert!((stats.largest() - 4.0).abs() < 1e-12);
        assert_eq!(AxisStats::of([]), AxisStats::default());
    }
}
