//! The degrees of the window's impedance, shown next to the paper's where modes are compared; no force is rendered from
//! them.

use super::{
    Mode,
    factor::{ImpedanceFactor, MAX_ROW},
    horizon::Horizon,
    information::{excitation, rank},
    messages::{IdentificationReport, LinkPacket, active},
    method::{FollowerEnd, MethodInput},
    settings::{ImpedanceSettings, ModeSet},
    solution::ImpedanceSolution,
    window::SlidingWindow,
};
use crate::signal::Lanes;

/// Slides the window, solves every nested degree on it, and evaluates each at the prediction horizon.
#[derive(Clone, Debug)]
pub(super) struct ImpedanceDegrees {
    window: SlidingWindow<ImpedanceFactor>,
    ridge: f64,
    solution: ImpedanceSolution,
    horizon: Horizon,
    settings: ImpedanceSettings,
}

impl ImpedanceDegrees {
    pub(super) fn new(settings: &ImpedanceSettings, delay_ticks: usize) -> Self {
        let block = settings.block();
        // A constant and three columns (x, v, a) for each degree.
        let columns = 1 + 3 * settings.max_degree;
        // Twice the block is the number of rows of a window: the setting is per row.
        let ridge = settings.ridge * 2.0 * block as f64;
        Self {
            window: SlidingWindow::new(
                block,
                ImpedanceFactor::new(columns),
                ImpedanceFactor::with_ridge(columns, ridge),
            ),
            ridge,
            solution: ImpedanceSolution::new(columns),
            horizon: Horizon::new(settings, delay_ticks),
            settings: settings.clone(),
        }
    }

    /// Returns whether the degrees of the window are required for comparison with the paper's.
    pub(super) fn are_wanted(modes: ModeSet) -> bool {
        modes.contains(Mode::Anchored) && modes.contains(Mode::Literal)
    }
}

impl FollowerEnd for ImpedanceDegrees {
    fn serves(&self, modes: ModeSet) -> bool {
        Self::are_wanted(modes)
    }

    fn take(&mut self, seen: &MethodInput<'_>, _parcel: &mut LinkPacket, report: &mut IdentificationReport) {
        let features = &seen.posture.features;
        if !seen.learn {
            // The horizon keeps its delay line in step with time even while nothing is learnt.
            self.horizon.rest(features, seen.force_n);
            return;
        }
        let axes = self.settings.axes;
        let columns = self.solution.columns();
        let mut row = [Lanes::ZERO; MAX_ROW];
        // A row of zeros changes nothing, but keeps the window in step with time.
        if seen.usable {
            row[0] = active(&nalgebra::Vector3::repeat(1.0), axes);
            row[1..columns].copy_from_slice(&features[..columns - 1]);
            row[columns] = seen.force_n;
        }
        self.window.push(&row);
        self.solution.solve(self.window.current());
        let chosen = self.horizon.step(&self.solution, features, seen.force_n, seen.good);
        report.columns = chosen as u8;
        // At least two columns: a single one has no condition to report.
        let condition = self.solution.condition(2.max(1 + chosen));
        report.condition = condition.0[..axes].iter().fold(1.0, |worst, c| c.max(worst));
        report.rank = rank(self.window.current(), self.ridge, axes);
        report.excitation = excitation(self.window.current(), self.ridge, &self.settings);
    }

    fn set_delay(&mut self, delay_ticks: usize) {
        self.horizon.set_delay(delay_ticks);
    }

    fn reset(&mut self) {
        self.window.reset();
        self.horizon.reset();
    }

    fn nested(&self) -> Option<&ImpedanceSolution> {
        Some(&self.solution)
    }
}
