//! The parameters of the identification, and their tested values.

use nima_core::{
    impedance::{Identifier, ImpedanceSettings, MAX_DEGREE, Mode, SettingsError},
    signal::DifferentiatorKind,
};
use serde::Serialize;

use super::{modes, source::TradeoffSource};
use crate::solvers::LeastSquaresSolver;

/// A method that computes a force from samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(untagged)]
pub enum PlanMethod {
    /// A mode, as run by the loop.
    Mode(Mode),
    /// The plain model of a window, computed by this solver (in its own precision).
    Solver(LeastSquaresSolver),
}

impl PlanMethod {
    pub const fn name(self) -> &'static str {
        match self {
            Self::Mode(mode) => mode.name(),
            Self::Solver(solver) => solver.name(),
        }
    }

    pub const fn mode(self) -> Option<Mode> {
        match self {
            Self::Mode(mode) => Some(mode),
            Self::Solver(_) => None,
        }
    }
}

/// One value for every parameter.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ParameterChoice {
    pub method: PlanMethod,
    pub degree: usize,
    pub window_ms: f64,
    pub rate_hz: f64,
    pub delay_ms: f64,
    /// Method for velocity and acceleration.
    pub differentiator: DifferentiatorKind,
    /// Uses every n-th sample of the source.
    pub every: usize,
}

/// A parameter that is varied while the others are constant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Knob {
    /// The highest polynomial degree that may be chosen.
    Degree,
    /// Length of the window.
    Window,
    /// Samples per second.
    Rate,
    Delay,
    /// Method for velocity and acceleration.
    Differentiator,
    Mode,
    /// Degree and window together, at one delay.
    Grid,
}

impl Knob {
    pub const fn name(self) -> &'static str {
        match self {
            Self::Degree => "degree",
            Self::Window => "window",
            Self::Rate => "rate",
            Self::Delay => "delay",
            Self::Differentiator => "differentiator",
            Self::Mode => "mode",
            Self::Grid => "grid",
        }
    }
}

/// Points along one parameter.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlanCurve {
    /// The parameter that varies along the curve.
    pub knob: Knob,
    /// Method of the whole curve (for [`Knob::Mode`]: of its base point).
    pub method: PlanMethod,
    /// Indices into the source's points.
    pub points: Vec<usize>,
}

/// The values to test.
#[derive(Clone, Debug)]
pub struct TradeoffPlan {
    /// The base point, and settings that are not varied (scales, ridge). Rate and axes come from the source.
    pub base: ImpedanceSettings,
    /// Modes measured along every parameter that they have; the grid has all modes.
    pub modes: Vec<Mode>,
    pub degrees: Vec<usize>,
    pub windows_s: Vec<f64>,
    /// Rates below the source's, Hz.
    pub rates_hz: Vec<f64>,
    pub delays_s: Vec<f64>,
    pub differentiators: Vec<DifferentiatorKind>,
    /// Solvers of the plain model of a window, measured along degree and window.
    pub solvers: Vec<LeastSquaresSolver>,
    /// Number of instants at which each solver is evaluated.
    pub instants: usize,
    /// Number of runs over the source for each point of a mode; the minimum time counts as its cost.
    pub passes: usize,
}

impl TradeoffPlan {
    /// Creates the plan with all points of the full study.
    pub fn full(base: ImpedanceSettings) -> Self {
        Self {
            base,
            modes: vec![Mode::Best, Mode::Nima, Mode::Literal],
            degrees: (1..=MAX_DEGREE).collect(),
            windows_s: vec![0.1, 0.2, 0.3, 0.5, 1.0],
            rates_hz: vec![500.0, 200.0, 66.0],
            delays_s: vec![0.01, 0.05, 0.1, 0.3],
            differentiators: DifferentiatorKind::ALL.to_vec(),
            solvers: LeastSquaresSolver::ALL.to_vec(),
            instants: 200,
            passes: 3,
        }
    }

    /// Creates a reduced plan that takes about a minute: three degrees, three windows, the delay of the base point.
    pub fn quick(base: ImpedanceSettings) -> Self {
        Self {
            degrees: vec![1, 2, MAX_DEGREE],
            windows_s: vec![0.1, 0.3, 1.0],
            rates_hz: vec![200.0],
            delays_s: vec![base.delay_s],
            solvers: Vec::new(),
            passes: 1,
            ..Self::full(base)
        }
    }

    /// Returns the base point for `source` with this mode.
    pub fn base_choice(&self, source: &TradeoffSource, mode: Mode) -> ParameterChoice {
        ParameterChoice {
            method: PlanMethod::Mode(mode),
            degree: self.base.max_degree,
            window_ms: ms(self.base.window_s),
            rate_hz: source.recording.rate_hz,
            delay_ms: ms(self.base.delay_s),
            differentiator: self.base.differentiator,
            every: 1,
        }
    }

