//! The degrees of the window's impedance, shown beside the paper's where modes are compared; nothing is rendered from them.

use super::{
    factor::{Factor, MAX_ROW},
    horizon::Horizon,
    information::{excitation, rank},
    messages::{Posture, Report, active},
    settings::Settings,
    solution::Solution,
    window::SlidingWindow,
};
use crate::signal::Lanes;

/// Slides the window, solves every nested degree on it, and judges each at the horizon.
#[derive(Clone, Debug)]
pub(super) struct Degrees {
    window: SlidingWindow<Factor>,
    ridge: f64,
    solution: Solution,
    horizon: Horizon,
}

impl Degrees {
    pub(super) fn new(settings: &Settings, delay_ticks: usize) -> Self {
        let (block, columns) = (settings.block(), 1 + 3 * settings.max_degree);
        let ridge = settings.ridge * 2.0 * block as f64;
        Self {
            window: SlidingWindow::new(block, Factor::new(columns), Factor::with_ridge(columns, ridge)),
            ridge,
            solution: Solution::new(columns),
            horizon: Horizon::new(settings, delay_ticks),
        }
    }

    /// Takes the newest motion and force and fills in what the report says of the window. `good`: the sample was measured;
    /// `usable`: its features are those of a full filter, too.
    pub(super) fn step(
        &mut self,
        now: &Posture,
        force_n: Lanes,
        good: bool,
        usable: bool,
        settings: &Settings,
        report: &mut Report,
    ) {
        let columns = self.solution.columns();
        let mut row = [Lanes::ZERO; MAX_ROW];
        if usable {
            row[0] = active(&nalgebra::Vector3::repeat(1.0), settings.axes);
            row[1..columns].copy_from_slice(&now.features[..columns - 1]);
            row[columns] = force_n;
        }
        self.window.push(&row);
        self.solution.solve(self.window.current());
        let chosen = self.horizon.step(&self.solution, &now.features, force_n, good);
        report.columns = chosen as u8;
        let condition = self.solution.condition(2.max(1 + chosen));
        report.condition = condition.0[..settings.axes].iter().fold(1.0, |worst, c| c.max(worst));
        report.rank = rank(self.window.current(), self.ridge, settings.axes);
        report.excitation = excitation(self.window.current(), self.ridge, settings);
    }

    /// Goes on without learning.
    pub(super) fn rest(&mut self, now: &Posture, force_n: Lanes) {
        self.horizon.rest(&now.features, force_n);
    }

    pub(super) const fn solution(&self) -> &Solution {
        &self.solution
    }

    pub(super) fn set_delay(&mut self, delay_ticks: usize) {
        self.horizon.set_delay(delay_ticks);
    }

    pub(super) fn reset(&mut self) {
        self.window.reset();
        self.horizon.reset();
    }
}
