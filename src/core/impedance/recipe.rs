//! Choices where the text of the paper is ambiguous.

use serde::{Deserialize, Serialize};

use super::{
    LiteralModel, MAX_DEGREE,
    features::{ImpedanceFeatures, MOTION_COLUMNS, Scales},
    literal::LiteralSolver,
};
use crate::signal::Lanes;

/// Time after a window in which [`DegreeChoice::Next`] evaluates its fits (s).
/// Design choice: 10 rows at 1 kHz, short enough for the tissue to stay the same.
const JUDGED_S: f64 = 0.01;

/// Meaning of the paper's `u`, the "incremental positional changes of the instrument within a time interval".
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum IncrementReading {
    /// The changes of position, velocity and acceleration over the window: zero one window after the hand has stopped.
    #[default]
    Increments,
    /// The displacement from the workspace's origin, and its derivatives.
    Displacement,
}

/// Error by which the degree is chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum DegreeChoice {
    /// The error in the window to which the degrees were fitted.
    #[default]
    Window,
    /// The error over the 10 ms after that window.
    Next,
}

/// Settings of the literal and the linear mode; the default is the paper's recipe to the letter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Recipe {
    pub reading: IncrementReading,
    pub choice: DegreeChoice,
    /// Whether a free constant force is part of the fit.
    pub constant: bool,
    /// Ridge, per row of the window and in columns divided by the workspace's [`Scales`]; 0 for none.
    pub ridge: f64,
}

impl Recipe {
    /// Returns the values that the ridge adds to the diagonal of the normal equations, per row of the window, for each
    /// motion column in SI units.
    pub(super) fn penalty(&self, scales: &Scales) -> [f64; MOTION_COLUMNS] {
        let Scales { position_m, velocity_m_s, acceleration_m_s2, .. } = *scales;
        let squares = [position_m, velocity_m_s, acceleration_m_s2].map(|scale| scale * scale);
        let mut penalty = [0.0; MOTION_COLUMNS];
        // Dividing a column by `s` multiplies its coefficient by `s`, so a ridge on it counts `s^2` times.
        let mut power = squares.map(|square| self.ridge * square);
        for triple in penalty.chunks_exact_mut(3) {
            triple.copy_from_slice(&power);
            power.iter_mut().zip(squares).for_each(|(power, square)| *power *= square);
        }
        penalty
    }
}

/// Chooses the degree that best predicted the data after its window. All degrees of a window are evaluated for 10 ms,
/// then those of the window that ends at that time.
#[derive(Clone, Debug)]
pub(super) struct NextDegree {
    ticks: usize,
    models: [LiteralModel; MAX_DEGREE],
    squares_n2: [f64; MAX_DEGREE],
    waited: usize,
    judged: usize,
    degree: usize,
}

impl NextDegree {
    pub(super) fn new(rate_hz: f64) -> Self {
        Self {
            // At least one row, also at low rates.
            ticks: ((JUDGED_S * rate_hz).round() as usize).max(1),
            models: [LiteralModel::NONE; MAX_DEGREE],
            squares_n2: [0.0; MAX_DEGREE],
            waited: 0,
            judged: 0,
            degree: 0,
        }
    }

    /// Adds the newest row (force in N), `None` if it was not measured, and the fits of the window that ends with it.
    /// Returns the current degree, 0 before one is known.
    pub(super) fn step(&mut self, row: Option<(&ImpedanceFeatures, Lanes)>, newest: &LiteralSolver) -> usize {
        self.waited += 1;
        if let Some((features, force_n)) = row {
            self.judged += 1;
            for (square_n2, model) in self.squares_n2.iter_mut().zip(&self.models) {
                let Lanes([x, y, z, _]) = force_n - model.product(features);
                *square_n2 += x * x + y * y + z * z;
            }
        }
        if self.waited >= self.ticks {
            // Without one measured row there is nothing to choose by, so the degree stays.
            if self.judged > 0 {
                self.degree = self.best();
            }
            for (degree, model) in (1..).zip(&mut self.models) {
                *model = *newest.model(degree);
            }
            self.squares_n2 = [0.0; MAX_DEGREE];
            self.waited = 0;
            self.judged = 0;
        }
        // If that degree cannot be solved now, use the next lower one that can.
        (1..=self.degree).rev().find(|&degree| newest.is_solved(degree)).unwrap_or(0)
    }

    fn best(&self) -> usize {
        // A degree that was not solved has no error, not the smallest one.
        let known = |degree: &usize| self.models[degree - 1].degree > 0 && self.squares_n2[degree - 1].is_finite();
        let error = |degree: usize| self.squares_n2[degree - 1];
        (1..=MAX_DEGREE).filter(known).min_by(|&a, &b| error(a).total_cmp(&error(b))).unwrap_or(0)
    }

    pub(super) fn reset(&mut self) {
        *self = Self { ticks: self.ticks, ..Self::new(1.0) };
    }
}
