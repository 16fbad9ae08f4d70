//! Views of a plane: its homography to the image, an initial focal length (Zhang 2000) and an initial pose.

use nalgebra::{
    DMatrix, Isometry3, Matrix3, Rotation3, SMatrix, SymmetricEigen, Translation3, UnitQuaternion, Vector2, Vector3,
};
use nima_endoscope::Lens;

/// Moves and scales positions so that their mean is zero and their mean distance is one.
fn normaliser(places: &[Vector2<f64>]) -> Matrix3<f64> {
    let count = places.len().max(1) as f64;
    let middle = places.iter().sum::<Vector2<f64>>() / count;
    let far = places.iter().map(|place| (place - middle).norm()).sum::<f64>() / count;
    let scale = 1.0 / far.max(1e-12);
    Matrix3::new(scale, 0.0, -scale * middle.x, 0.0, scale, -scale * middle.y, 0.0, 0.0, 1.0)
}

/// Returns the homography from positions on a plane to positions in an image; `None` if they do not determine one.
pub(crate) fn homography(from: &[Vector2<f64>], to: &[Vector2<f64>]) -> Option<Matrix3<f64>> {
    if from.len() < 4 || from.len() != to.len() {
        return None;
    }
    let [on_plane, in_image] = [normaliser(from), normaliser(to)];
    let mut squares = SMatrix::<f64, 9, 9>::zeros();
    for (a, b) in from.iter().zip(to) {
        let p = on_plane * a.push(1.0);
        let q = in_image * b.push(1.0);
        for (axis, at) in [(0, q.x), (1, q.y)] {
            let mut row = SMatrix::<f64, 9, 1>::zeros();
            row.fixed_rows_mut::<3>(3 * axis).copy_from(&p);
            row.fixed_rows_mut::<3>(6).copy_from(&(-at * p));
            squares += row * row.transpose();
        }
    }
    let eigen = SymmetricEigen::new(squares);
    let h = eigen.eigenvectors.column(eigen.eigenvalues.imin());
    let normal = Matrix3::from_row_slice(h.as_slice());
    let whole = in_image.try_inverse()? * normal * on_plane;
    whole.iter().all(|part| part.is_finite()).then_some(whole)
}

/// Returns the focal length (in units of the image positions) that makes the columns of all homographies orthogonal and
/// equally long, with the axis through the middle. `None` if no view is tilted.
pub(crate) fn focal(homographies: &[Matrix3<f64>]) -> Option<f64> {
    let mut rows = Vec::new();
    for h in homographies {
        let h = h / h.norm();
        let [a, b] = [h.column(0), h.column(1)];
        rows.push([a.x * b.x + a.y * b.y, a.z * b.z]);
        rows.push([a.xy().norm_squared() - b.xy().norm_squared(), a.z * a.z - b.z * b.z]);
    }
    let (above, below) = rows.iter().fold((0.0, 0.0), |(above, below), [u, v]| (above - u * v, below + u * u));
    let square = above / below;
    (square > 0.0 && square.is_finite()).then(|| square.sqrt().recip())
}

/// Returns the pose of a plane whose positions (m) are seen at these positions (px) by a lens.
pub(crate) fn pose(lens: &Lens, places_m: &[Vector3<f64>], seen_px: &[Vector2<f64>]) -> Option<Isometry3<f64>> {
    let flat: Option<Vec<_>> = seen_px.iter().map(|place| lens.direction(place).map(|sight| sight.xy())).collect();
    let plane: Vec<_> = places_m.iter().map(Vector3::xy).collect();
    let h = homography(&plane, &flat?)?;
    let [a, b, c] = [0, 1, 2].map(|k| h.column(k).into_owned());
    let ahead = if c.z < 0.0 { -1.0 } else { 1.0 };
    let scale = 2.0 * ahead / (a.norm() + b.norm());
    let a = a * scale;
    let b = b * scale;
    let rough = Matrix3::from_columns(&[a, b, a.cross(&b)]);
    let rotation = nearest_rotation(&rough)?;
    let place = c * scale;
    place.iter().all(|part| part.is_finite()).then(|| Isometry3::from_parts(Translation3::from(place), rotation))
}

/// Returns the rotation nearest to a matrix.
pub(crate) fn nearest_rotation(matrix: &Matrix3<f64>) -> Option<UnitQuaternion<f64>> {
    let svd = matrix.try_svd(true, true, 1e-14, 200)?;
    let u = svd.u?;
    let v_t = svd.v_t?;
    let mut turned = Matrix3::identity();
    turned[(2, 2)] = (u * v_t).determinant().signum();
    let rotation = u * turned * v_t;
    rotation
        .iter()
        .all(|part| part.is_finite())
        .then(|| UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(rotation)))
}

/// Returns the singular values of positions about their mean, the largest first; m.
pub(crate) fn spread(places: &[Vector3<f64>]) -> [f64; 3] {
    let middle = places.iter().sum::<Vector3<f64>>() / places.len().max(1) as f64;
    let columns: Vec<Vector3<f64>> = places.iter().map(|place| place - middle).collect();
    let mut all = [0.0; 3];
    if !columns.is_empty() {
        let values = DMatrix::from_fn(3, columns.len(), |row, column| columns[column][row]).singular_values();
        for (to, value) in all.iter_mut().zip(values.iter()) {
            *to = *value;
        }
    }
    all.sort_by(|a, b| b.total_cmp(a));
    all
}
