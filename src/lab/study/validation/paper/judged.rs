//! Results of the paper's recipe on a recording: inside the window that it was fitted to, and at the horizon.

use nalgebra::Vector3;
use nima_core::impedance::{DegreeChoice, Identifier, ImpedanceSettings, IncrementReading, Mode, ModeSet, Recipe};
use nima_machine::teleop::ErrorStats;
use nima_recording::csv::CsvRecording;
use serde::Serialize;

use crate::validation::{ValidationError, rendering::RenderingFigures};

/// Delays of the link, s.
pub const DELAYS_S: [f64; 4] = [0.01, 0.05, 0.1, 0.3];

/// The recipe as printed.
pub const PRINTED: Recipe =
    Recipe { reading: IncrementReading::Increments, choice: DegreeChoice::Window, constant: false, ridge: 0.0 };
/// Interpretations of the recipe, from the printed one to the usable one.
pub const RECIPES: [(&str, Recipe); 5] = [
    ("as printed", PRINTED),
    ("choice = next", Recipe { choice: DegreeChoice::Next, ..PRINTED }),
    ("and constant", Recipe { choice: DegreeChoice::Next, constant: true, ..PRINTED }),
    ("and ridge = 0.003", REPAIRED),
    ("and displacement", Recipe { reading: IncrementReading::Displacement, ..REPAIRED }),
];
/// With all corrections except the interpretation.
pub const REPAIRED: Recipe = Recipe { choice: DegreeChoice::Next, constant: true, ridge: 3e-3, ..PRINTED };

/// Results inside the window: fits judged on the newest sample of the window that they use, all axes alike.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct InWindow {
    /// The degree chosen by the error in the window, as the paper does.
    pub nonlinear: RenderingFigures,
    /// Degree 1.
    pub linear: RenderingFigures,
    /// `nonlinear` with displacements instead of increments.
    pub displacement: RenderingFigures,
    /// Relative reduction from `linear` to `nonlinear`.
    pub less: f64,
    /// Fraction of windows for which a degree above 1 is chosen by the error in the window.
    #[serde(rename = "window_share")]
    pub window_fraction: f64,
    /// The same if each degree is judged over the 10 ms after its window.
    #[serde(rename = "next_share")]
    pub next_fraction: f64,
}

/// Prediction errors at the horizon with one interpretation of the recipe.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct AtHorizon {
    /// The changed part.
    pub name: &'static str,
    /// The keys of a rig file.
    pub recipe: Recipe,
    /// Delay of the link, s.
    pub delay_s: f64,
    /// Force of the literal mode.
    pub literal: RenderingFigures,
    /// The delayed force, unmodified.
    pub dfr: RenderingFigures,
    /// Stiffness in the fit (the coefficient of `u`, the largest of the axes, 99th percentile over the windows), N/m.
    pub stiffness_p99_n_m: f64,
}

#[derive(Clone, Debug, Serialize)]
pub struct JudgedRecording {
    pub in_window: InWindow,
    /// At the horizon, for each interpretation of the recipe and each delay.
    pub at_horizon: Vec<AtHorizon>,
}

/// # Errors
/// [`ValidationError`] if its rate or its axes are out of range.
pub fn judge(recording: &CsvRecording) -> Result<JudgedRecording, ValidationError> {
    let mut at_horizon = Vec::new();
    for (name, recipe) in RECIPES {
        for delay_s in DELAYS_S {
            at_horizon.push(horizon(recording, name, recipe, delay_s)?);
        }
    }
    Ok(JudgedRecording { in_window: in_window(recording)?, at_horizon })
}

/// Runs the identification over a recording.
fn identify(
    recording: &CsvRecording,
    recipe: Recipe,
    delay_s: f64,
    mut each: impl FnMut(&Vector3<f64>, &Identifier),
) -> Result<(), ValidationError> {
    let CsvRecording { rate_hz, axes, samples, .. } = recording;
    let mut identifier = Identifier::new(&ImpedanceSettings {
        rate_hz: *rate_hz,
        delay_s,
        axes: axes.len(),
        modes: ModeSet::only(Mode::Literal).with(Mode::Linear),
        literal: recipe,
        ..ImpedanceSettings::default()
    })?;
    for sample in samples {
        identifier.step(sample);
        each(&sample.force_n, &identifier);
    }
    Ok(())
}

