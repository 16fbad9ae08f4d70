//! Determines how well the poses determine a model: coverage for the operator, condition number for the mathematics.

use nalgebra::Vector3;

use super::{pose::GravityRow, solve::design};

/// Cosine of the angle up to which a pose covers a direction: 45 degrees.
const REACH_COS: f64 = std::f64::consts::FRAC_1_SQRT_2;
/// Number of points of the uniform grid on the sphere: one per 0.06 sr, so that a covered cone of 45 degrees contains
/// about 30 of them.
const POINTS: usize = 200;

/// Returns the fraction (0 to 1) of all directions of gravity in the sensor's frame that are within 45 degrees of a
/// pose. The twelve targets of a session give 1; twelve random directions about 0.85; a shaft tilted by up to 30
/// degrees in all directions 0.37.
pub(super) fn coverage(rows: &[GravityRow]) -> f64 {
    let directions: Vec<Vector3<f64>> = rows.iter().filter_map(|row| row.field_m_s2.try_normalize(0.0)).collect();
    let reached = (0..POINTS).map(point).filter(|point| directions.iter().any(|d| d.dot(point) >= REACH_COS)).count();
    reached as f64 / POINTS as f64
}

/// Returns point `i` of a spherical Fibonacci grid with nearly equal areas (Swinbank and Purser 2006).
fn point(i: usize) -> Vector3<f64> {
    // A Fibonacci grid: equal steps in height, turned by the golden angle.
    let z = 1.0 - (2.0 * i as f64 + 1.0) / POINTS as f64;
    let turn = std::f64::consts::PI * (3.0 - 5_f64.sqrt()) * i as f64;
    let radius = (1.0 - z * z).sqrt();
    Vector3::new(radius * libm::cos(turn), radius * libm::sin(turn), z)
}

/// Returns the condition number of the rows `(u / g, 1)`: 1.7 for directions all over the sphere; larger if they lie in
/// a cone or plane; infinite if they do not determine the model.
pub(super) fn condition(rows: &[GravityRow]) -> f64 {
    // Three columns of the gain and one of the bias need four rows.
    if rows.len() < 4 {
        return f64::INFINITY;
    }
    let values = design(rows).singular_values();
    if values.min() > 0.0 { values.max() / values.min() } else { f64::INFINITY }
}
