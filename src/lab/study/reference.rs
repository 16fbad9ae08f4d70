//! Least squares in arbitrary precision: the exact answer with which the solvers are compared.
//!
//! Takes exact copies of the f64 rows that a solver was given; returns the force (N) of the exact minimiser, of minimum
//! norm if the rows do not determine it, rounded to f64 once at the end.

use dashu_float::{Context, FBig, Repr, ops::Abs as _, round::mode::HalfEven};

type Big = FBig<HalfEven, 2>;

/// Significant bits of every step. A product of two f64 has 106; sums of such products over columns between 1e-40 and
/// 1e40 are exact.
pub const PRECISION_BITS: usize = 768;
/// A pivot below `2^-DEPENDENT_BITS` of its column means an exact dependence; rounded data leave at least about
/// `2^-110`.
const DEPENDENT_BITS: isize = 400;

/// The normal equations of a window, factorised as `L D L'`. They square the condition number, which is harmless at
/// this precision.
pub struct Reference {
    lower: Vec<Vec<Big>>,
    pivots: Vec<Option<Big>>,
    /// `D^-1 L^-1 X f`; zero where the pivot is zero.
    right: Vec<Big>,
}

impl Reference {
    /// Takes rows of `unknowns` columns with the force as an additional column. `ridge_root` is the square root of the
    /// ridge on every unknown but the first (0: none). `None` if an entry is not finite.
    pub fn new(rows: &[Vec<f64>], unknowns: usize, ridge_root: f64) -> Option<Self> {
        let mut gram = vec![vec![zero(); unknowns + 1]; unknowns + 1];
        for row in rows {
            let row = row.iter().map(|entry| big(*entry)).collect::<Option<Vec<_>>>()?;
            for j in 0..=unknowns {
                for k in 0..=j {
                    gram[j][k] += &row[j] * &row[k];
                }
            }
        }
        let ridge_root = big(ridge_root)?;
        for j in 1..unknowns {
            gram[j][j] += &ridge_root * &ridge_root;
        }
        Some(Self::factorise(&gram, unknowns))
    }

    fn factorise(gram: &[Vec<Big>], unknowns: usize) -> Self {
        let mut lower = vec![vec![zero(); unknowns]; unknowns + 1];
        let mut pivots: Vec<Option<Big>> = Vec::with_capacity(unknowns);
        for j in 0..=unknowns {
            // First compute row j of L D, then row j of L.
            let mut scaled: Vec<Big> = Vec::with_capacity(j);
            for k in 0..j.min(unknowns) {
                let known = (0..k).fold(zero(), |sum, i| sum + &scaled[i] * &lower[k][i]);
                scaled.push(&gram[j][k] - known);
            }
            for k in 0..scaled.len() {
                lower[j][k] = pivots[k].as_ref().map_or_else(zero, |pivot| &scaled[k] / pivot);
            }
            if j < unknowns {
                let known = (0..j).fold(zero(), |sum, i| sum + &scaled[i] * &lower[j][i]);
                let pivot = &gram[j][j] - known;
                let independent = pivot.clone().abs() > (gram[j][j].clone() >> DEPENDENT_BITS);
                pivots.push(independent.then_some(pivot));
            }
        }
        let right = lower.pop().unwrap_or_default();
        Self { lower, pivots, right }
    }

    /// Returns how many of the first `prefix` columns depend linearly on earlier ones.
    pub fn rank(&self, prefix: usize) -> usize {
        self.pivots.iter().take(prefix).flatten().count()
    }

    /// Returns the exact solution with the first `prefix` columns, with minimum norm if there are several.
    fn solution(&self, prefix: usize) -> Vec<Big> {
        let independent: Vec<usize> = (0..prefix).filter(|&k| self.pivots[k].is_some()).collect();
        // The rows of R = L' with a nonzero pivot: R m = right. With W = R R' : m = R' W^-1 right.
        let row = |k: usize| (0..prefix).map(move |j| if j == k { big_one() } else { self.lower[j][k].clone() });
        if independent.len() == prefix {
            let mut m = self.right[..prefix].to_vec();
            for k in (0..prefix).rev() {
                for j in k + 1..prefix {
                    let part = &self.lower[j][k] * &m[j];
                    m[k] -= part;
                }
            }
            return m;
        }
        let r: Vec<Vec<Big>> = independent
            .iter()
            .map(|&k| row(k).enumerate().map(|(j, entry)| if j < k { zero() } else { entry }).collect())
            .collect();
        let n = r.len();
        let mut system = vec![vec![zero(); n + 1]; n + 1];
        for j in 0..n {
            for k in 0..=j {
                system[j][k] = r[j].iter().zip(&r[k]).fold(zero(), |sum, (a, b)| sum + a * b);
            }
            system[n][j].clone_from(&self.right[independent[j]]);
        }
        let weights = Self::factorise(&system, n).solution(n);
        (0..prefix).map(|j| (0..n).fold(zero(), |sum, i| sum + &r[i][j] * &weights[i])).collect()
    }

