//! The paper's solution: a search over roll, pitch and yaw, here with the simplex method of Nelder and Mead (Comput. J.
//! 1965) from several starts. It has only the residual in common with the closed-form solution, so it can detect an
//! error in that solution.

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::{Rotation3, Vector3};

use super::solver::PushRow;

/// Starting points (roll, pitch, yaw, rad): one of them is within 90 degrees of any rotation.
const STARTS: [[f64; 3]; 6] = [
    [0.0, 0.0, 0.0],
    [PI, 0.0, 0.0],
    [0.0, 0.0, PI],
    [PI, 0.0, PI],
    [FRAC_PI_2, 0.6, -FRAC_PI_2],
    [-FRAC_PI_2, -0.6, FRAC_PI_2],
];
/// Several times what a simplex in three angles needs, so that only a flat cost reaches it.
const MAX_STEPS: usize = 400;
/// Size of a converged simplex, rad. Far below any calibration's accuracy, because the result is compared with the
/// closed form.
const FINE: f64 = 1e-9;

type EulerVertex = (Vector3<f64>, f64);

/// Returns the rotation with the smallest squared residual that the search finds.
pub(super) fn search(rows: &[PushRow]) -> Rotation3<f64> {
    let cost = |angles: &Vector3<f64>| {
        let rotation = rotation(angles);
        rows.iter().map(|row| row.residual_n(&rotation).norm_squared()).sum::<f64>()
    };
    let mut best = (Vector3::zeros(), f64::INFINITY);
    for start in STARTS {
        let found = simplex(Vector3::from(start), &cost);
        if found.1 < best.1 {
            best = found;
        }
    }
    rotation(&best.0)
}

/// Returns `Rz(yaw) Ry(pitch) Rx(roll)`, the paper's order.
fn rotation(angles: &Vector3<f64>) -> Rotation3<f64> {
    Rotation3::from_euler_angles(angles.x, angles.y, angles.z)
}

fn simplex(start: Vector3<f64>, cost: &impl Fn(&Vector3<f64>) -> f64) -> EulerVertex {
    let at = |point: Vector3<f64>| (point, cost(&point));
    let mut vertices =
        // Half a radian: large enough to leave a flat start, small compared with the distance between the starts.
        [at(start), at(start + Vector3::x() * 0.5), at(start + Vector3::y() * 0.5), at(start + Vector3::z() * 0.5)];
    for _ in 0..MAX_STEPS {
        vertices.sort_by(|a, b| a.1.total_cmp(&b.1));
        let [best, _, second_worst, worst] = vertices;
        if (worst.0 - best.0).norm() < FINE {
            break;
        }
        let centre = (vertices[0].0 + vertices[1].0 + vertices[2].0) / 3.0;
        let along = |step: f64| at(centre + (centre - worst.0) * step);
        let reflected = along(1.0);
        let replacement = if reflected.1 < best.1 {
            let expanded = along(2.0);
            if expanded.1 < reflected.1 { expanded } else { reflected }
        } else if reflected.1 < second_worst.1 {
            reflected
        } else {
            // Outside contraction if the reflected point is at least better than the worst, inside otherwise (Nelder
            // and Mead 1965).
            let contracted = along(if reflected.1 < worst.1 { 0.5 } else { -0.5 });
            if contracted.1 >= worst.1.min(reflected.1) {
                // Nothing along this line helps, so the whole simplex shrinks towards its best vertex.
                vertices = vertices.map(|vertex| at((vertex.0 + best.0) / 2.0));
                continue;
            }
            contracted
        };
        vertices[3] = replacement;
    }
    vertices.into_iter().min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or(vertices[0])
}
