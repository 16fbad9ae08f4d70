//! Validation III: the rendering error of each mode, within the window that it was fitted to and at the horizon.

use nalgebra::Vector3;
use nima_core::impedance::{MODES, Mode};
use nima_machine::{
    config::RigConfig,
    runtime::{ClockProfile, VirtualClock},
    teleop::ErrorStats,
};
use nima_simulation::{SimulationPlan, run_virtual_on, scene::Scene};
use serde::Serialize;

use super::ValidationError;

/// The scene: the paper's task.
const SCENE: &str = "peg_transfer";
/// Duration, s, and the first part that is not judged because the window is still filling.
const SECONDS: f64 = 60.0;
const FILL_S: f64 = 1.0;

/// Mean absolute error and standard deviation per axis, averaged over the three axes, N.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct RenderingFigures {
    pub mae_n: f64,
    /// Standard deviation of the error, N.
    pub sd_n: f64,
}

#[derive(Clone, Copy, Debug, Serialize)]
pub struct ModeFigures {
    pub mode: Mode,
    pub error: RenderingFigures,
}

#[derive(Clone, Debug, Serialize)]
pub struct ValidationRendering {
    pub clock: ClockProfile,
    /// The paper's method, evaluated on the newest sample of the window used for the fit.
    pub in_window_nonlinear: RenderingFigures,
    /// The same with degree N = 1.
    pub in_window_linear: RenderingFigures,
    /// Fraction of windows for which a degree above 1 was chosen.
    #[serde(rename = "nonlinear_share")]
    pub nonlinear_fraction: f64,
    /// Delay of the link, s.
    pub delay_s: f64,
    /// Prediction errors at the horizon, per mode.
    pub at_horizon: Vec<ModeFigures>,
}

/// Errors per axis.
#[derive(Clone, Debug, Default)]
struct RenderingAxes([ErrorStats; 3]);

impl RenderingAxes {
    fn add(&mut self, error_n: &Vector3<f64>) {
        for (axis, stats) in self.0.iter_mut().enumerate() {
            stats.add(&Vector3::new(error_n[axis], 0.0, 0.0));
        }
    }

    fn figures(&self) -> RenderingFigures {
        let mean = |of: &dyn Fn(&ErrorStats) -> f64| self.0.iter().map(of).sum::<f64>() / 3.0;
        RenderingFigures { mae_n: mean(&|stats| stats.mae_n), sd_n: mean(&ErrorStats::sd_n) }
    }
}

/// Runs the task on this clock with this delay (s).
///
/// # Errors
/// [`ValidationError`] if the scene or a setting is invalid.
pub fn study(clock: VirtualClock, seed: u64, delay_s: f64) -> Result<ValidationRendering, ValidationError> {
    let scene = Scene { seed, ..Scene::load(SCENE)? };
    let mut rig = RigConfig { delay_s, ..RigConfig::load("simulated")? };
    rig.identification.compare = true;
    let plan = SimulationPlan { rig, scene, calibrations: Default::default(), engage: true };
    let mut nonlinear = RenderingAxes::default();
    let mut linear = RenderingAxes::default();
    let mut at_horizon: [RenderingAxes; MODES] = std::array::from_fn(|_| RenderingAxes::default());
    let mut windows = 0_u32;
    let mut above_one = 0_u32;
    run_virtual_on(&plan, clock, SECONDS, |tick| {
        if tick.t_s < FILL_S + delay_s {
            return None;
        }
        let report = &tick.identification;
        if let degree @ 1.. = usize::from(report.degrees.paper) {
            windows += 1;
            above_one += u32::from(degree > 1);
            nonlinear.add(&report.reconstruction_n[degree - 1]);
            linear.add(&report.reconstruction_n[0]);
        }
        for mode in Mode::ALL {
            at_horizon[mode.index()].add(&(tick.rendering.asked_n[mode.index()] - tick.measured_n));
        }
        None
    })?;
    Ok(ValidationRendering {
        clock: clock.profile,
        in_window_nonlinear: nonlinear.figures(),
        in_window_linear: linear.figures(),
        nonlinear_fraction: f64::from(above_one) / f64::from(windows.max(1)),
        delay_s,
        at_horizon: Mode::ALL.map(|mode| ModeFigures { mode, error: at_horizon[mode.index()].figures() }).to_vec(),
    })
}
