//! Least squares over the horizon: fading memory, least-absolute weights, three ridges, all axes in lanes.

use super::keep;
use crate::signal::Lanes;

/// Memory of the regression, s.
const MEMORY_S: f64 = 3.0;
/// Memory of the columns' mean squares, s.
const ENERGY_MEMORY_S: f64 = 20.0;
/// Memory of the mean error that the weights refer to, s.
const ERROR_MEMORY_S: f64 = 0.5;
/// Solves of every ridge per second: parameters are never older than 5 ms.
const SOLVES_HZ: f64 = 200.0;

/// The variants of one regression: every ridge with every prefix of the columns, ridge by ridge.
#[derive(Clone, Copy, Debug)]
pub(super) struct Variants {
    /// Ridges, in seconds of typical data that say "zero": how strongly coefficients are shrunk towards delayed reflection.
    pub(super) ridges_s: &'static [f64],
    /// Nested sets of columns, by their number.
    pub(super) prefixes: &'static [usize],
}

/// Coefficients of `V` variants over `C` columns.
pub(super) type Coefficients<const C: usize, const V: usize> = [[Lanes; C]; V];

/// Coefficients of nothing.
pub(super) const fn nothing<const C: usize, const V: usize>() -> Coefficients<C, V> {
    [[Lanes::ZERO; C]; V]
}

/// Sums, mean squares and the newest solutions of a regression on `C` columns in `V` variants.
#[derive(Clone, Debug)]
pub(super) struct Learner<const C: usize, const V: usize> {
    variants: Variants,
    rate_hz: f64,
    keep: f64,
    ticks_per_solve: usize,
    seen: f64,
    /// Packed lower triangle of the columns' products, and room for its factor.
    sums: Vec<Lanes>,
    factor: Vec<Lanes>,
    right: [Lanes; C],
    energy: [Lanes; C],
    mean_error_n: f64,
    /// Solutions under way; complete at the first tick of a round.
    work: Coefficients<C, V>,
}

impl<const C: usize, const V: usize> Learner<C, V> {
    /// `variants` must make `V` of them.
    pub(super) fn new(rate_hz: f64, variants: Variants) -> Self {
        debug_assert_eq!(variants.ridges_s.len() * variants.prefixes.len(), V);
        Self {
            variants,
            rate_hz,
            keep: keep(MEMORY_S, rate_hz),
            ticks_per_solve: ((rate_hz / SOLVES_HZ).round() as usize).max(1),
            seen: 0.0,
            sums: vec![Lanes::ZERO; C * (C + 1) / 2],
            factor: vec![Lanes::ZERO; C * (C + 1) / 2],
            right: [Lanes::ZERO; C],
            energy: [Lanes::ZERO; C],
            mean_error_n: 0.0,
            work: nothing(),
        }
    }

    /// Ticks from one complete set of solutions to the next.
    pub(super) const fn ticks_per_solve(&self) -> usize {
        self.ticks_per_solve
    }

    /// The solutions of the round before.
    pub(super) const fn solutions(&self) -> &Coefficients<C, V> {
        &self.work
    }

    /// Typical size of a column so far (root mean square).
    pub(super) fn typical(&self, column: usize) -> Lanes {
        self.energy[column].sqrt()
    }

    /// Takes the columns' mean squares in: they make the ridge free of units.
    pub(super) fn measure(&mut self, columns: &[Lanes; C]) {
        self.seen += 1.0;
        let share = 1.0 / self.seen.min(ENERGY_MEMORY_S * self.rate_hz);
        for (energy, column) in self.energy.iter_mut().zip(columns) {
            *energy += (*column * *column - *energy) * share;
        }
    }

    /// Learns that `columns` came with this change of force (N); `coefficients` are the newest ones, for the weight.
    pub(super) fn learn(&mut self, columns: &[Lanes; C], change: Lanes, coefficients: &Coefficients<C, V>) {
        let expected = product(&coefficients[self.variants.prefixes.len() - 1], columns, C);
        let error_n = (change - expected).norm();
        let share = 1.0 / self.seen.min(ERROR_MEMORY_S * self.rate_hz).max(1.0);
        self.mean_error_n += (error_n - self.mean_error_n) * share;
        // Least absolute error by weights: a rare large error (the edge of a contact) must not outvote a second of ordinary motion.
        let weight = if self.mean_error_n > 0.0 { 1.0 / (error_n / self.mean_error_n + 0.5) } else { 1.0 };
        let mut start = 0;
        for (i, column) in columns.iter().enumerate() {
            let weighted = *column * weight;
            self.right[i] = self.right[i] * self.keep + weighted * change;
            for (sum, other) in self.sums[start..].iter_mut().zip(&columns[..=i]) {
                *sum = *sum * self.keep + weighted * *other;
            }
            start += i + 1;
        }
    }

    /// Solves what is due at this tick of the round, so that the work is spread evenly.
    pub(super) fn solve_due(&mut self, tick: usize) {
        let phase = tick % self.ticks_per_solve;
        let ridges = self.variants.ridges_s.len();
        for ridge in 0..ridges {
            if ridge * self.ticks_per_solve / ridges == phase {
                self.solve(ridge);
            }
        }
    }

