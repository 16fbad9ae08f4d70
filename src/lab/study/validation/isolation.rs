//! Validation II: the force at the tip through the trocar, with a network trained on one session and judged on others.

use std::{sync::atomic::AtomicBool, time::Instant};

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use nima_core::{
    calibration::{correspondence::Correspondence, gravity::GravityModel},
    statistics::Quantiles,
    tip_force::{Estimator, FeatureSettings, TrainingSettings},
};
use nima_machine::rig::Prompt;
use nima_recording::tip_force::{DataSet, Selection, TipForceRecorder};
use nima_simulation::scene::Scene;
use nima_training::{EvaluationPart, NoContact, TrainingProgress, evaluate, train_model};
use serde::Serialize;

use super::{ValidationError, experiment};
use crate::validation::experiment::{SimulatedExperiment, felt};

/// A recorded session: the data set as a technician records it, and the true force of every row.
#[derive(Clone, Debug)]
pub struct RecordedSession {
    /// CSV.
    pub text: Vec<u8>,
    /// True force at the tip, row by row, N (`s1`).
    pub truth_n: Vec<Vector3<f64>>,
}

#[derive(Clone, Copy, Debug)]
pub struct PriorCalibrations {
    /// Weight of the tool and bias of the sensor.
    pub gravity: GravityModel,
    /// Orientation of the sensor under the tissue.
    pub correspondence: Correspondence,
}

impl PriorCalibrations {
    /// Calibrates both, each in its own scene.
    ///
    /// # Errors
    /// [`ValidationError`] if a scene is invalid or a calibration fails.
    pub fn calibrate(seed: u64) -> Result<Self, ValidationError> {
        let gravity = experiment::gravity(seed)?;
        let report = experiment::correspondence(&gravity, seed, 0.0)?.report;
        Ok(Self { gravity, correspondence: experiment::known(&report)? })
    }
}

/// Records `rows` rows of a scene. In every ten seconds, `contact_s` are in contact, the remaining time above the
/// tissue.
///
/// # Errors
/// [`ValidationError`] if the recording cannot be written.
pub fn record(
    scene: &Scene,
    known: &PriorCalibrations,
    features: FeatureSettings,
    rows: usize,
    contact_s: f64,
) -> Result<RecordedSession, ValidationError> {
    let mut experiment = SimulatedExperiment::new(scene);
    let mut gravity = experiment::compensator(&known.gravity);
    let mut recorder = TipForceRecorder::new(known.correspondence).with_features(features);
    let mut truth_n = Vec::with_capacity(rows);
    while recorder.rows() < rows {
        let t_s = experiment.t_s();
        let prompt = match t_s {
            // No contact in the first second, while the sensor under the tissue is zeroed.
            t if t < 1.0 => Prompt::Rest,
            t if t % 10.0 < contact_s => Prompt::Work,
            _ => Prompt::WorkFree,
        };
        if let Some((sample, wrench)) = felt(&mut experiment, &mut gravity, prompt) {
            recorder.step(experiment.t_s(), Some(&wrench), &sample);
            if recorder.rows() > truth_n.len() {
                truth_n.push(experiment.true_tip_s1_n(&sample));
            }
        }
        if t_s > 30.0 + rows as f64 * 0.02 {
            let reason = format!("the recording makes no progress: {:?}", recorder.phase());
            return Err(ValidationError::Calibration(reason));
        }
    }
    let mut text = Vec::new();
    recorder.write(&mut text).map_err(ValidationError::Scratch)?;
    Ok(RecordedSession { text, truth_n })
}

impl RecordedSession {
    /// Returns the data set with these inputs; `None` for the default inputs.
    ///
    /// # Errors
    /// [`ValidationError`] if the data set lacks a column.
    pub fn data(&self, inputs: Option<&[&str]>) -> Result<DataSet, ValidationError> {
        let inputs = inputs.map(|names| names.iter().map(|name| (*name).to_owned()).collect());
        let texts = [("simulated session".into(), self.text.clone())];
        Ok(DataSet::parse(&texts, &Selection { inputs, outputs: None })?)
    }

