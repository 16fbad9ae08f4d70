//! Motion and force for testing the paper's recipe: the peg transfer with shorter and longer holds.

use nima_core::impedance::{AXES, Sample};
use nima_machine::config::RigConfig;
use nima_recording::csv::CsvRecording;
use nima_simulation::{SimulationPlan, run_virtual, scene::Scene};
use serde::Serialize;

use crate::{tradeoff::TradeoffSource, validation::ValidationError};

/// The paper's task, and its programmed delay (s).
const SCENE: &str = "peg_transfer";
const DELAY_S: f64 = 0.3;
const RATE_HZ: f64 = 1000.0;

/// The hand's way of working, and the accuracy of the force measurement.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Conditions {
    /// Duration of dragging, and of resting at the bottom of each press, s each.
    pub hold_s: f64,
    /// Standard deviation of the force sensor's noise, N.
    pub noise_n: f64,
    /// Amplitude of the hand's tremor, m.
    pub tremor_m: f64,
    /// Whether the hand feels the force of the loop (mode and gates of the simulated rig) and yields to it.
    pub feels: bool,
}

impl Conditions {
    /// The conditions that reproduce the paper's results: a hand that hardly rests and is not pushed back, and little
    /// noise.
    pub const PAPER: Self = Self { hold_s: 0.1, noise_n: 0.01, tremor_m: 8e-5, feels: false };
    /// The conditions of the scene.
    pub const SCENE: Self = Self { hold_s: 0.35, noise_n: 0.02, tremor_m: 8e-5, feels: true };
    /// The paper's conditions, longer holds, more noise and none, a hand that feels the force, and the scene's
    /// conditions without tremor.
    pub const ALL: [Self; 9] = [
        Self::PAPER,
        Self { noise_n: 0.02, ..Self::PAPER },
        Self { hold_s: 0.15, ..Self::PAPER },
        Self { hold_s: 0.35, ..Self::PAPER },
        Self { hold_s: 1.0, ..Self::PAPER },
        Self { hold_s: 1.0, noise_n: 0.0, tremor_m: 0.0, ..Self::PAPER },
        Self { feels: true, ..Self::PAPER },
        Self::SCENE,
        Self { tremor_m: 0.0, ..Self::SCENE },
    ];

    /// Returns one line for a table.
    pub fn name(&self) -> String {
        let Self { hold_s, noise_n, tremor_m, feels } = *self;
        let tremor = if tremor_m > 0.0 { "" } else { ", no tremor" };
        let feels = if feels { ", force felt" } else { "" };
        format!("holds of {:.0} ms, noise {noise_n} N{tremor}{feels}", 1e3 * hold_s)
    }

    /// Records `seconds` of the task: the position of the tip, and the force measured there.
    ///
    /// # Errors
    /// [`ValidationError`] if the scene or a setting is invalid.
    pub fn record(&self, seed: u64, seconds: f64) -> Result<CsvRecording, ValidationError> {
        let mut scene = Scene { seed, ..Scene::load(SCENE)? };
        scene.hand.hold_s = self.hold_s;
        scene.hand.tremor_m = self.tremor_m;
        if let Some(sensor) = &mut scene.sensor {
            sensor.noise_n = self.noise_n;
        }
        if !self.feels {
            return Ok(TradeoffSource::from_scene(&scene, RATE_HZ, seconds).recording);
        }
        let rig = RigConfig { delay_s: DELAY_S, rate_hz: RATE_HZ, ..RigConfig::load("simulated")? };
        let plan = SimulationPlan { rig, scene, calibrations: Default::default(), engage: true };
        let mut samples = Vec::with_capacity((seconds * RATE_HZ) as usize + 1);
        run_virtual(&plan, seconds, |tick| {
            samples.push(Sample { t_s: tick.t_s, position_m: tick.positions.tip_m, force_n: tick.measured_n });
            None
        })?;
        Ok(CsvRecording { path: SCENE.into(), axes: (0..AXES).collect(), rate_hz: RATE_HZ, samples, leader_m: None })
    }
}
