//! The mean of similar rotations.
//!
//! The rotation with the smallest sum of squared sines of half the angle to all of them: the eigenvector of the largest
//! eigenvalue of `sum q q^T` (Markley, Cheng, Crassidis, Oshman 2007, "Averaging Quaternions"). q and -q count as the
//! same rotation; partial sums can be added.

use nalgebra::{Matrix4, Quaternion, SymmetricEigen, UnitQuaternion};

/// Running mean of rotations. Constant memory, no allocation.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct RotationMean {
    outer: Matrix4<f64>,
}

impl RotationMean {
    /// Adds a rotation, which must be finite.
    pub(super) fn add(&mut self, rotation: &UnitQuaternion<f64>) {
        self.outer += rotation.coords * rotation.coords.transpose();
    }

    pub(super) fn merge(&mut self, other: &Self) {
        self.outer += other.outer;
    }

    pub(super) fn mean(&self) -> Option<UnitQuaternion<f64>> {
        // The trace is the number of rotations, because each has length one.
        if self.outer.trace() < 0.5 {
            return None;
        }
        let eigen = SymmetricEigen::new(self.outer);
        let vector = eigen.eigenvectors.column(eigen.eigenvalues.imax()).into_owned();
        UnitQuaternion::try_new(Quaternion::from(vector), 1e-9)
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;
    use crate::noise::Noise;

    #[test]
    fn noise_is_averaged_out_in_any_orientation_and_whatever_the_signs() {
        let mut noise = Noise::new(3);
        let mut worst_rad: f64 = 0.0;
        for _ in 0..200 {
            let mut vector = |size: f64| Vector3::from_fn(|_, _| size * noise.gaussian());
            let middle = UnitQuaternion::from_scaled_axis(vector(2.0));
            let mut first = RotationMean::default();
            let mut second = RotationMean::default();
            for i in 0..400 {
                let turned = middle * UnitQuaternion::from_scaled_axis(vector(0.01));
                let turned = if i % 3 == 0 { UnitQuaternion::new_unchecked(-turned.into_inner()) } else { turned };
                if i < 150 { first.add(&turned) } else { second.add(&turned) }
            }
            first.merge(&second);
            worst_rad = worst_rad.max(first.mean().unwrap().angle_to(&middle));
        }
        // 0.01 rad per axis and sample averages to 0.0005 rad per axis over 400 samples.
        assert!(worst_rad < 0.0025, "{worst_rad}");
    }

    #[test]
    fn two_rotations_meet_half_way_and_none_have_no_mean() {
        let about_z = |angle: f64| UnitQuaternion::from_scaled_axis(Vector3::z() * angle);
        let mut mean = RotationMean::default();
        assert!(mean.mean().is_none());
        mean.add(&about_z(0.2));
        mean.add(&about_z(0.6));
        assert!(mean.mean().unwrap().angle_to(&about_z(0.4)) < 1e-12);
    }
}