    /// Returns the same with the true force at the tip instead of the measurement under the tissue.
    ///
    /// # Errors
    /// [`ValidationError`] if the data set lacks a column.
    pub fn true_data(&self, inputs: Option<&[&str]>) -> Result<DataSet, ValidationError> {
        let mut data = self.data(inputs)?;
        data.y = self.truth_n.iter().flat_map(|n| [n.x as f32, n.y as f32, n.z as f32]).collect();
        data.contact = Some(self.truth_n.iter().map(|n| n.norm() > 0.0).collect());
        Ok(data)
    }
}

/// The paper's inputs: wrist force and orientation.
pub const PAPER_INPUTS: [&str; 7] = ["fx_n", "fy_n", "fz_n", "qw", "qx", "qy", "qz"];
/// Rows of a training session, as in the paper.
pub const ROWS: usize = 30_000;
/// Rows of a session used for judging.
const JUDGED_ROWS: usize = 10_000;
/// Seconds of every ten in contact.
const CONTACT_S: f64 = 7.0;

/// Errors of a network on sessions that it was not trained on.
#[derive(Clone, Debug, Serialize)]
pub struct NetworkErrors {
    /// Compared with the sensor under the tissue, as in the paper.
    pub measured: EvaluationPart,
    /// Compared with the true force, which is known only in a simulation.
    pub truth: EvaluationPart,
    /// Mean and spread of the predictions without contact.
    pub no_contact: Vec<NoContact>,
    /// Fraction of samples of these sessions that the network flags as uncertain.
    pub false_alarms: f64,
    /// Wall-clock time of the training, s.
    pub training_s: f64,
    /// Time of one inference, microseconds.
    pub inference_us: Quantiles,
}

/// Samples deliberately outside the range of the training data, and the fraction that is flagged.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Foreign {
    /// Difference from the training data.
    pub what: &'static str,
    /// Number of samples.
    pub rows: usize,
    /// Fraction of these samples that is flagged as uncertain.
    pub flagged: f64,
}

/// Results of Validation II.
#[derive(Clone, Debug, Serialize)]
pub struct Isolation {
    /// With the inputs used in the paper.
    pub paper_inputs: NetworkErrors,
    /// With the default inputs of this project.
    pub our_inputs: NetworkErrors,
    /// Flagged fractions of samples outside the training data.
    pub foreign: Vec<Foreign>,
}

#[derive(Clone, Debug)]
pub struct IsolationSessions {
    known: PriorCalibrations,
    seed: u64,
    training: RecordedSession,
    unseen: RecordedSession,
    free: RecordedSession,
}

impl IsolationSessions {
    /// Records the sessions; `rows` for training.
    ///
    /// # Errors
    /// [`ValidationError`] if a scene is invalid or a calibration fails.
    pub fn record(seed: u64, rows: usize, features: FeatureSettings) -> Result<Self, ValidationError> {
        let known = PriorCalibrations::calibrate(seed)?;
        let session = |scene: &str, seed: u64, rows: usize, contact_s: f64| {
            record(&SimulatedExperiment::scene(scene, seed)?, &known, features, rows, contact_s)
        };
        Ok(Self {
            known,
            seed,
            training: session("isolation", seed, rows, CONTACT_S)?,
            unseen: session("isolation", seed + 1, JUDGED_ROWS, CONTACT_S)?,
            free: session("no_contact", seed + 2, JUDGED_ROWS, 0.0)?,
        })
    }

    /// Trains on the first session, judges on the others.
    ///
    /// # Errors
    /// [`ValidationError`] if the training fails.
    pub fn train(
        &self,
        inputs: Option<&[&str]>,
        settings: &TrainingSettings,
    ) -> Result<(Estimator, NetworkErrors), ValidationError> {
        let start = Instant::now();
        let model = train_model(
            &self.training.data(inputs)?,
            settings,
            [None, None],
            &AtomicBool::new(false),
            &|_: &TrainingProgress| {},
        )?;
        let training_s = start.elapsed().as_secs_f64();
        let mut estimator = Estimator::new(model);
        let measured = evaluate(&mut estimator, &self.unseen.data(inputs)?)?;
        let truth = evaluate(&mut estimator, &self.unseen.true_data(inputs)?)?;
        let free = evaluate(&mut estimator, &self.free.true_data(inputs)?)?;
        let reached = NetworkErrors {
            false_alarms: measured.overall.doubt_fraction,
            inference_us: measured.inference_us,
            measured: measured.overall,
            truth: truth.overall,
            no_contact: free.overall.no_contact,
            training_s,
        };
        Ok((estimator, reached))
    }