#[derive(Default)]
struct JudgedErrors([ErrorStats; 3]);

impl JudgedErrors {
    fn add(&mut self, error_n: &Vector3<f64>) {
        for (axis, stats) in self.0.iter_mut().enumerate() {
            stats.add(&Vector3::new(error_n[axis], 0.0, 0.0));
        }
    }

    /// Returns the mean absolute error and standard deviation over all axes of this recording together.
    fn figures(&self, recording: &CsvRecording) -> RenderingFigures {
        let count = recording.axes.len().max(1) as f64;
        let mean = |of: fn(&ErrorStats) -> f64| self.0[..recording.axes.len()].iter().map(of).sum::<f64>() / count;
        RenderingFigures { mae_n: mean(|stats| stats.mae_n), sd_n: mean(|stats| stats.sd_n().powi(2)).sqrt() }
    }
}

pub(super) fn in_window(recording: &CsvRecording) -> Result<InWindow, ValidationError> {
    let mut nonlinear = JudgedErrors::default();
    let mut linear = JudgedErrors::default();
    let mut displacement = JudgedErrors::default();
    let mut window = NonlinearFraction::default();
    let mut next = NonlinearFraction::default();
    identify(recording, PRINTED, 0.0, |_, identifier| {
        let report = identifier.report();
        if let degree @ 1.. = usize::from(report.degrees.paper) {
            window.add(degree);
            nonlinear.add(&report.reconstruction_n[degree - 1]);
            linear.add(&report.reconstruction_n[0]);
        }
    })?;
    identify(recording, Recipe { choice: DegreeChoice::Next, ..PRINTED }, 0.0, |_, identifier| {
        next.add(usize::from(identifier.report().degrees.paper));
    })?;
    identify(recording, Recipe { reading: IncrementReading::Displacement, ..PRINTED }, 0.0, |_, identifier| {
        let report = identifier.report();
        if let degree @ 1.. = usize::from(report.degrees.paper) {
            displacement.add(&report.reconstruction_n[degree - 1]);
        }
    })?;
    let nonlinear = nonlinear.figures(recording);
    let linear = linear.figures(recording);
    Ok(InWindow {
        nonlinear,
        linear,
        displacement: displacement.figures(recording),
        less: 1.0 - nonlinear.mae_n / linear.mae_n.max(f64::MIN_POSITIVE),
        window_fraction: window.value(),
        next_fraction: next.value(),
    })
}

pub(super) fn horizon(
    recording: &CsvRecording,
    name: &'static str,
    recipe: Recipe,
    delay_s: f64,
) -> Result<AtHorizon, ValidationError> {
    let mut literal = JudgedErrors::default();
    let mut dfr = JudgedErrors::default();
    let mut stiffness = Vec::new();
    identify(recording, recipe, delay_s, |measured_n, identifier| {
        let model = identifier.parcel().models.literal;
        if model.degree > 0 {
            stiffness.push(model.coefficients[0].0.iter().fold(0.0_f64, |max, m| m.abs().max(max)));
        }
        // Before the first data arrive there is nothing to evaluate; if a mode renders nothing, its error is the whole
        // force.
        let report = identifier.report();
        if let Some(delayed_n) = report.prediction(Mode::Dfr) {
            dfr.add(&(delayed_n - measured_n));
            literal.add(&(report.prediction(Mode::Literal).unwrap_or_default() - measured_n));
        }
    })?;
    stiffness.sort_unstable_by(f64::total_cmp);
    let stiffness_p99_n_m = stiffness.get(stiffness.len() * 99 / 100).copied().unwrap_or(0.0);
    let literal = literal.figures(recording);
    let dfr = dfr.figures(recording);
    Ok(AtHorizon { name, recipe, delay_s, literal, dfr, stiffness_p99_n_m })
}

/// Fraction of windows with a degree above 1, among those with a selected degree.
#[derive(Default)]
struct NonlinearFraction {
    yes: u32,
    all: u32,
}

impl NonlinearFraction {
    fn add(&mut self, degree: usize) {
        self.all += u32::from(degree > 0);
        self.yes += u32::from(degree > 1);
    }

    fn value(&self) -> f64 {
        f64::from(self.yes) / f64::from(self.all.max(1))
    }
}