    /// Returns the points and curves for `source`; each point once, even if several curves pass through it.
    pub(super) fn lay_out(&self, source: &TradeoffSource) -> (Vec<ParameterChoice>, Vec<PlanCurve>) {
        let mut layout = PlanLayout::default();
        for &mode in &self.modes {
            let base = self.base_choice(source, mode);
            let delays = self.delays_s.iter().map(|&s| ParameterChoice { delay_ms: ms(s), ..base });
            layout.curve(Knob::Rate, base.method, self.rates(&base));
            layout.curve(Knob::Delay, base.method, delays.collect());
            if mode.has_degrees() {
                layout.curve(Knob::Degree, base.method, self.of_degrees(base).collect());
            }
            if mode.has_window() {
                layout.curve(Knob::Window, base.method, self.of_windows(base).collect());
                // Only these modes have velocity and acceleration as columns.
                let differentiators = self.differentiators.iter();
                let choices = differentiators.map(|&differentiator| ParameterChoice { differentiator, ..base });
                layout.curve(Knob::Differentiator, base.method, choices.collect());
            }
        }
        if let Some(&mode) = self.modes.first() {
            let base = self.base_choice(source, mode);
            let choices = Mode::ALL.map(|mode| ParameterChoice { method: PlanMethod::Mode(mode), ..base }).to_vec();
            layout.curve(Knob::Mode, base.method, choices);
        }
        self.lay_out_solvers(source, &mut layout);
        for &delay_s in &self.delays_s {
            self.lay_out_grid(source, ms(delay_s), &mut layout);
        }
        (layout.choices, layout.curves)
    }

    fn of_degrees(&self, base: ParameterChoice) -> impl Iterator<Item = ParameterChoice> {
        self.degrees.iter().map(move |&degree| ParameterChoice { degree, ..base })
    }

    fn of_windows(&self, base: ParameterChoice) -> impl Iterator<Item = ParameterChoice> {
        self.windows_s.iter().map(move |&s| ParameterChoice { window_ms: ms(s), ..base })
    }

    /// Adds every mode with all of its degrees and windows.
    fn lay_out_grid(&self, source: &TradeoffSource, delay_ms: f64, layout: &mut PlanLayout) {
        for mode in Mode::ALL {
            let base = ParameterChoice { delay_ms, ..self.base_choice(source, mode) };
            let windows: Vec<ParameterChoice> =
                if mode.has_window() { self.of_windows(base).collect() } else { vec![base] };
            let choices = if mode.has_degrees() {
                windows.into_iter().flat_map(|choice| self.of_degrees(choice)).collect()
            } else {
                windows
            };
            layout.curve(Knob::Grid, base.method, choices);
        }
    }

    /// Every solver for all degrees at the base's window, and for all windows at the base's degree.
    fn lay_out_solvers(&self, source: &TradeoffSource, layout: &mut PlanLayout) {
        for &solver in &self.solvers {
            let method = PlanMethod::Solver(solver);
            let base = ParameterChoice { method, ..self.base_choice(source, Mode::Dfr) };
            layout.curve(Knob::Degree, method, self.of_degrees(base).collect());
            layout.curve(Knob::Window, method, self.of_windows(base).collect());
        }
    }

    fn rates(&self, base: &ParameterChoice) -> Vec<ParameterChoice> {
        let mut choices = vec![*base];
        for rate_hz in &self.rates_hz {
            let every = (base.rate_hz / rate_hz).round() as usize;
            if every > 1 {
                choices.push(ParameterChoice { every, rate_hz: base.rate_hz / every as f64, ..*base });
            }
        }
        choices
    }

    /// Returns the identifier for `choice` on a source with this number of axes; `None` for a solver, which does not
    /// use one.
    ///
    /// # Errors
    /// [`SettingsError`] if the choice is out of range.
    pub fn identifier(&self, choice: &ParameterChoice, axes: usize) -> Result<Option<Identifier>, SettingsError> {
        choice.method.mode().map(|mode| modes::identifier(&self.settings(choice, axes), mode)).transpose()
    }

    /// Returns the settings of an identifier for `choice`, for a source with this number of axes.
    pub(super) fn settings(&self, choice: &ParameterChoice, axes: usize) -> ImpedanceSettings {
        ImpedanceSettings {
            rate_hz: choice.rate_hz,
            window_s: choice.window_ms * 1e-3,
            delay_s: choice.delay_ms * 1e-3,
            max_degree: choice.degree,
            axes,
            differentiator: choice.differentiator,
            ..self.base.clone()
        }
    }
}

#[derive(Default)]
struct PlanLayout {
    choices: Vec<ParameterChoice>,
    curves: Vec<PlanCurve>,
}

impl PlanLayout {
    fn curve(&mut self, knob: Knob, method: PlanMethod, choices: Vec<ParameterChoice>) {
        let points = choices.into_iter().map(|choice| self.index(choice)).collect();
        self.curves.push(PlanCurve { knob, method, points });
    }

    fn index(&mut self, choice: ParameterChoice) -> usize {
        self.choices.iter().position(|known| *known == choice).unwrap_or_else(|| {
            self.choices.push(choice);
            self.choices.len() - 1
        })
    }
}

/// Converts seconds to milliseconds, rounded, so that equal choices compare equal.
fn ms(seconds: f64) -> f64 {
    (seconds * 1e9).round() / 1e6
}
