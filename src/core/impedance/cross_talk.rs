//! The window's impedance with cross-talk between axes, where a scene asks for it: the full `M`, 45 columns.

use super::{
    MAX_DEGREE,
    cross_factor::{CrossFactor, CrossModel, cross_row},
    features::{Features, MOTION_COLUMNS},
    messages::{Impedance, clip},
    window::{SlidingWindow, Summary as _},
};
use crate::signal::{DelayLine, Lanes, settled};

const BLANK: CrossModel = [[Lanes::ZERO; 3]; MOTION_COLUMNS];

/// Slides the window, solves every degree when asked to, and keeps the running error of each degree at the horizon.
#[derive(Clone, Debug)]
pub(super) struct CrossTalk {
    window: SlidingWindow<CrossFactor>,
    models: DelayLine<[CrossModel; MAX_DEGREE]>,
    max_degree: usize,
    forget: f64,
    errors_n: [f64; MAX_DEGREE],
}

impl CrossTalk {
    /// A window of `2 * block` rows; `renewals` is how many solutions back the delay may reach.
    pub(super) fn new(block: usize, max_degree: usize, ridge: f64, renewals: usize, forget: f64) -> Self {
        let (empty, prior) = (CrossFactor::new(max_degree, 0.0), CrossFactor::new(max_degree, ridge));
        Self {
            window: SlidingWindow::new(block, empty, prior),
            models: DelayLine::new(renewals, [BLANK; MAX_DEGREE]),
            max_degree,
            forget,
            errors_n: [0.0; MAX_DEGREE],
        }
    }

    /// Takes the newest features and force (N), `None` where there are none; `renew`: solves every degree.
    pub(super) fn step(&mut self, row: Option<(&Features, Lanes)>, renew: bool) {
        let row = row.map_or(CrossFactor::BLANK_ROW, |(features, force_n)| cross_row(features, force_n));
        self.window.advance(&row, renew);
        if renew {
            let factor = self.window.current();
            let models = self.models.push_slot();
            for (degree, model) in (1..=self.max_degree).zip(models) {
                *model = factor.solve(degree);
            }
        }
    }

    /// Keeps the newest solutions for one more renewal.
    pub(super) fn rest(&mut self) {
        if let Some(models) = self.models.get(0).copied() {
            self.models.push(models);
        }
    }

    /// Judges the solutions of `age` renewals ago by a change of force (N) over the delay and of the features with it.
    pub(super) fn judge(&mut self, age: usize, moved: &Features, change: Lanes, bound_n: f64) {
        let Some(models) = self.models.get(age) else { return };
        for ((degree, model), mean) in (1..=self.max_degree).zip(models).zip(&mut self.errors_n) {
            let mut foretold = Lanes::ZERO;
            for (model, moved) in model.iter().zip(moved).take(3 * degree) {
                for (axis, m) in model.iter().enumerate() {
                    foretold += *m * moved[axis];
                }
            }
            let error_n = (change - clip(foretold, bound_n)).norm();
            *mean = settled(*mean + self.forget * (error_n - *mean));
        }
    }

    /// The degree with the least running error at the horizon, and that error (N).
    pub(super) fn best(&self) -> (usize, f64) {
        let errors = (1..=self.max_degree).zip(self.errors_n);
        errors.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, f64::INFINITY))
    }

    /// The newest solution of `degree`.
    pub(super) fn impedance(&self, degree: usize) -> Impedance {
        let Some(model) = self.models.get(0).and_then(|models| models.get(degree.wrapping_sub(1))) else {
            return Impedance::NONE;
        };
        let mut impedance = Impedance { columns: (3 * degree) as u8, coupled: true, ..Impedance::NONE };
        for (column, model) in model.iter().enumerate() {
            for axis in 0..3 {
                impedance.coefficients[column][axis] = model[axis][axis];
                for (shift, cross) in impedance.cross.iter_mut().enumerate() {
                    cross[column][axis] = model[(axis + 1 + shift) % 3][axis];
                }
            }
        }
        impedance
    }

    /// Forgets the running errors.
    pub(super) fn forget_errors(&mut self) {
        self.errors_n = [0.0; MAX_DEGREE];
    }

    pub(super) fn reset(&mut self) {
        self.window.reset();
        self.models.clear();
        self.forget_errors();
    }
}
