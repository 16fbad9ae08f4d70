//! The tip force in the loop: from the network while it is reliable, otherwise from a selectable fallback.
//!
//! Takes the gravity-free wrench (N, Nm, `s1`), the wrist sample and its time (s); returns the force at the tip (N,
//! `s1`) and its source. Outside the training data the network's linear path answers alone; farther outside (a
//! doubt of 2) the fallback takes over. Either begins when three of the last five samples are uncertain and lasts until 50 ms
//! have passed without an uncertain sample. The force is cross-faded over 50 ms, so that the change cannot be felt.
//! Allocates nothing.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::{DEFAULT_INPUTS, DEFAULT_OUTPUTS, Estimator, FeatureSettings, ForceModel, NoRow, TipForceFeatures};
use crate::frames::{Wrench, WristSample};

/// A valid model with input columns that are not available in the loop.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the live loop does not provide the model's input {found}: train a model on the default columns")]
pub struct NotLive {
    pub found: String,
}

/// Force to use while the network is uncertain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Fallback {
    /// The gravity-free force at the wrist, which includes the trocar's friction.
    #[default]
    WristForce,
    /// The last reliable force, which fades to zero within 0.3 s.
    HoldAndFade,
}

/// Why the network is not used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unsure {
    /// The sample is so far outside the training data that not even the linear path is trusted.
    OutsideTraining,
    /// The instrument has not moved yet, or samples were missing: the direction of friction is not known.
    NotMoved,
    /// The sample lacks the orientation or the depth through the trocar.
    Missing,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TipForceReport {
    /// Force of the tissue on the tip, N (`s1`).
    pub force_s1_n: Vector3<f64>,
    /// Fraction of the network in the force, 0 to 1; the remainder is the fallback.
    pub network_fraction: f64,
    /// Reason why the fallback is taking over; `None` while the network is used.
    pub unsure: Option<Unsure>,
    /// Outside the training data: only the network's linear path contributes.
    pub extrapolates: bool,
    /// Distance of this sample from the training data, 1 at the limit; infinite if there is no row of inputs.
    pub doubt: f32,
}

/// Doubt above which the fallback is used. On the emulated rig, whose task moves differently from its training, the
/// network's mean error per axis at a doubt of 1.0 to 1.4 was 0.02 to 0.09 N, and at 1.8 to 2.0 it was 0.04 to 0.18 N;
/// the error of the wrist force was 0.3 to 0.9 N and 0.2 to 1.2 N (`docs/results/calibration.md`).
pub(super) const FAR_OUTSIDE: f32 = 2.0;
/// Number of uncertain samples among the last five that triggers the fallback: a single one is bridged by the last
/// reliable force.
const DOUBTFUL_OF_FIVE: u32 = 3;
/// Time without an uncertain sample after which the network is used again, s: otherwise the force would alternate
/// between network and fallback at the limit of doubt. Design choice.
const SURE_AFTER_S: f64 = 0.050;
/// Duration of the cross-fade, s; too long to be felt as a step. Design choice.
const HANDOVER_S: f64 = 0.050;
/// Time in which a held force fades to zero, s: long enough for a short spell of doubt, and too slow to be felt as a
/// step. Design choice.
const HOLD_S: f64 = 0.300;

#[derive(Clone, Debug)]
pub struct LiveTipForce {
    estimator: Estimator,
    /// Indices of the live columns that the model uses, and a buffer for them.
    columns: Vec<usize>,
    inputs: Vec<f32>,
    features: TipForceFeatures,
    fallback: Fallback,
    outside: LastingCondition,
    far: LastingCondition,
    unsure: Option<Unsure>,
    fraction: f64,
    /// Fraction of the wrist force in the fallback; the remainder is the held force.
    wrist_fraction: f64,
    /// The last reliable force (`None` before the first one), and the fraction of it that has not faded yet.
    held_n: Option<Vector3<f64>>,
    held_fraction: f64,
    last_t_s: Option<f64>,
}

impl LiveTipForce {
    /// Prepares a model for the loop.
    ///
    /// # Errors
    /// [`NotLive`] if the model needs a column that is not available in the loop.
    pub fn new(model: ForceModel, fallback: Fallback) -> Result<Self, NotLive> {
        let live = |name: &String| {
            let place = DEFAULT_INPUTS.iter().position(|column| column == name);
            place.ok_or_else(|| NotLive { found: name.clone() })
        };
        let columns = model.inputs.iter().map(live).collect::<Result<Vec<_>, _>>()?;
        // A model with other outputs may be in other units or axes.
        if !model.outputs.iter().eq(DEFAULT_OUTPUTS.iter()) {
            return Err(NotLive { found: model.outputs.join(", ") });
        }
        Ok(Self {
            inputs: vec![0.0; columns.len()],
            columns,
            estimator: Estimator::new(model),
            features: TipForceFeatures::new(FeatureSettings::default()),
            fallback,
            outside: LastingCondition::default(),
            // Starts as uncertain: the network has to be sure for `SURE_AFTER_S` first.
            far: LastingCondition { is: true, ..LastingCondition::default() },
            unsure: Some(Unsure::NotMoved),
            fraction: 0.0,
            wrist_fraction: 0.0,
            held_n: None,
            held_fraction: 0.0,
            last_t_s: None,
        })
    }

