//! Volume of the ellipsoid that contains 95 % of a cloud of vectors.

use std::f64::consts::PI;

use nalgebra::{Matrix3, Vector3};

/// 95 % of a normal cloud in three dimensions lie within this square of the Mahalanobis distance (quantile of chi-square with three degrees
/// of freedom).
pub(crate) const CHI_SQUARE_95: f64 = 7.814_727_903_251_18;

/// Weighted mean and scatter, updated one by one (West 1979, Comm. ACM 22:532-535).
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct WeightedScatter {
    weight: f64,
    mean: Vector3<f64>,
    scatter: Matrix3<f64>,
}

impl WeightedScatter {
    pub(crate) fn add(&mut self, vector: &Vector3<f64>, weight: f64) {
        if weight > 0.0 {
            self.weight += weight;
            let from_mean = vector - self.mean;
            self.mean += from_mean * (weight / self.weight);
            self.scatter += from_mean * (vector - self.mean).transpose() * weight;
        }
    }

    /// Returns the volume in the cube of the vectors' unit; zero for a cloud in a plane, `None` for none.
    pub(crate) fn volume(&self) -> Option<f64> {
        let covariance = (self.weight > 0.0).then(|| self.scatter / self.weight)?;
        // Rounding can make the determinant of a flat cloud slightly negative.
        let axes = covariance.determinant().max(0.0).sqrt();
        Some(4.0 / 3.0 * PI * CHI_SQUARE_95 * CHI_SQUARE_95.sqrt() * axes)
    }
}
