//! The solvers that studies compare: one axis, degrees 1 to 5, one window of rows.
//!
//! Takes [`SolverRow`]s (motion in m, m/s, m/s²; force in N); returns a [`SolverFit`] that predicts a force (N) at any row. Nothing
//! is checked here: for a row that is not finite, or a window that does not determine the unknowns, a degree has no
//! solution or a wrong one. Finding such cases is the purpose of the studies.

use nalgebra::{DMatrix, DVector, RealField};
use nima_core::{
    impedance::{ImpedanceFactor, ImpedanceSolution, MAX_DEGREE, MOTION_COLUMNS, Scales, SlidingWindow, WindowSummary},
    signal::{Lanes, Motion},
};
use serde::Serialize;

/// Maximum number of entries in a row of the regression matrix: the constant (if the solver has one) and the motion
/// columns.
pub const MAX_COLUMNS: usize = 1 + MOTION_COLUMNS;

/// One sample of one axis, in SI units (or all lengths in another unit, with [`Scales`] in the same one).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SolverRow {
    /// Position, velocity, acceleration in the workspace, relative to its fixed origin.
    pub position: [f64; 3],
    /// The paper's `u`: the change of each quantity over one window length.
    pub increment: [f64; 3],
    pub force_n: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum LeastSquaresSolver {
    /// The paper's `M = F X^T (X X^T)^-1` with an explicit inverse, everything rounded to f32.
    #[serde(rename = "literal-f32")]
    LiteralF32,
    /// The same in f64.
    #[serde(rename = "literal-f64")]
    LiteralF64,
    /// `M = F X^+` on the paper's columns, by singular value decomposition; singular values below [`CUT_OFF`] of the
    /// largest are dropped.
    PseudoInverse,
    /// A new QR factorisation of the scaled columns with a constant, without a ridge.
    FreshQr,
    /// The solver of this project: scaled columns, a constant and a ridge, from a triangular factor that is updated
    /// while the window moves.
    Sliding,
}

/// Relative cut-off of the pseudo-inverse. The textbook choice (numpy, Matlab) is the number of rows times the rounding
/// unit, here for 300 rows.
pub const CUT_OFF: f64 = 300.0 * f64::EPSILON;

impl LeastSquaresSolver {
    /// Every solver, the paper's first.
    pub const ALL: [Self; 5] = [Self::LiteralF32, Self::LiteralF64, Self::PseudoInverse, Self::FreshQr, Self::Sliding];