    pub const fn model(&self) -> &ForceModel {
        self.estimator.model()
    }

    /// Returns the force to use while the network is uncertain, as set in the rig file.
    pub const fn fallback(&self) -> Fallback {
        self.fallback
    }

    /// Returns the fallback that applies at present. Before the first reliable prediction there is no force to hold.
    /// Until the instrument has moved, the wrist force contains as much friction as tissue force, and the sign of the
    /// friction is unknown: zero force is then the better answer.
    pub fn fallback_now(&self) -> Fallback {
        if self.held_n.is_none() && self.unsure == Some(Unsure::NotMoved) {
            Fallback::HoldAndFade
        } else {
            self.fallback
        }
    }

    /// Returns the force for this sample. Must be called for every sample, in order.
    pub fn step(&mut self, t_s: f64, gravity_free: &Wrench, sample: &WristSample) -> TipForceReport {
        // Limited, so that the first sample after a gap does not complete a cross-fade at once.
        let dt_s = self.last_t_s.map_or(0.0, |last| (t_s - last).clamp(0.0, HANDOVER_S));
        self.last_t_s = Some(t_s);
        let (answer_n, doubt, reason) = match self.features.step(t_s, gravity_free, sample) {
            Ok(row) => {
                self.inputs.iter_mut().zip(&self.columns).for_each(|(to, column)| *to = row.inputs[*column]);
                let estimate = self.estimator.estimate(&self.inputs);
                let [x, y, z, ..] = estimate.output.map(f64::from);
                let reason = (estimate.doubt > FAR_OUTSIDE).then_some(Unsure::OutsideTraining);
                // Back into the sensor's frame, which is the frame of every other force.
                (Some(row.shaft_from_s1.inverse() * Vector3::new(x, y, z)), estimate.doubt, reason)
            }
            Err(NoRow::Missing) => (None, f32::INFINITY, Some(Unsure::Missing)),
            Err(NoRow::NotMoved) => (None, f32::INFINITY, Some(Unsure::NotMoved)),
        };
        let extrapolates = self.outside.step(doubt > 1.0, dt_s);
        self.judge(reason, answer_n.is_none(), dt_s);
        // Only while the network is in use and sure: a force from a doubtful sample must not be held.
        if let (Some(_), None, None) = (answer_n, reason, self.unsure) {
            self.held_n = answer_n;
        }
        let target = if self.unsure.is_none() { 1.0 } else { 0.0 };
        let max = dt_s / HANDOVER_S;
        self.fraction += (target - self.fraction).clamp(-max, max);
        // The mixture of the fallbacks changes only while one is used, so that it does not jump at the next doubt.
        if self.unsure.is_some() {
            let wrist = if self.fallback_now() == Fallback::WristForce { 1.0 } else { 0.0 };
            self.wrist_fraction += (wrist - self.wrist_fraction).clamp(-max, max);
        }
        // Falls within `HOLD_S`, returns within `HANDOVER_S`.
        self.held_fraction += (target - self.held_fraction).clamp(-dt_s / HOLD_S, max);
        // A single uncertain prediction is replaced by the last reliable one.
        let held_n = self.held_n.unwrap_or_else(Vector3::zeros);
        let force_s1_n = held_n * self.fraction + self.fallback_n(gravity_free) * (1.0 - self.fraction);
        TipForceReport { force_s1_n, network_fraction: self.fraction, unsure: self.unsure, extrapolates, doubt }
    }

    fn judge(&mut self, reason: Option<Unsure>, no_row: bool, dt_s: f64) {
        // Without a row there is nothing to bridge with: the fallback starts at once.
        self.far.is |= no_row;
        if !self.far.step(reason.is_some(), dt_s) {
            self.unsure = None;
        } else if reason.is_some() {
            self.unsure = reason;
        }
    }

    fn fallback_n(&self, gravity_free: &Wrench) -> Vector3<f64> {
        // Even the fallback is finite: it is the last value before the gates.
        let wrist_n = if gravity_free.is_finite() { gravity_free.force_n } else { Vector3::zeros() };
        let held_n = self.held_n.unwrap_or_else(Vector3::zeros) * self.held_fraction;
        wrist_n * self.wrist_fraction + held_n * (1.0 - self.wrist_fraction)
    }
}

/// A condition on samples that becomes true after several of them meet it, and false if none has met it for a while.
#[derive(Clone, Copy, Debug, Default)]
struct LastingCondition {
    is: bool,
    /// Flags of the last five samples, newest in the lowest bit.
    recent: u32,
    since_s: f64,
}

impl LastingCondition {
    fn step(&mut self, now: bool, dt_s: f64) -> bool {
        // The lowest five bits are the last five samples.
        self.recent = (self.recent << 1 | u32::from(now)) & 0b1_1111;
        self.since_s = if now { 0.0 } else { self.since_s + dt_s };
        self.is |= self.recent.count_ones() >= DOUBTFUL_OF_FIVE;
        self.is &= self.since_s < SURE_AFTER_S;
        self.is
    }
}