    /// Returns the flagged fraction for several kinds of samples outside the training data.
    ///
    /// # Errors
    /// [`ValidationError`] if a scene is invalid or cannot be recorded.
    pub fn foreign(&self, estimator: &mut Estimator) -> Result<Vec<Foreign>, ValidationError> {
        let strongest_n = self.training.truth_n.iter().map(Vector3::norm).fold(0.0, f64::max);
        let directions = directions(&self.training.data(None)?);
        let mut all = Vec::new();
        let mut one = |what, change: &dyn Fn(&mut Scene), keep: &dyn Fn(&DataSet, usize, &Vector3<f64>) -> bool| {
            let mut scene = SimulatedExperiment::scene("isolation", self.seed + 3)?;
            change(&mut scene);
            let session = record(&scene, &self.known, FeatureSettings::default(), JUDGED_ROWS, CONTACT_S)?;
            let data = session.data(None)?;
            let doubts = (0..data.rows())
                .filter(|row| keep(&data, *row, &session.truth_n[*row]))
                .map(|row| estimator.estimate(data.input(row)).in_doubt);
            let (rows, flagged) = doubts.fold((0, 0), |(n, k), doubt| (n + 1, k + usize::from(doubt)));
            all.push(Foreign { what, rows, flagged: flagged as f64 / f64::from(rows.max(1) as u32) });
            Ok::<(), ValidationError>(())
        };
        one(
            "tip force 25 % above the training range",
            &|scene| scene.tissue.iter_mut().for_each(|tissue| tissue.stiffness *= 3.0),
            &|_, _, truth_n| truth_n.norm() > 1.25 * strongest_n,
        )?;
        one(
            "shaft more than 5 degrees outside the training range",
            &|scene| scene.trocar_m.x += 0.08,
            &|data, row, _| directions.iter().all(|known| known.angle(&direction(data, row)) > 5_f64.to_radians()),
        )?;
        one(
            "another seal, three times the friction, while it slides",
            &|scene| {
                scene.trocar.iter_mut().for_each(|trocar| {
                    trocar.coulomb_n *= 3.0;
                    trocar.static_n *= 3.0;
                });
            },
            &|data, row, _| data.input(row)[TRAVEL].abs() > 0.5e-3,
        )?;
        one(
            "another tool, 150 g heavier",
            &|scene| scene.wrist.iter_mut().for_each(|wrist| wrist.tool_mass_kg += 0.15),
            &|_, _, _| true,
        )?;
        Ok(all)
    }
}

const TRAVEL: usize = 13;

fn direction(data: &DataSet, row: usize) -> Vector3<f64> {
    let [w, x, y, z] = [6, 7, 8, 9].map(|column| f64::from(data.input(row)[column]));
    UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z)) * Vector3::z()
}

/// Returns the directions of the shaft in a session, thinned out.
fn directions(data: &DataSet) -> Vec<Vector3<f64>> {
    (0..data.rows()).step_by(20).map(|row| direction(data, row)).collect()
}

/// Runs Validation II with the default settings.
///
/// # Errors
/// [`ValidationError`] if a scene is invalid, a calibration fails, or the network cannot be trained.
pub fn study(seed: u64, rows: usize) -> Result<Isolation, ValidationError> {
    let sessions = IsolationSessions::record(seed, rows, FeatureSettings::default())?;
    let (_, paper_inputs) = sessions.train(Some(&PAPER_INPUTS), &TrainingSettings::default())?;
    let (mut estimator, our_inputs) = sessions.train(None, &TrainingSettings::default())?;
    let foreign = sessions.foreign(&mut estimator)?;
    Ok(Isolation { paper_inputs, our_inputs, foreign })
}