    pub const fn name(self) -> &'static str {
        match self {
            Self::LiteralF32 => "literal-f32",
            Self::LiteralF64 => "literal-f64",
            Self::PseudoInverse => "pseudo-inverse",
            Self::FreshQr => "fresh-qr",
            Self::Sliding => "sliding",
        }
    }

    /// Returns whether the columns are the paper's (increments in SI units, no constant) or this project's (positions,
    /// scaled, a constant).
    pub const fn is_paper(self) -> bool {
        matches!(self, Self::LiteralF32 | Self::LiteralF64 | Self::PseudoInverse)
    }

    pub const fn unknowns(self, degree: usize) -> usize {
        if self.is_paper() { 3 * degree } else { 1 + 3 * degree }
    }

    /// Returns the columns of `row` for `degree`; the unused entries are zero.
    pub fn columns(self, row: &SolverRow, degree: usize, scales: &Scales) -> [f64; MAX_COLUMNS] {
        const SI: Scales = Scales { position_m: 1.0, velocity_m_s: 1.0, acceleration_m_s2: 1.0, force_n: 1.0 };
        let [x, v, a] = if self.is_paper() { row.increment } else { row.position }.map(Lanes::splat);
        let motion = Motion { x, v, a };
        let mut columns = [0.0; MAX_COLUMNS];
        if self.is_paper() {
            let features = SI.features(&motion, degree);
            columns.iter_mut().zip(features).for_each(|(column, feature)| *column = feature[0]);
        } else {
            columns[0] = 1.0;
            let features = scales.features(&motion, degree);
            columns[1..].iter_mut().zip(features).for_each(|(column, feature)| *column = feature[0]);
        }
        columns
    }

    /// Fits degrees `1..=max_degree` to `rows`. Only [`LeastSquaresSolver::Sliding`] uses `ridge` (per row, see
    /// [`nima_core::impedance::ImpedanceSettings`]).
    ///
    /// [`LeastSquaresSolver::Sliding`] adds the rows to a new factor here; [`SlidingSolver`] keeps its factor from tick to tick.
    ///
    /// ```
    /// use nima_core::impedance::Scales;
    /// use nima_study::solvers::{SolverRow, LeastSquaresSolver};
    ///
    /// // A spring of 200 N/m with an offset of 3 N.
    /// let row = |k: u32| {
    ///     let t = 0.01 * f64::from(k);
    ///     let position = [0.02 * (3.0 * t).sin(), 0.06 * (5.0 * t).cos(), 0.3 * (7.0 * t).sin()];
    ///     SolverRow { position, increment: position, force_n: 3.0 - 200.0 * position[0] }
    /// };
    /// let rows: Vec<SolverRow> = (0..300).map(row).collect();
    /// let fit = LeastSquaresSolver::FreshQr.fit(&rows, 1, &Scales::default(), 0.0);
    /// let later = row(310);
    /// let predicted_n = fit.predict(&later)[0].expect("the rows determine degree 1");
    /// assert!((predicted_n - later.force_n).abs() < 1e-9);
    /// ```
    pub fn fit(self, rows: &[SolverRow], max_degree: usize, scales: &Scales, ridge: f64) -> SolverFit {
        let max_degree = max_degree.clamp(1, MAX_DEGREE);
        let mut fit = SolverFit::none(self, *scales);
        if self == Self::Sliding {
            let columns = self.unknowns(max_degree);
            let mut factor = ImpedanceFactor::with_ridge(columns, ridge * rows.len() as f64);
            for row in rows {
                factor.add(&sliding_row(row, max_degree, scales));
            }
            let mut solution = ImpedanceSolution::new(columns);
            solution.solve(&factor);
            fit.take(&solution, max_degree);
            return fit;
        }
        let forces = DVector::from_iterator(rows.len(), rows.iter().map(|row| row.force_n));
        let columns: Vec<_> = rows.iter().map(|row| self.columns(row, max_degree, scales)).collect();
        let full = DMatrix::from_fn(rows.len(), self.unknowns(max_degree), |i, j| columns[i][j]);
        if self == Self::FreshQr {
            fit.coefficients = fresh_qr(full, &forces, max_degree);
            return fit;
        }
        for degree in 1..=max_degree {
            let x = full.columns(0, self.unknowns(degree)).into_owned();
            let found = match self {
                Self::LiteralF32 => explicit_inverse(&x.map(|x| x as f32), &forces.map(|f| f as f32))
                    .map(|m| m.iter().map(|m| f64::from(*m)).collect()),
                Self::LiteralF64 => explicit_inverse(&x, &forces).map(|m| m.as_slice().to_vec()),
                _ => pseudo_inverse(x, &forces),
            };
            fit.coefficients[degree - 1] = found;
        }
        fit
    }
}

/// Coefficients of every degree fitted to one window.
#[derive(Clone, Debug)]
pub struct SolverFit {
    solver: LeastSquaresSolver,
    scales: Scales,
    coefficients: [Option<Vec<f64>>; MAX_DEGREE],
}

impl SolverFit {
    fn none(solver: LeastSquaresSolver, scales: Scales) -> Self {
        Self { solver, scales, coefficients: [const { None }; MAX_DEGREE] }
    }

    fn take(&mut self, solution: &ImpedanceSolution, max_degree: usize) {
        for degree in 1..=max_degree {
            let columns = self.solver.unknowns(degree);
            let found = solution.coefficients(columns)[..columns].iter().map(|m| m[0]).collect();
            self.coefficients[degree - 1] = Some(found);
        }
    }

    /// Returns the coefficients of `degree` in the solver's own columns; `None` if the solver found no solution.
    pub fn coefficients(&self, degree: usize) -> Option<&[f64]> {
        self.coefficients.get(degree.wrapping_sub(1))?.as_deref()
    }

