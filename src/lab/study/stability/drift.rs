//! Long run: whether samples that have left the window leave a numerical error.

use nalgebra::{DMatrix, DVector};
use nima_core::impedance::{ImpedanceSettings, MAX_DEGREE, Scales};
use serde::Serialize;

use super::super::{
    reference::Reference,
    solvers::{LeastSquaresSolver, MAX_COLUMNS, SlidingSolver, SolverRow},
};

/// Rows of the motion, which repeats; a multiple of the block length, so that windows recur exactly.
const TABLE: usize = 3000;
const BLOCK: usize = 150;
const EARLY: u64 = 1000;
/// Number of ticks compared, early and late.
const LOOKS: u64 = 20;
/// A row with values 20 times too large: subtracting it from a running sum leaves a rounding error.
const SPIKE: usize = 1500;

/// Worst relative error of the predicted force at degree 5, early and late in the long run.
#[derive(Clone, Debug, Serialize)]
pub struct StabilityDrift {
    /// Ticks run; the last multiple of the motion's period plus 1000.
    pub ticks: u64,
    /// This project's solver after 1000 ticks.
    pub ours_early: f64,
    /// This project's solver after all ticks, at the same phase of the motion.
    pub ours_late: f64,
    /// For comparison: running sums of the normal equations, with each leaving row subtracted, after 1000 ticks.
    pub running_sums_early: f64,
    /// The same after all ticks; `None` if there was no finite answer.
    pub running_sums_late: Option<f64>,
}

fn table() -> Vec<SolverRow> {
    let mut noise = fastrand::Rng::with_seed(11);
    (0..TABLE)
        .map(|k| {
            let t = k as f64 * 1e-3;
            let mut position = [0.03, 0.15, 2.0];
            for (i, size) in position.iter_mut().enumerate() {
                let phase = i as f64;
                *size *= (5.0 * t + phase).sin() + 0.3 * (31.0 * t + 2.0 * phase).cos();
                *size *= if k == SPIKE { 20.0 } else { 1.0 };
            }
            let force_n = 300.0 * position[0] + 8.0 * position[1] + 0.2 * position[2] + 0.01 * noise.f64();
            SolverRow { position, increment: position, force_n }
        })
        .collect()
}

/// Running sums of products; one row is added and one subtracted in each tick.
struct RunningSums {
    sums: [[f64; MAX_COLUMNS + 1]; MAX_COLUMNS + 1],
}

impl RunningSums {
    fn add(&mut self, row: &[f64; MAX_COLUMNS + 1], sign: f64) {
        for (sums, left) in self.sums.iter_mut().zip(row) {
            for (sum, right) in sums.iter_mut().zip(row) {
                *sum += sign * left * right;
            }
        }
    }

    fn predict(&self, ridge: f64, at: &[f64]) -> Option<f64> {
        let gram = DMatrix::from_fn(MAX_COLUMNS, MAX_COLUMNS, |i, j| {
            self.sums[i][j] + if i == j && i > 0 { ridge } else { 0.0 }
        });
        let right = DVector::from_fn(MAX_COLUMNS, |i, _| self.sums[i][MAX_COLUMNS]);
        let m = gram.lu().solve(&right)?;
        let force: f64 = m.iter().zip(at).map(|(m, at)| m * at).sum();
        force.is_finite().then_some(force)
    }
}

pub(super) fn run(ticks: u64) -> StabilityDrift {
    let ticks = ticks - (ticks - EARLY) % TABLE as u64;
    let scales = Scales::default();
    let ridge = ImpedanceSettings::default().ridge;
    let rows = table();
    let columns: Vec<[f64; MAX_COLUMNS + 1]> = rows
        .iter()
        .map(|row| {
            let columns = LeastSquaresSolver::Sliding.columns(row, MAX_DEGREE, &scales);
            std::array::from_fn(|j| columns.get(j).copied().unwrap_or(row.force_n))
        })
        .collect();
    let mut sliding = SlidingSolver::new(BLOCK, MAX_DEGREE, scales, ridge);
    let mut running = RunningSums { sums: [[0.0; MAX_COLUMNS + 1]; MAX_COLUMNS + 1] };
    let mut drift = StabilityDrift {
        ticks,
        ours_early: 0.0,
        ours_late: 0.0,
        running_sums_early: 0.0,
        running_sums_late: Some(0.0),
    };
    let window = 2 * BLOCK;
    for tick in 0..ticks + LOOKS {
        let k = (tick % TABLE as u64) as usize;
        sliding.push(Some(&rows[k]));
        running.add(&columns[k], 1.0);
        if tick >= window as u64 {
            running.add(&columns[(k + TABLE - window) % TABLE], -1.0);
        }
        let early = (EARLY..EARLY + LOOKS).contains(&tick);
        if !early && tick < ticks {
            continue;
        }
        let held: Vec<_> = columns[k + 1 - window..=k].iter().map(|row| row.to_vec()).collect();
        let total = ridge * window as f64;
        let at = &columns[k][..MAX_COLUMNS];
        let exact = Reference::new(&held, MAX_COLUMNS, total.sqrt())
            .and_then(|reference| reference.predict(MAX_COLUMNS, &[at.to_vec()])[0]);
        let error = |found: Option<f64>| Some((found? - exact?).abs() / exact?.abs().max(1.0));
        let ours = error(sliding.fit().predict(&rows[k])[MAX_DEGREE - 1]).unwrap_or(f64::INFINITY);
        let sums = error(running.predict(total, at));
        if early {
            drift.ours_early = drift.ours_early.max(ours);
            drift.running_sums_early = drift.running_sums_early.max(sums.unwrap_or(f64::INFINITY));
        } else {
            drift.ours_late = drift.ours_late.max(ours);
            drift.running_sums_late = drift.running_sums_late.zip(sums).map(|(worst, sums)| worst.max(sums));
        }
    }
    drift
}
