//! The three least-squares solutions, computed by singular value decomposition instead of normal equations.

use nalgebra::{DMatrix, Matrix3, Rotation3, UnitQuaternion, Vector3};

use super::{
    model::{GravityParameters, ModelKind, TorqueParameters, matrix, paper_row},
    pose::GravityRow,
};
use crate::frames::GRAVITY_M_S2;

/// Singular values below this fraction of the largest are dropped as noise: far above the rounding of 64-bit numbers
/// (1e-16), and far below the values of any usable poses.
const RANK_FRACTION: f64 = 1e-10;

/// Fits one model to these rows; returns `None` if there are too few rows or the solution is not finite.
pub(super) fn solve(kind: ModelKind, rows: &[GravityRow], has_torque: bool) -> Option<GravityParameters> {
    match kind {
        ModelKind::Physical => physical(rows, has_torque),
        ModelKind::Gain => gain(rows, has_torque),
        ModelKind::Paper => paper(rows, has_torque),
    }
}

/// Solves `A X = B` in the least-squares sense by singular value decomposition, equivalent to the paper's
/// pseudo-inverse.
pub(super) fn least_squares(a: DMatrix<f64>, b: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let svd = a.try_svd(true, true, f64::EPSILON, 200)?;
    // Relative to the largest value, so that units do not matter.
    let cut = svd.singular_values.max() * RANK_FRACTION;
    let solution = svd.solve(b, cut).ok()?;
    solution.iter().all(|x| x.is_finite()).then_some(solution)
}

pub(super) fn forces(rows: &[GravityRow]) -> DMatrix<f64> {
    DMatrix::from_fn(rows.len(), 3, |i, j| rows[i].wrench.force_n[j])
}

pub(super) fn torques(rows: &[GravityRow]) -> DMatrix<f64> {
    DMatrix::from_fn(rows.len(), 3, |i, j| rows[i].wrench.torque_nm[j])
}

/// Solves for mass, rotation and bias: Wahba's problem with a scale (Umeyama 1991), on rows with their means
/// subtracted.
fn physical(rows: &[GravityRow], has_torque: bool) -> Option<GravityParameters> {
    let (mass_kg, s1_from_source) = scaled_rotation(rows)?;
    let (mean_force, mean_field) = means(rows);
    let bias_n = mean_force - s1_from_source * mean_field * mass_kg;
    let gain_kg = s1_from_source.matrix() * mass_kg;
    let torque = if has_torque { Some(torque(rows, &gain_kg)?) } else { None };
    let rotation = UnitQuaternion::from_rotation_matrix(&s1_from_source);
    let s1_from_source_wxyz = [rotation.w, rotation.i, rotation.j, rotation.k];
    Some(GravityParameters::Physical { mass_kg, s1_from_source_wxyz, bias_n: bias_n.into(), torque })
}

fn means(rows: &[GravityRow]) -> (Vector3<f64>, Vector3<f64>) {
    let fraction = 1.0 / rows.len() as f64;
    rows.iter().fold((Vector3::zeros(), Vector3::zeros()), |(force, field), row| {
        (force + row.wrench.force_n * fraction, field + row.field_m_s2 * fraction)
    })
}

/// Returns the scale (kg) and the proper rotation that map the centred gravity vectors to the centred forces.
pub(super) fn scaled_rotation(rows: &[GravityRow]) -> Option<(f64, Rotation3<f64>)> {
    // Three rows have nine equations for seven unknowns.
    if rows.len() < 3 {
        return None;
    }
    // Differences from the means remove the bias from the rotation.
    let (mean_force, mean_field) = means(rows);
    let mut cross = Matrix3::zeros();
    let mut power = 0.0;
    for row in rows {
        let field = row.field_m_s2 - mean_field;
        cross += (row.wrench.force_n - mean_force) * field.transpose();
        power += field.norm_squared();
    }
    // All poses in one direction do not determine a rotation.
    if power <= 0.0 {
        return None;
    }
    let svd = cross.try_svd(true, true, f64::EPSILON, 200)?;
    let u = svd.u?;
    let v_t = svd.v_t?;
    // If the best orthogonal matrix is a reflection, invert its weakest axis (singular values are sorted).
    let hand = if (u * v_t).determinant() < 0.0 { -1.0 } else { 1.0 };
    let signs = Vector3::new(1.0, 1.0, hand);
    let rotation = Rotation3::from_matrix_unchecked(u * Matrix3::from_diagonal(&signs) * v_t);
    // The scale of the least-squares similarity (Umeyama 1991).
    let mass_kg = svd.singular_values.dot(&signs) / power;
    (mass_kg.is_finite() && rotation.matrix().iter().all(|x| x.is_finite())).then_some((mass_kg.max(0.0), rotation))
}

