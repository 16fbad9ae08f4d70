//! Linear least squares over normalised columns, with a small ridge.

use nalgebra::{DMatrix, DVector};

/// Ridge as a fraction of the number of rows: columns have variance one, so directions with less variance than this are
/// shrunk.
const RIDGE: f64 = 1e-3;

/// Returns the weights `W` (`inputs x outputs`, row by row) that minimise `|y - x W|^2 + ridge |W|^2` over these rows
/// of normalised data.
///
/// ```
/// use nima_core::tip_force::linear;
///
/// // y = 2 a - b
/// let x = [1.0, 0.0, 0.0, 1.0, 1.0, 1.0, -1.0, 1.0];
/// let y = [2.0, -1.0, 1.0, -3.0];
/// let weights = linear::solve(&x, &y, (2, 1), &[0, 1, 2, 3]);
/// assert!((weights[0] - 2.0).abs() < 0.01 && (weights[1] + 1.0).abs() < 0.01, "{weights:?}");
/// ```
pub fn solve(x: &[f32], y: &[f32], (inputs, outputs): (usize, usize), rows: &[usize]) -> Vec<f32> {
    // In f64, because the sums of many rows would lose the digits of f32.
    let mut gram = DMatrix::<f64>::zeros(inputs, inputs);
    let mut right = DMatrix::<f64>::zeros(inputs, outputs);
    for row in rows {
        let x = DVector::from_iterator(inputs, x[row * inputs..(row + 1) * inputs].iter().map(|x| f64::from(*x)));
        let y = DVector::from_iterator(outputs, y[row * outputs..(row + 1) * outputs].iter().map(|y| f64::from(*y)));
        gram.ger(1.0, &x, &x, 1.0);
        right.ger(1.0, &x, &y, 1.0);
    }
    for k in 0..inputs {
        // Times the number of rows, so that the ridge does not depend on the length of a recording.
        gram[(k, k)] += RIDGE * rows.len().max(1) as f64;
    }
    // With the ridge the matrix is positive definite; if the factorisation fails anyway, the linear path is zero.
    let solved = gram.cholesky().map_or_else(|| DMatrix::zeros(inputs, outputs), |factor| factor.solve(&right));
    solved.transpose().iter().map(|w| *w as f32).collect()
}