    /// Returns the force (N) predicted at `at` by every degree: `None` without a solution or if the prediction is not
    /// finite.
    pub fn predict(&self, at: &SolverRow) -> [Option<f64>; MAX_DEGREE] {
        let columns = self.solver.columns(at, MAX_DEGREE, &self.scales);
        std::array::from_fn(|i| {
            let m = self.coefficients[i].as_ref()?;
            let force: f64 = if self.solver == LeastSquaresSolver::LiteralF32 {
                f64::from(m.iter().zip(columns).map(|(m, column)| *m as f32 * column as f32).sum::<f32>())
            } else {
                m.iter().zip(columns).map(|(m, column)| m * column).sum()
            };
            force.is_finite().then_some(force)
        })
    }
}

/// This project's solver as the loop runs it: one row per tick, at a cost independent of the window's length.
#[derive(Clone, Debug)]
pub struct SlidingSolver {
    window: SlidingWindow<ImpedanceFactor>,
    solution: ImpedanceSolution,
    max_degree: usize,
    scales: Scales,
}

impl SlidingSolver {
    /// Creates a window of `2 * block` rows.
    pub fn new(block: usize, max_degree: usize, scales: Scales, ridge: f64) -> Self {
        let max_degree = max_degree.clamp(1, MAX_DEGREE);
        let columns = LeastSquaresSolver::Sliding.unknowns(max_degree);
        let prior = ImpedanceFactor::with_ridge(columns, ridge * 2.0 * block as f64);
        let window = SlidingWindow::new(block, ImpedanceFactor::new(columns), prior);
        Self { window, solution: ImpedanceSolution::new(columns), max_degree, scales }
    }

    /// Adds the newest row and solves. `None` for a rejected sample, which occupies its time in the window without
    /// data.
    pub fn push(&mut self, row: Option<&SolverRow>) {
        let row = row.map_or(ImpedanceFactor::BLANK_ROW, |row| sliding_row(row, self.max_degree, &self.scales));
        self.window.push(&row);
        self.solution.solve(self.window.current());
    }

    /// Returns the newest solutions.
    pub fn fit(&self) -> SolverFit {
        let mut fit = SolverFit::none(LeastSquaresSolver::Sliding, self.scales);
        fit.take(&self.solution, self.max_degree);
        fit
    }

    /// Returns the condition number (Frobenius) of the scaled columns of `degree` with their ridge.
    pub fn condition(&self, degree: usize) -> f64 {
        self.solution.condition(LeastSquaresSolver::Sliding.unknowns(degree))[0]
    }

    /// Returns the numerical rank of `degree`: columns, including the constant, whose part orthogonal to the previous
    /// columns is larger than the ridge.
    pub fn rank(&self, degree: usize, ridge: f64) -> usize {
        let ridge = ridge * self.window.len() as f64;
        let factor = self.window.current();
        let outweighs = |j: &usize| {
            let own = factor.column(*j)[*j][0].powi(2);
            if *j == 0 { own > 0.0 } else { own > 2.0 * ridge }
        };
        (0..LeastSquaresSolver::Sliding.unknowns(degree)).filter(outweighs).count()
    }
}

fn sliding_row(row: &SolverRow, degree: usize, scales: &Scales) -> <ImpedanceFactor as WindowSummary>::Row {
    let mut entries = ImpedanceFactor::BLANK_ROW;
    let columns = LeastSquaresSolver::Sliding.columns(row, degree, scales);
    entries.iter_mut().zip(columns).for_each(|(entry, column)| entry[0] = column);
    entries[LeastSquaresSolver::Sliding.unknowns(degree)][0] = row.force_n;
    entries
}

/// `(X X^T)^-1 X f` with `X^T = x`, as printed in the paper; `None` if the matrix cannot be inverted in floating point.
fn explicit_inverse<T: RealField>(x: &DMatrix<T>, f: &DVector<T>) -> Option<DVector<T>> {
    let inverse = x.tr_mul(x).try_inverse()?;
    Some(inverse * x.tr_mul(f))
}