    /// Cholesky of the sums plus this ridge; back substitution for every prefix. A column without information gets zero.
    fn solve(&mut self, ridge: usize) {
        let shrink = self.variants.ridges_s[ridge] * self.rate_hz;
        let factor = &mut self.factor;
        factor.copy_from_slice(&self.sums);
        let mut right = self.right;
        let start = |row: usize| row * (row + 1) / 2;
        for i in 0..C {
            let (above, row) = factor.split_at_mut(start(i));
            for j in 0..i {
                let other = &above[start(j)..=start(j) + j];
                let dot = row.iter().zip(&other[..j]).fold(row[j], |sum, (a, b)| sum - *a * *b);
                row[j] = dot * other[j];
            }
            let diagonal = row[..i].iter().fold(row[i] + self.energy[i] * shrink, |sum, a| sum - *a * *a);
            row[i] = diagonal.map(|d| if d > f64::MIN_POSITIVE { 1.0 / d.sqrt() } else { 0.0 });
            right[i] = row[..i].iter().zip(&right[..i]).fold(right[i], |sum, (a, z)| sum - *a * *z) * row[i];
        }
        let prefixes = self.variants.prefixes;
        for (prefix, &columns) in prefixes.iter().enumerate() {
            let solution = &mut self.work[ridge * prefixes.len() + prefix];
            *solution = [Lanes::ZERO; C];
            let mut rest = right;
            for i in (0..columns).rev() {
                let row = &factor[start(i)..=start(i) + i];
                let value = rest[i] * row[i];
                solution[i] = value;
                for (rest, a) in rest[..i].iter_mut().zip(&row[..i]) {
                    *rest -= *a * value;
                }
            }
        }
    }

    pub(super) fn reset(&mut self) {
        self.seen = 0.0;
        self.sums.fill(Lanes::ZERO);
        self.right = [Lanes::ZERO; C];
        self.energy = [Lanes::ZERO; C];
        self.mean_error_n = 0.0;
        self.work = nothing();
    }

    /// What every variant of these coefficients expects of these columns (N).
    pub(super) fn expectations(&self, coefficients: &Coefficients<C, V>, columns: &[Lanes; C]) -> [Lanes; V] {
        let prefixes = self.variants.prefixes;
        std::array::from_fn(|variant| product(&coefficients[variant], columns, prefixes[variant % prefixes.len()]))
    }
}

/// `coefficients . columns` over the first `count` columns.
pub(super) fn product(coefficients: &[Lanes], columns: &[Lanes], count: usize) -> Lanes {
    coefficients.iter().zip(columns).take(count).fold(Lanes::ZERO, |sum, (c, q)| sum + *c * *q)
}

#[cfg(test)]
mod tests {
    use super::{
        super::regressors::{REGRESSORS, VARIANTS, VARIED},
        *,
    };
    use crate::signal::LANES;

    fn fresh() -> Learner<REGRESSORS, VARIANTS> {
        Learner::new(1000.0, VARIED)
    }

    /// A column set that excites everything, deterministic.
    fn columns(i: usize) -> [Lanes; REGRESSORS] {
        std::array::from_fn(|j| {
            Lanes(std::array::from_fn(|lane| ((i * (j + 3) + 7 * lane * j) as f64 * 0.37).sin() * (1.0 + j as f64)))
        })
    }

    #[test]
    fn known_coefficients_are_found_whatever_the_units_of_a_column() {
        for unit in [1.0, 1e-6, 1e6] {
            let truth: [Lanes; REGRESSORS] = std::array::from_fn(|j| Lanes::splat((j as f64 - 9.0) / unit));
            let mut learner = fresh();
            for i in 0..5000 {
                let columns = columns(i).map(|c| c * unit);
                learner.measure(&columns);
                let newest = *learner.solutions();
                learner.learn(&columns, product(&truth, &columns, REGRESSORS), &newest);
                learner.solve_due(i);
            }
            let found = &learner.solutions()[1];
            for lane in 0..LANES {
                for j in 0..REGRESSORS {
                    let error = (found[j][lane] - truth[j][lane]) * unit;
                    assert!(error.abs() < 0.05, "unit {unit}, column {j}, lane {lane}: off by {error}");
                }
            }
        }
    }

    #[test]
    fn a_larger_ridge_gives_smaller_coefficients_and_silence_gives_none() {
        let mut learner = fresh();
        for i in 0..500 {
            let columns = columns(i);
            learner.measure(&columns);
            let newest = *learner.solutions();
            learner.learn(&columns, columns[0] + columns[3], &newest);
            learner.solve_due(i);
        }
        let size = |variant: usize| learner.solutions()[variant].iter().map(|c| c[0] * c[0]).sum::<f64>();
        assert!(size(1) > size(3) && size(3) > size(5), "{} {} {}", size(1), size(3), size(5));
        let mut silent = fresh();
        for i in 0..100 {
            let newest = *silent.solutions();
            silent.measure(&[Lanes::ZERO; REGRESSORS]);
            silent.learn(&[Lanes::ZERO; REGRESSORS], Lanes::ZERO, &newest);
            silent.solve_due(i);
        }
        assert!(silent.solutions().iter().flatten().all(|c| *c == Lanes::ZERO));
    }
}
