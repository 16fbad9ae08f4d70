//! The paper's experiments on the simulated rig, sample by sample, together with the true force, which is known only in
//! a simulation.

use nalgebra::{UnitVector3, Vector3};
use nima_core::{
    calibration::{
        correspondence::{self, Correspondence, CorrespondenceReport, CorrespondenceSession},
        gravity::{
            Compensator, DEFAULT_TIME_CONSTANT_S, GravityModel, GravityReport, GravitySession, GravitySessionSettings,
        },
    },
    frames::{Wrench, WristSample},
};
use nima_machine::rig::{Outputs, Prompt};
use nima_simulation::{World, scene::Scene};

use super::ValidationError;

pub const RATE_HZ: f64 = 1000.0;
/// Time limit of a guided calibration, s.
const PATIENCE_S: f64 = 120.0;

#[derive(Clone, Debug)]
pub struct SimulatedExperiment {
    world: World,
    ticks: u64,
}

/// Compensates gravity as the loop does, at the rate of the rig.
pub fn compensator(gravity: &GravityModel) -> Compensator {
    Compensator::new(*gravity, DEFAULT_TIME_CONSTANT_S, 1.0 / RATE_HZ)
}

impl SimulatedExperiment {
    /// Creates the rig for a scene with a person and a wrist sensor; other scenes give no samples.
    pub fn new(scene: &Scene) -> Self {
        Self { world: World::new(scene, RATE_HZ), ticks: 0 }
    }

    /// Returns the embedded scene of this name with another seed.
    ///
    /// # Errors
    /// [`ValidationError`] if there is no such scene.
    pub fn scene(name: &str, seed: u64) -> Result<Scene, ValidationError> {
        Ok(Scene { seed, ..Scene::load(name)? })
    }

    pub fn t_s(&self) -> f64 {
        self.ticks as f64 / RATE_HZ
    }

    /// Returns the next sample while the person follows this instruction.
    pub fn sample(&mut self, prompt: Prompt) -> Option<WristSample> {
        self.ticks += 1;
        let outputs = Outputs { prompt, ..Outputs::SAFE };
        self.world.exchange(self.t_s(), &outputs)?.sensed.wrist().copied()
    }

    /// Returns the true force on the tip in that sample, N (`s1`).
    pub fn true_tip_s1_n(&self, sample: &WristSample) -> Vector3<f64> {
        sample.world_from_s1.map_or_else(Vector3::zeros, |turn| turn.inverse() * self.world.true_tip_n())
    }
}

/// Calibrates gravity in its own scene, like the wizard.
///
/// # Errors
/// [`ValidationError`] if the scene is invalid or the calibration fails.
pub fn gravity(seed: u64) -> Result<GravityModel, ValidationError> {
    let report = gravity_report(seed)?;
    let fit = report.chosen_fit().ok_or_else(|| ValidationError::Calibration(report.reason.clone()))?;
    Ok(fit.model)
}

/// Like [`gravity`], with the measures of the calibration's quality.
///
/// # Errors
/// As [`gravity`].
pub fn gravity_report(seed: u64) -> Result<GravityReport, ValidationError> {
    let mut experiment = SimulatedExperiment::new(&SimulatedExperiment::scene("gravity", seed)?);
    let mut session = GravitySession::new(GravitySessionSettings::default());
    while let Some(target) = session.target() {
        let sample = experiment.sample(Prompt::Hold { world_from_s1: target.world_from_s1() });
        if let Some(sample) = sample {
            session.step(&sample, experiment.t_s());
        }
        if experiment.t_s() > PATIENCE_S {
            break;
        }
    }
    session.report().map_err(|error| ValidationError::Calibration(error.to_string()))
}

/// Results of pushing on the tissue without a trocar.
#[derive(Clone, Debug)]
pub struct Pushes {
    /// The correspondence fitted to the guided pushes.
    pub report: CorrespondenceReport,
    /// Later pushes that were not used for the fit, sample by sample: force at the wrist, and force under the tissue
    /// transformed to the wrist's frame, both N (`s1`).
    pub unseen_s1_n: Vec<[Vector3<f64>; 2]>,
}

/// Guides pushes on the tissue without a trocar, then records pushes for `seconds` more to judge the fit.
///
/// # Errors
/// [`ValidationError`] if the scene is invalid or the calibration fails.
pub fn correspondence(gravity: &GravityModel, seed: u64, seconds: f64) -> Result<Pushes, ValidationError> {
    let mut experiment = SimulatedExperiment::new(&SimulatedExperiment::scene("correspondence", seed)?);
    let mut gravity = compensator(gravity);
    let mut session = CorrespondenceSession::new(correspondence::CorrespondenceSessionSettings::default());
    let mut prompt = Prompt::Rest;
    while session.pushes() < 2 * correspondence::TARGETS.len() && experiment.t_s() < PATIENCE_S {
        let Some((sample, wrench)) = felt(&mut experiment, &mut gravity, prompt) else { continue };
        let phase = session.step(Some(wrench.force_n), &sample, experiment.t_s());
        if !matches!(
            phase,
            correspondence::CorrespondencePhase::Resting { .. } | correspondence::CorrespondencePhase::Missing(_)
        ) {
            prompt = push(session.target(), session.pushes());
        }
    }
    let report = session.report().map_err(|error| ValidationError::Calibration(error.to_string()))?;
    let known = known(&report)?;
    let mut unseen_s1_n = Vec::new();
    let begin_s = experiment.t_s();
    while experiment.t_s() < begin_s + seconds {
        let prompt = push(None, ((experiment.t_s() - begin_s) / 2.0) as usize);
        let Some((sample, wrench)) = felt(&mut experiment, &mut gravity, prompt) else { continue };
        if let Some(tip_n) = sample.tissue_n.and_then(|tissue_n| known.tip_force_s1(&sample, &tissue_n)) {
            unseen_s1_n.push([wrench.force_n, tip_n]);
        }
    }
    Ok(Pushes { report, unseen_s1_n })
}

/// Returns the correspondence of a report.
///
/// # Errors
/// [`ValidationError`] if the report has no rotation.
pub fn known(report: &CorrespondenceReport) -> Result<Correspondence, ValidationError> {
    let found = report.solution.as_ref().ok_or_else(|| ValidationError::Calibration(report.reason.clone()))?;
    Ok(Correspondence { target: found.target, rotation: found.rotation(), flip_s2: false })
}

fn push(asked: Option<correspondence::PushTarget>, pushes: usize) -> Prompt {
    let all = correspondence::TARGETS;
    let target = asked.unwrap_or(all[pushes % all.len()]);
    Prompt::Push { direction: UnitVector3::new_normalize(target.push_in_world) }
}

/// Returns the next sample and its wrench without weight and bias.
pub fn felt(
    experiment: &mut SimulatedExperiment,
    gravity: &mut Compensator,
    prompt: Prompt,
) -> Option<(WristSample, Wrench)> {
    let sample = experiment.sample(prompt)?;
    Some((sample, gravity.step(&sample)?))
}