/// Solves for a free 3x3 gain and bias; columns are divided by g to have the magnitude of the constant.
fn gain(rows: &[GravityRow], has_torque: bool) -> Option<GravityParameters> {
    if rows.len() < 4 {
        return None;
    }
    let solution = least_squares(design(rows), &forces(rows))?;
    // The columns are in units of g, so that they are near one; this converts back.
    let gain_kg: [[f64; 3]; 3] = std::array::from_fn(|i| std::array::from_fn(|j| solution[(j, i)] / GRAVITY_M_S2));
    let bias_n = std::array::from_fn(|i| solution[(3, i)]);
    let torque = if has_torque { Some(torque(rows, &matrix(&gain_kg))?) } else { None };
    Some(GravityParameters::Gain { gain_kg, bias_n, torque })
}

pub(super) fn design(rows: &[GravityRow]) -> DMatrix<f64> {
    DMatrix::from_fn(rows.len(), 4, |i, j| if j < 3 { rows[i].field_m_s2[j] / GRAVITY_M_S2 } else { 1.0 })
}

/// Solves for the paper's five columns.
fn paper(rows: &[GravityRow], has_torque: bool) -> Option<GravityParameters> {
    // The paper's matrix A has five columns.
    if rows.len() < 5 {
        return None;
    }
    let mut a = DMatrix::zeros(rows.len(), 5);
    for (i, row) in rows.iter().enumerate() {
        a.set_row(i, &paper_row(&row.field_m_s2).transpose());
    }
    let by_axis = |solution: DMatrix<f64>| -> [[f64; 5]; 3] {
        std::array::from_fn(|axis| std::array::from_fn(|c| solution[(c, axis)]))
    };
    let torque_nm = if has_torque { Some(by_axis(least_squares(a.clone(), &torques(rows))?)) } else { None };
    Some(GravityParameters::Paper { force_n: by_axis(least_squares(a, &forces(rows))?), torque_nm })
}

/// Solves for centre of mass and torque bias from `tau = com x w + tau0` with the weight `w = G u`: linear in both.
fn torque(rows: &[GravityRow], gain_kg: &Matrix3<f64>) -> Option<TorqueParameters> {
    let mut a = DMatrix::zeros(3 * rows.len(), 6);
    let mut b = DMatrix::zeros(3 * rows.len(), 1);
    // The columns of the centre of mass are of the order of the weight; the columns of the bias are scaled to match.
    let size = gain_kg.norm().max(f64::MIN_POSITIVE) * GRAVITY_M_S2 / 3_f64.sqrt();
    for (i, row) in rows.iter().enumerate() {
        let weight = gain_kg * row.field_m_s2;
        a.fixed_view_mut::<3, 3>(3 * i, 0).copy_from(&(-weight.cross_matrix()));
        a.fixed_view_mut::<3, 3>(3 * i, 3).copy_from(&(Matrix3::identity() * size));
        b.fixed_view_mut::<3, 1>(3 * i, 0).copy_from(&row.wrench.torque_nm);
    }
    let solution = least_squares(a, &b)?;
    let at = |from: usize, scale: f64| std::array::from_fn(|i| solution[(from + i, 0)] * scale);
    Some(TorqueParameters { com_m: at(0, 1.0), bias_nm: at(3, size) })
}
