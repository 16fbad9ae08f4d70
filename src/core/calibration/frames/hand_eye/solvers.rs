//! Two published solutions of `A X = Y B` in closed form. Sources: [`super::HandEyeSolver`].

use nalgebra::{Isometry3, Matrix3, Matrix6, Rotation3, SMatrix, SymmetricEigen, UnitQuaternion, Vector3, Vector6};

use super::{HandEyeFrames, HandEyeRow};
use crate::calibration::{frames::spread::nearest_orthogonal, rotation_mean::RotationMean};

/// Solves by Park and Martin over all pairs of poses: with the rotation vectors `a` and `b` of the motions of flange
/// and marker, `a = R_X b`, so `R_X = (M^T M)^(-1/2) M^T` with `M = sum b a^T`; then the positions by least squares.
pub(super) fn park_martin(rows: &[HandEyeRow]) -> Option<HandEyeFrames> {
    let mut moment = Matrix3::zeros();
    for (i, one) in rows.iter().enumerate() {
        // Every pair of poses, so that no single pose is the reference for all others.
        for other in &rows[..i] {
            let a = (other.base_from_flange.rotation.inverse() * one.base_from_flange.rotation).scaled_axis();
            let b = (other.c_from_m.rotation.inverse() * one.c_from_m.rotation).scaled_axis();
            moment += b * a.transpose();
        }
    }
    let eigen = SymmetricEigen::try_new(moment.transpose() * moment, f64::EPSILON, 100)?;
    // `MIN_POSITIVE` keeps the root finite if all turns have one axis.
    let root = Matrix3::from_diagonal(&eigen.eigenvalues.map(|square| 1.0 / square.max(f64::MIN_POSITIVE).sqrt()));
    let x = rotation(&(eigen.eigenvectors * root * eigen.eigenvectors.transpose() * moment.transpose()))?;
    let mut mean = RotationMean::default();
    for row in rows {
        mean.add(&(row.base_from_flange.rotation * x * row.c_from_m.rotation.inverse()));
    }
    with_places(rows, x, mean.mean()?)
}

/// Solves by Shah: `R_A R_X R_B^T = R_Y` is linear in the entries of both, `(R_B (x) R_A) vec(R_X) = vec(R_Y)`, so they
/// are the singular vectors of the largest singular value of the sum.
pub(super) fn shah(rows: &[HandEyeRow]) -> Option<HandEyeFrames> {
    let mut sum = SMatrix::<f64, 9, 9>::zeros();
    for row in rows {
        let a = row.base_from_flange.rotation.to_rotation_matrix().into_inner();
        let b = row.c_from_m.rotation.to_rotation_matrix().into_inner();
        sum += b.kronecker(&a);
    }
    let decomposed = sum.try_svd(true, true, f64::EPSILON, 300)?;
    let largest = decomposed.singular_values.imax();
    let x = Matrix3::from_iterator(decomposed.v_t?.row(largest).iter().copied());
    let y = Matrix3::from_iterator(decomposed.u?.column(largest).iter().copied());
    // The vectors have unit length and arbitrary sign; both rotations have the same factor.
    let sign = x.determinant().signum();
    with_places(rows, rotation(&(x * sign))?, rotation(&(y * sign))?)
}

/// Returns the nearest rotation.
fn rotation(matrix: &Matrix3<f64>) -> Option<UnitQuaternion<f64>> {
    let nearest = nearest_orthogonal(matrix, 1.0)?;
    Some(UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(nearest)))
}

/// Returns both positions for known rotations: `R_A t_X - t_Y = R_Y t_B - t_A`, least squares over all poses.
fn with_places(rows: &[HandEyeRow], x: UnitQuaternion<f64>, y: UnitQuaternion<f64>) -> Option<HandEyeFrames> {
    let mut normal = Matrix6::zeros();
    let mut right = Vector6::zeros();
    for row in rows {
        let a = row.base_from_flange.rotation.to_rotation_matrix().into_inner();
        let wanted_m = y * row.c_from_m.translation.vector - row.base_from_flange.translation.vector;
        let mut block = |i: usize, j: usize, part: Matrix3<f64>| {
            let mut view = normal.fixed_view_mut::<3, 3>(3 * i, 3 * j);
            view += part;
        };
        block(0, 0, Matrix3::identity());
        block(0, 1, -a.transpose());
        block(1, 0, -a);
        block(1, 1, Matrix3::identity());
        let mut view = right.fixed_rows_mut::<3>(0);
        view += a.transpose() * wanted_m;
        let mut view = right.fixed_rows_mut::<3>(3);
        view -= wanted_m;
    }
    let places_m = normal.cholesky()?.solve(&right);
    let place = |from: usize| -> Vector3<f64> { places_m.fixed_rows::<3>(from).into_owned() };
    Some(HandEyeFrames {
        flange_from_m: Isometry3::from_parts(place(0).into(), x),
        base_from_c: Isometry3::from_parts(place(3).into(), y),
    })
}
