//! Determines whether turns and directions suffice, and the 95 % regions of a result.

use nalgebra::{Isometry3, Matrix3, SymmetricEigen, Vector3};

use super::FrameCause;

/// Minimum turns, degrees (root mean square about the mean orientation).
const MIN_TURN_DEG: f64 = 8.0;
const MIN_SECOND_DEG: f64 = 5.0;

#[derive(Clone, Copy, Debug)]
pub(super) struct Turns {
    /// Turns about the best and the worst determined direction of a lever, degrees.
    pub(super) max_deg: f64,
    pub(super) min_deg: f64,
}

impl Turns {
    /// Computes the spread of the rotations of these poses from the eigenvalues of [`lever_matrix`]. A rotation about
    /// one axis leaves the lever along that axis undetermined.
    pub(super) fn of<'a>(poses: impl Iterator<Item = &'a Isometry3<f64>>) -> Self {
        let values = lever_matrix(poses).map_or(Vector3::zeros(), |matrix| matrix.symmetric_eigenvalues());
        let degrees = |square: f64| square.max(0.0).sqrt().to_degrees();
        Self { max_deg: degrees(values.max()), min_deg: degrees(values.min()) }
    }

    /// Returns the reason why the turns do not suffice, if so.
    pub(super) fn lacking(self) -> Option<FrameCause> {
        let Self { max_deg, min_deg } = self;
        if below(max_deg, MIN_TURN_DEG) {
            return Some(FrameCause::SmallTurns { turn_deg: max_deg, min_deg: MIN_TURN_DEG });
        }
        below(min_deg, MIN_SECOND_DEG).then_some(FrameCause::OneAxis { second_deg: min_deg, min_deg: MIN_SECOND_DEG })
    }
}

/// Returns whether a value is below its minimum, or NaN.
pub(super) const fn below(value: f64, min: f64) -> bool {
    value.is_nan() || value < min
}

/// Returns `I - R^T R` with the mean `R` of the rotation matrices: the normal matrix of a lever `t` in
/// `R_i t - b = d_i` per pose, after `b` is eliminated. `None` without poses.
pub(super) fn lever_matrix<'a>(poses: impl Iterator<Item = &'a Isometry3<f64>>) -> Option<Matrix3<f64>> {
    let mut sum = Matrix3::zeros();
    let mut count = 0.0;
    for pose in poses {
        sum += pose.rotation.to_rotation_matrix().into_inner();
        count += 1.0;
    }
    let mean = sum / count;
    (count > 0.0).then(|| Matrix3::identity() - mean.transpose() * mean)
}

/// Returns the square of the radius of a 95 % region in three dimensions, in variances: chi-squared, corrected for a
/// variance that was estimated with this many degrees of freedom (3 F(3, freedom) within 3 % from 12 degrees of freedom
/// on, and larger below).
fn square_95(freedom: usize) -> f64 {
    // 7.815 is the 95 % quantile of chi-squared with three degrees of freedom.
    7.815 / (1.0 - 3.2 / freedom.max(4) as f64)
}

/// Returns the half axes of the 95 % ellipsoid of a covariance, the longest first.
pub(super) fn ellipsoid_95(covariance: &Matrix3<f64>, freedom: usize) -> [Vector3<f64>; 3] {
    let Some(eigen) = SymmetricEigen::try_new(*covariance, f64::EPSILON, 100) else {
        return [Vector3::repeat(f64::NAN); 3];
    };
    let mut axes: [Vector3<f64>; 3] = std::array::from_fn(|i| {
        // Rounding can make an eigenvalue slightly negative.
        eigen.eigenvectors.column(i) * (eigen.eigenvalues[i].max(0.0) * square_95(freedom)).sqrt()
    });
    axes.sort_by(|a, b| b.norm().total_cmp(&a.norm()));
    axes
}

/// Returns the longest half axis of the 95 % ellipsoid of a covariance.
pub(super) fn radius_95(covariance: &Matrix3<f64>, freedom: usize) -> f64 {
    ellipsoid_95(covariance, freedom)[0].norm()
}

/// Returns the root mean squares of vectors along their principal axes, the longest first; NaN if a vector is not
/// finite.
pub(super) fn principal(vectors: &[Vector3<f64>]) -> [f64; 3] {
    let sum: Matrix3<f64> = vectors.iter().map(|v| v * v.transpose()).sum();
    let mut axes: [f64; 3] =
        (sum / vectors.len().max(1) as f64).symmetric_eigenvalues().map(|square| square.max(0.0).sqrt()).into();
    axes.sort_by(|a, b| b.total_cmp(a));
    axes
}

/// Returns the orthogonal matrix `Q` with this sign of its determinant that is nearest to
/// `moment = sum target source^T` and thus minimises `sum |target - Q source|^2` (Markley, J. Astronaut. Sci. 1988).
pub(super) fn nearest_orthogonal(moment: &Matrix3<f64>, sign: f64) -> Option<Matrix3<f64>> {
    let decomposed = moment.try_svd(true, true, f64::EPSILON, 100)?;
    let u = decomposed.u?;
    let v_t = decomposed.v_t?;
    let last = sign * (u.determinant() * v_t.determinant()).signum();
    // The weakest axis is turned over, because that changes the fit least.
    let order = decomposed.singular_values.imin();
    let mut signs = Vector3::repeat(1.0);
    signs[order] = last;
    Some(u * Matrix3::from_diagonal(&signs) * v_t)
}