    /// Returns the force (N) at each of `at` (rows of columns), using the first `prefix` columns; `None` for a row that
    /// is not finite.
    pub fn predict(&self, prefix: usize, at: &[Vec<f64>]) -> Vec<Option<f64>> {
        let m = self.solution(prefix);
        let force = |row: &Vec<f64>| {
            let mut sum = zero();
            for (m, entry) in m.iter().zip(row) {
                sum += m * big(*entry)?;
            }
            Some(sum.to_f64().value())
        };
        at.iter().map(force).collect()
    }
}

/// Returns a finite f64, exactly.
fn big(value: f64) -> Option<Big> {
    if !value.is_finite() {
        return None;
    }
    // Treat negative zero as zero; its sign does not matter.
    let repr = Repr::try_from(if value == 0.0 { 0.0 } else { value }).ok()?;
    Some(Big::from_repr(repr, Context::new(PRECISION_BITS)))
}

fn zero() -> Big {
    Big::from_repr(Repr::zero(), Context::new(PRECISION_BITS))
}

fn big_one() -> Big {
    Big::from_repr(Repr::one(), Context::new(PRECISION_BITS))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    fn rows(count: usize, duplicate: bool) -> Vec<Vec<f64>> {
        let row = |k: usize| {
            let t = k as f64 * 0.61;
            let a = t.sin();
            let b = (1.3 * t).cos();
            vec![1.0, a, if duplicate { 2.0 * a } else { a * b }, b, 0.5 + a - 2.0 * b + 0.1 * (7.0 * t).sin()]
        };
        (0..count).map(row).collect()
    }

    #[test]
    fn agrees_with_singular_values_where_they_are_good() {
        for duplicate in [false, true] {
            let rows = rows(40, duplicate);
            let reference = Reference::new(&rows, 4, 0.0).unwrap();
            assert_eq!(reference.rank(4), if duplicate { 3 } else { 4 });
            // Evaluate outside the span of the rows, too, because the minimum-norm solution is unique.
            let at = vec![vec![1.0, 0.3, -0.4, 0.7], vec![0.0, 1.0, 0.0, 0.0]];
            for prefix in 1..=4 {
                let x = DMatrix::from_fn(40, prefix, |i, j| rows[i][j]);
                let f = DVector::from_fn(40, |i, _| rows[i][4]);
                let m = x.svd(true, true).solve(&f, 1e-12).unwrap();
                for (at, found) in at.iter().zip(reference.predict(prefix, &at)) {
                    let expected: f64 = m.iter().zip(at).map(|(m, at)| m * at).sum();
                    assert!((found.unwrap() - expected).abs() < 1e-12, "{prefix}: {found:?} is not {expected}");
                }
            }
        }
    }

    #[test]
    fn knows_the_exact_answer_of_a_hilbert_problem() {
        // Powers of i/64 are exact in f64, and the force is an exact polynomial: it must be recovered to the last
        // digit.
        let rows: Vec<Vec<f64>> = (0..64)
            .map(|i| {
                let x = f64::from(i) / 64.0;
                let powers: Vec<f64> = (0..8).map(|p| x.powi(p)).collect();
                let force = powers[7] + powers[0];
                powers.into_iter().chain([force]).collect()
            })
            .collect();
        let reference = Reference::new(&rows, 8, 0.0).unwrap();
        let found = reference.predict(8, &[vec![0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]]);
        assert_eq!(found, [Some(1.0)]);
        assert_eq!(reference.predict(8, &[vec![f64::NAN; 8]]), [None]);
        assert!(Reference::new(&[vec![1.0, f64::INFINITY]], 1, 0.0).is_none());
    }

    #[test]
    fn a_ridge_pulls_towards_zero() {
        let rows = vec![vec![1.0, 1.0, 3.0], vec![1.0, -1.0, 1.0]];
        let reference = Reference::new(&rows, 2, 2.0_f64.sqrt()).unwrap();
        let found = reference.predict(2, &[vec![0.0, 1.0]])[0].unwrap();
        assert!((found - 0.5).abs() < 1e-15, "{found}");
    }
}
