//! Recursive least squares with exponential forgetting, in information form, for three axes at once.

use nima_core::signal::{Lanes, NOTHING};

use crate::kept;

/// Memory of the columns' mean squares, which make the ridge independent of units (s): longer than the memory of the
/// fit, so that a pause in the motion does not change the ridge.
const SQUARES_S: f64 = 20.0;

/// Minimises `sum_i kept^(t-i) (y_i - theta q_i)^2`: the information matrix `R = kept R + q q'` and the vector
/// `kept z + q y` are updated, and `theta` follows from a Cholesky factorisation (Ljung, System Identification, 1999,
/// section 11.2). A ridge in proportion to each column's own mean square, towards the prior parameters, replaces the
/// inverse of the initial covariance and is not forgotten: without motion the covariance of the usual recursion grows
/// without bound.
#[derive(Clone, Debug)]
pub(crate) struct Rls<const N: usize> {
    kept: f64,
    ridge: f64,
    squares_ticks: f64,
    seen: f64,
    /// Lower triangle.
    gram: [[Lanes; N]; N],
    right: [Lanes; N],
    squares: [Lanes; N],
}

impl<const N: usize> Rls<N> {
    /// Creates a memory (s), and a ridge in seconds of typical columns that say "as before".
    pub(crate) fn new(memory_s: f64, ridge_s: f64, rate_hz: f64) -> Self {
        Self {
            kept: kept(memory_s, rate_hz),
            ridge: ridge_s * rate_hz,
            squares_ticks: SQUARES_S * rate_hz,
            seen: 0.0,
            gram: [[Lanes::ZERO; N]; N],
            right: [Lanes::ZERO; N],
            squares: [Lanes::ZERO; N],
        }
    }

    /// Adds the columns `q` of one sample and its target.
    pub(crate) fn learn(&mut self, q: &[Lanes; N], target: Lanes) {
        self.seen = (self.seen + 1.0).min(self.squares_ticks);
        let fraction = 1.0 / self.seen;
        for (j, row) in self.gram.iter_mut().enumerate() {
            for (sum, column) in row.iter_mut().zip(q).take(j + 1) {
                *sum = (*sum * self.kept + q[j] * *column).settled();
            }
            self.right[j] = (self.right[j] * self.kept + q[j] * target).settled();
            self.squares[j] = (self.squares[j] + (q[j] * q[j] - self.squares[j]) * fraction).settled();
        }
    }

    /// Converts the samples to other units: column `j` is multiplied by `factors[j]`.
    pub(crate) fn rescale(&mut self, factors: &[Lanes; N]) {
        for (j, factor) in factors.iter().enumerate() {
            for (sum, other) in self.gram[j].iter_mut().zip(factors).take(j + 1) {
                *sum = *sum * *factor * *other;
            }
            self.right[j] *= *factor;
            self.squares[j] = self.squares[j] * *factor * *factor;
        }
    }

    /// Returns the parameters, shrunk towards `prior`; that itself where nothing is known.
    pub(crate) fn solve(&self, prior: &[Lanes; N]) -> [Lanes; N] {
        let mut factor = [[Lanes::ZERO; N]; N];
        let mut inverse = [Lanes::ZERO; N];
        let mut z = [Lanes::ZERO; N];
        for j in 0..N {
            let mut rest = self.right[j];
            for (k, prior) in prior.iter().enumerate() {
                rest -= self.gram[j.max(k)][j.min(k)] * *prior;
            }
            let mut pivot = self.gram[j][j] + self.squares[j] * self.ridge;
            for k in 0..j {
                let known = dot(&factor[j][..k], &factor[k][..k]);
                let entry = (self.gram[j][k] - known) * inverse[k];
                factor[j][k] = entry;
                pivot -= entry * entry;
                rest -= entry * z[k];
            }
            inverse[j] = pivot.map(|pivot| if pivot > NOTHING { 1.0 / pivot.sqrt() } else { 0.0 });
            z[j] = rest * inverse[j];
        }
        let mut parameters = [Lanes::ZERO; N];
        for j in (0..N).rev() {
            let later = (j + 1..N).fold(Lanes::ZERO, |sum, i| sum + factor[i][j] * parameters[i]);
            parameters[j] = (z[j] - later) * inverse[j];
        }
        parameters.iter_mut().zip(prior).for_each(|(parameter, prior)| *parameter += *prior);
        parameters
    }

    pub(crate) fn reset(&mut self) {
        self.seen = 0.0;
        self.gram = [[Lanes::ZERO; N]; N];
        self.right = [Lanes::ZERO; N];
        self.squares = [Lanes::ZERO; N];
    }
}

/// Returns the sum of the products of the entries.
pub(crate) fn dot(a: &[Lanes], b: &[Lanes]) -> Lanes {
    a.iter().zip(b).fold(Lanes::ZERO, |sum, (a, b)| sum + *a * *b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_finds_the_parameters_in_any_units() {
        for unit in [1.0, 1e-6, 1e6] {
            let mut rls = Rls::<2>::new(0.5, 1e-6, 1000.0);
            for k in 0..1000 {
                let t = f64::from(k) * 1e-3;
                let q = [Lanes::splat(unit * (9.0 * t).sin()), Lanes::splat((23.0 * t).cos())];
                rls.learn(&q, q[0] * (3.0 / unit) - q[1] * 0.5);
            }
            let [a, b] = rls.solve(&[Lanes::ZERO; 2]);
            assert!((a[0] * unit - 3.0).abs() < 1e-3 && (b[0] + 0.5).abs() < 1e-3, "{a:?} {b:?}");
            rls.rescale(&[Lanes::splat(2.0), Lanes::splat(1.0)]);
            assert!((rls.solve(&[Lanes::ZERO; 2])[0][0] * unit - 1.5).abs() < 1e-3);
        }
    }

    #[test]
    fn nothing_known_is_the_prior_and_rest_does_not_wind_up() {
        let mut rls = Rls::<2>::new(0.1, 1e-3, 1000.0);
        let prior = [Lanes::splat(1.0), Lanes::splat(-2.0)];
        assert_eq!(rls.solve(&prior), prior);
        for k in 0..200_000 {
            let q = if k < 500 { f64::from(k % 7) - 3.0 } else { 0.0 };
            rls.learn(&[Lanes::splat(q), Lanes::splat(1.0)], Lanes::splat(2.0 * q + 1.0));
        }
        let [_, constant] = rls.solve(&prior);
        assert!(rls.solve(&prior).iter().all(|p| p.is_finite()) && (constant[0] - 1.0).abs() < 0.1, "{constant:?}");
    }
}