/// `x^+ f` without the singular values below the cut-off; `None` if a number is not finite, because the iteration would
/// then not end.
fn pseudo_inverse(x: DMatrix<f64>, f: &DVector<f64>) -> Option<Vec<f64>> {
    if !x.iter().chain(f.iter()).all(|entry| entry.is_finite()) {
        return None;
    }
    let svd = x.svd(true, true);
    let cut_off = CUT_OFF * svd.singular_values.max();
    Some(svd.solve(f, cut_off).ok()?.as_slice().to_vec())
}

/// Solves all degrees with one Householder factorisation; `None` with fewer rows than unknowns or a zero on the
/// diagonal.
fn fresh_qr(x: DMatrix<f64>, f: &DVector<f64>, max_degree: usize) -> [Option<Vec<f64>>; MAX_DEGREE] {
    let (rows, unknowns) = x.shape();
    let mut right = f.clone();
    let qr = x.qr();
    qr.q_tr_mul(&mut right);
    let r = qr.unpack_r();
    std::array::from_fn(|i| {
        let columns = LeastSquaresSolver::FreshQr.unknowns(i + 1);
        if i >= max_degree || columns > rows || columns > unknowns {
            return None;
        }
        let leading = r.view((0, 0), (columns, columns));
        let m = leading.solve_upper_triangular(&right.rows(0, columns))?;
        Some(m.as_slice().to_vec())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a motion that excites every column.
    fn rows(count: usize) -> Vec<SolverRow> {
        (0..count)
            .map(|k| {
                let t = k as f64 * 0.37;
                let position = [0.1 * t.sin(), 0.2 * (1.7 * t).cos(), 4.0 * (2.9 * t + 1.0).sin()];
                let force_n = 300.0 * position[0] + 5.0 * position[1] + 0.1 * position[2] * position[2];
                SolverRow { position, increment: position, force_n }
            })
            .collect()
    }

    #[test]
    fn all_agree_where_the_problem_is_well_conditioned() {
        let rows = rows(300);
        let scales = Scales::default();
        let at = SolverRow { force_n: 0.0, ..rows[123] };
        for solver in LeastSquaresSolver::ALL {
            let predicted = solver.fit(&rows, 5, &scales, 0.0).predict(&at);
            let tolerance = if solver == LeastSquaresSolver::LiteralF32 { 1e-2 } else { 1e-9 };
            for degree in 2..=3 {
                let found = predicted[degree - 1].unwrap();
                assert!((found - rows[123].force_n).abs() < tolerance, "{} N={degree}: {found}", solver.name());
            }
        }
    }

    #[test]
    fn slid_and_fresh_are_the_same() {
        let rows = rows(700);
        let scales = Scales::default();
        let mut sliding = SlidingSolver::new(150, 5, scales, 1e-6);
        for k in 0..rows.len() {
            sliding.push(Some(&rows[k]));
            if k >= 299 && k % 37 == 0 {
                let fresh = LeastSquaresSolver::Sliding.fit(&rows[k - 299..=k], 5, &scales, 1e-6).predict(&rows[k]);
                for (slid, fresh) in sliding.fit().predict(&rows[k]).into_iter().zip(fresh) {
                    assert!((slid.unwrap() - fresh.unwrap()).abs() < 1e-10);
                }
            }
        }
        assert_eq!(sliding.rank(5, 1e-6), 16);
    }

    #[test]
    fn what_cannot_be_solved_has_no_answer() {
        let still = vec![SolverRow { force_n: 1.0, ..SolverRow::default() }; 50];
        let scales = Scales::default();
        assert_eq!(LeastSquaresSolver::LiteralF64.fit(&still, 5, &scales, 0.0).predict(&still[0]), [None; 5]);
        let ours = LeastSquaresSolver::Sliding.fit(&still, 5, &scales, 1e-6).predict(&still[0]);
        assert!(ours.iter().all(|force| (force.unwrap() - 1.0).abs() < 1e-12));
        let mut bad = rows(50);
        bad[7].increment[1] = f64::NAN;
        assert_eq!(LeastSquaresSolver::PseudoInverse.fit(&bad, 2, &scales, 0.0).predict(&bad[0])[..2], [None; 2]);
    }
}
