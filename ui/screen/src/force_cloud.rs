//! Measured and rendered force over the last seconds, and the ellipsoid that contains 95 % of their differences.
//!
//! Forces in N, workspace frame. The ellipsoid belongs to a normal distribution with the same mean and covariance. The
//! actual fraction of differences inside it is counted, because contact is not normally distributed. Non-finite samples
//! are ignored.

use std::collections::VecDeque;

use nalgebra::{Matrix3, Vector3};

/// Stored time, s, and time between samples, s.
pub const SECONDS: f64 = 6.0;
const STEP_S: f64 = 0.02;
/// A longer interval without a sample, s, means that a force was unknown.
pub const GAP_S: f64 = 0.1;
/// 95 % quantile of chi squared with three degrees of freedom.
const CHI2_95: f64 = 7.814_728;
/// Minimum number of samples for an ellipsoid.
const MIN: usize = 50;

#[derive(Clone, Copy, Debug)]
pub struct ForcePair {
    /// Time, s on the loop's clock.
    pub t_s: f64,
    /// Measured at the instrument, N.
    pub measured_n: Vector3<f64>,
    /// Rendered to the hand, N.
    pub rendered_n: Vector3<f64>,
}

/// The last seconds, oldest first.
#[derive(Clone, Debug, Default)]
pub struct ForceCloud {
    pairs: VecDeque<ForcePair>,
}

/// Mean error, and the half axes of the ellipsoid around it.
#[derive(Clone, Copy, Debug)]
pub struct Ellipsoid {
    /// Mean of rendered minus measured, N.
    pub mean_n: Vector3<f64>,
    /// Half axes, N, as columns.
    pub half_axes_n: Matrix3<f64>,
    /// Fraction of the differences inside the ellipsoid, 0 to 1.
    pub holds: f64,
}

impl ForceCloud {
    /// Adds a tick; one in twenty is stored.
    pub fn push(&mut self, t_s: f64, measured_n: Vector3<f64>, rendered_n: Vector3<f64>) {
        let finite = t_s.is_finite() && measured_n.iter().chain(&rendered_n).all(|x| x.is_finite());
        if !finite || self.pairs.back().is_some_and(|last| (0.0..STEP_S).contains(&(t_s - last.t_s))) {
            return;
        }
        self.pairs.push_back(ForcePair { t_s, measured_n, rendered_n });
        while self.pairs.front().is_some_and(|first| !(0.0..=SECONDS).contains(&(t_s - first.t_s))) {
            self.pairs.pop_front();
        }
    }

    /// Returns the stored pairs, oldest first.
    pub fn pairs(&self) -> impl DoubleEndedIterator<Item = &ForcePair> + ExactSizeIterator {
        self.pairs.iter()
    }

    /// Returns the 95 % ellipsoid of rendered minus measured force; `None` with less than a second of data.
    pub fn ellipsoid(&self) -> Option<Ellipsoid> {
        if self.pairs.len() < MIN {
            return None;
        }
        let count = self.pairs.len() as f64;
        let errors_n = || self.pairs.iter().map(|pair| pair.rendered_n - pair.measured_n);
        let mean_n = errors_n().sum::<Vector3<f64>>() / count;
        let scatter: Matrix3<f64> = errors_n().map(|error_n| (error_n - mean_n) * (error_n - mean_n).transpose()).sum();
        let eigen = (scatter / (count - 1.0)).symmetric_eigen();
        let half_n = eigen.eigenvalues.map(|variance| (CHI2_95 * variance.max(0.0)).sqrt());
        let inside = |error_n: Vector3<f64>| {
            let along = eigen.eigenvectors.transpose() * (error_n - mean_n);
            along.zip_map(&half_n, |x, half| if half > 0.0 { (x / half).powi(2) } else { 0.0 }).sum() <= 1.0
        };
        let holds = errors_n().filter(|error_n| inside(*error_n)).count() as f64 / count;
        let half_axes_n = eigen.eigenvectors * Matrix3::from_diagonal(&half_n);
        Some(Ellipsoid { mean_n, half_axes_n, holds })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the errors with this mean and these standard deviations, nearly normal (sum of twelve uniform numbers).
    fn cloud(mean_n: Vector3<f64>, deviations_n: Vector3<f64>) -> ForceCloud {
        let mut cloud = ForceCloud::default();
        let mut seed = 12_345_u64;
        let mut uniform = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1_u64 << 53) as f64
        };
        for i in 0..290 {
            let normal = Vector3::from_fn(|_, _| (0..12).map(|_| uniform()).sum::<f64>() - 6.0);
            let measured_n = Vector3::new(0.0, 0.0, 2.0);
            cloud.push(f64::from(i) * 0.0201, measured_n, measured_n + mean_n + deviations_n.component_mul(&normal));
        }
        cloud
    }

    #[test]
    fn the_ellipsoid_is_where_the_errors_are_and_holds_nineteen_in_twenty() {
        let mean_n = Vector3::new(0.1, -0.2, 0.3);
        let deviations_n = Vector3::new(0.05, 0.1, 0.4);
        let ellipsoid = cloud(mean_n, deviations_n).ellipsoid().unwrap();
        assert!((ellipsoid.mean_n - mean_n).norm() < 0.08, "{}", ellipsoid.mean_n);
        assert!((0.91..=0.98).contains(&ellipsoid.holds), "{}", ellipsoid.holds);
        let mut lengths: Vec<f64> = ellipsoid.half_axes_n.column_iter().map(|axis| axis.norm()).collect();
        lengths.sort_by(f64::total_cmp);
        for (length, deviation_n) in lengths.iter().zip([0.05, 0.1, 0.4]) {
            assert!((length / (CHI2_95.sqrt() * deviation_n) - 1.0).abs() < 0.15, "{lengths:?}");
        }
    }

    #[test]
    fn it_forgets_and_bad_input_is_left_out() {
        let mut cloud = cloud(Vector3::zeros(), Vector3::repeat(0.1));
        cloud.push(f64::NAN, Vector3::zeros(), Vector3::zeros());
        cloud.push(6.0, Vector3::repeat(f64::NAN), Vector3::zeros());
        assert!(cloud.pairs().all(|pair| pair.measured_n.z > 1.0));
        cloud.push(100.0, Vector3::zeros(), Vector3::zeros());
        assert_eq!(cloud.pairs().count(), 1);
        assert!(cloud.ellipsoid().is_none());
        cloud.push(0.0, Vector3::zeros(), Vector3::zeros());
        assert_eq!(cloud.pairs().count(), 1, "a new loop starts from zero");
    }
}
