//! Fault-free machines at ordinary work, which must not report anything.

use nima_core::impedance::Mode;
use nima_machine::{
    config::RigConfig,
    messages::{Command, LoopState},
    teleop::Calibrations,
};
use nima_simulation::{SimulationPlan, run_virtual, scene::Scene};
use serde::Serialize;

use super::{FaultsError, MODES, SensorAt, bench::FaultBench};
use crate::validation::experiment;

const SCENES: [&str; 4] = ["peg_transfer", "palpation", "free_motion", "bimanual"];
const DELAYS_S: [f64; 4] = [0.0, 0.01, 0.05, 0.3];

/// Fault-free runs and their false alarms.
#[derive(Clone, Debug, Default, Serialize)]
pub struct FaultFreeRuns {
    pub runs: usize,
    /// Their total duration, s of loop time.
    pub seconds: f64,
    /// Every report, with scene, mode, delay and time.
    pub false_alarms: Vec<String>,
}

impl FaultFreeRuns {
    pub(super) fn line(&self) -> String {
        let report = if self.false_alarms.is_empty() { "none".to_owned() } else { self.false_alarms.join("; ") };
        format!(
            "- false alarms in {} fault-free runs, {:.0} minutes in total: {report}",
            self.runs,
            self.seconds / 60.0
        )
    }
}

/// Runs every scene in both modes at every delay, each for `seconds`.
pub(super) fn runs(seconds: f64) -> Result<FaultFreeRuns, FaultsError> {
    let mut calm = FaultFreeRuns::default();
    let gravity = experiment::gravity(1)?;
    for scene in SCENES {
        for mode in MODES {
            for delay_s in DELAYS_S {
                let mut rig = RigConfig::load("simulated")?;
                rig.mode = mode;
                rig.delay_s = delay_s;
                rig.gates.static_hold = calm.runs % 2 == 0;
                let known = Calibrations { gravity: Some(gravity), ..Calibrations::default() };
                let scene = Scene::load(scene)?;
                // Every run has its own seed, hence other tremor, noise and start.
                let scene = Scene { seed: scene.seed + 1000 * calm.runs as u64, ..scene };
                let calibrations = [known, Calibrations::default()];
                let plan = SimulationPlan { rig, scene, calibrations, engage: true };
                let mut report = None;
                let summary = run_virtual(&plan, seconds, |tick| match tick.state {
                    LoopState::Faulted(fault) => {
                        report = Some((tick.t_s, fault));
                        Some(Command::Shutdown)
                    }
                    _ => None,
                })?;
                if let Some((t_s, fault)) = report {
                    let name = &plan.scene.name;
                    calm.false_alarms.push(format!("{name}, {mode}, {:.0} ms: {fault:?} at {t_s:.3} s", 1e3 * delay_s));
                }
                calm.runs += 1;
                calm.seconds += summary.seconds;
            }
        }
    }
    for sensor in SensorAt::ON_ARMS {
        for mode in MODES {
            on_arm(&mut calm, sensor, mode, seconds)?;
        }
    }
    Ok(calm)
}

/// Returns a rig with an arm, whose readings are processed like those of a rig with devices.
fn on_arm(calm: &mut FaultFreeRuns, sensor: SensorAt, mode: Mode, seconds: f64) -> Result<(), FaultsError> {
    let mut bench = FaultBench::new(sensor, mode, calm.runs as u64)?;
    bench.obey(Command::Engage);
    let ticks = (seconds * 1e3) as u32;
    for tick in 0..ticks {
        if let Some(fault) = bench.step().and_then(|step| step.raised) {
            let t_s = f64::from(tick) * 1e-3;
            calm.false_alarms.push(format!("{}, {mode}: {fault:?} at {t_s:.3} s", sensor.word()));
            break;
        }
    }
    if bench.state() != LoopState::Engaged && calm.false_alarms.is_empty() {
        let state = format!("{:?}", bench.state());
        return Err(FaultsError::NotReached { place: sensor.word(), state });
    }
    calm.runs += 1;
    calm.seconds += seconds;
    Ok(())
}
