//! The tip force in the loop: from the network while it is reliable, else from a selectable fallback.
//!
//! Takes the gravity-free wrench (N, Nm, `s1`), the wrist sample and its time (s); returns the force at the tip (N,
//! `s1`) and its source. If three of the last five samples are flagged as uncertain, the fallback takes over; the
//! network returns after 50 ms without such a sample. The force is cross-faded over 50 ms, so that the change cannot be
//! felt. Allocates nothing.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::{DEFAULT_INPUTS, DEFAULT_OUTPUTS, Estimator, FeatureSettings, Features, Model, NoRow};
use crate::frames::{Wrench, WristSample};

/// A valid model with input columns that are not available in the loop.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the model works with {found}, which the live loop does not know; train one on the default columns")]
pub struct NotLive {
    /// The unavailable columns.
    pub found: String,
}

/// Force to use while the network is uncertain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Fallback {
    /// The gravity-free force at the wrist, which includes the trocar's friction.
    #[default]
    WristForce,
    /// The last reliable force, fading to zero over 0.3 s.
    HoldAndFade,
}

/// Why the network is not used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unsure {
    /// The sample is outside the training data.
    OutsideTraining,
    /// The instrument has not moved yet, or samples were missing: the direction of friction is not known.
    NotMoved,
    /// The sample lacks the orientation or the depth through the trocar.
    Missing,
}

/// Result for one sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TipForceReport {
    /// Force of the tissue on the tip, N (`s1`).
    pub force_s1_n: Vector3<f64>,
    /// Share of the network in the force, 0 to 1; the remainder is the fallback.
    pub network_share: f64,
    /// Why the fallback is taking over; `None` while the network is used.
    pub unsure: Option<Unsure>,
    /// Distance of this sample from the training data, 1 at the limit; infinite if there is no row of inputs.
    pub doubt: f32,
}

/// Number of uncertain samples among the last five at which the fallback takes over.
const DOUBTFUL_OF_FIVE: u32 = 3;
/// Time without an uncertain sample after which the network is used again, s.
const SURE_AFTER_S: f64 = 0.050;
/// Duration of the cross-fade, s.
const HANDOVER_S: f64 = 0.050;
/// Time in which a held force fades to zero, s.
const HOLD_S: f64 = 0.300;

/// A network in the loop.
#[derive(Clone, Debug)]
pub struct TipForce {
    estimator: Estimator,
    /// Indices of the live columns that the model uses, and a buffer for them.
    columns: Vec<usize>,
    inputs: Vec<f32>,
    features: Features,
    fallback: Fallback,
    /// Flags of the last five samples, newest in the lowest bit.
    doubtful: u32,
    sure_s: f64,
    unsure: Option<Unsure>,
    share: f64,
    held_n: Vector3<f64>,
    held_s: f64,
    last_t_s: Option<f64>,
}

impl TipForce {
    /// Prepares a model for the loop.
    ///
    /// # Errors
    /// [`NotLive`] if the model needs a column that is not available in the loop.
    pub fn new(model: Model, fallback: Fallback) -> Result<Self, NotLive> {
        let live = |name: &String| {
            let place = DEFAULT_INPUTS.iter().position(|column| column == name);
            place.ok_or_else(|| NotLive { found: name.clone() })
        };
        let columns = model.inputs.iter().map(live).collect::<Result<Vec<_>, _>>()?;
        if !model.outputs.iter().eq(DEFAULT_OUTPUTS.iter()) {
            return Err(NotLive { found: model.outputs.join(", ") });
        }
        Ok(Self {
            inputs: vec![0.0; columns.len()],
            columns,
            estimator: Estimator::new(model),
            features: Features::new(FeatureSettings::default()),
            fallback,
            doubtful: 0,
            sure_s: 0.0,
            unsure: Some(Unsure::NotMoved),
            share: 0.0,
            held_n: Vector3::zeros(),
            held_s: f64::INFINITY,
            last_t_s: None,
        })
    }

    /// The model.
    pub const fn model(&self) -> &Model {
        self.estimator.model()
    }

    /// Force to use while the network is uncertain.
    pub const fn fallback(&self) -> Fallback {
        self.fallback
    }

    /// The force for this sample. Must be called with every sample, in order.
    pub fn step(&mut self, t_s: f64, gravity_free: &Wrench, sample: &WristSample) -> TipForceReport {
        let dt_s = self.last_t_s.map_or(0.0, |last| (t_s - last).clamp(0.0, HANDOVER_S));
        self.last_t_s = Some(t_s);
        let (answer_n, doubt, reason) = match self.features.step(t_s, gravity_free, sample) {
            Ok(row) => {
                self.inputs.iter_mut().zip(&self.columns).for_each(|(to, column)| *to = row[*column]);
                let estimate = self.estimator.estimate(&self.inputs);
                let [x, y, z, ..] = estimate.output.map(f64::from);
                let reason = estimate.in_doubt.then_some(Unsure::OutsideTraining);
                (Some(Vector3::new(x, y, z)), estimate.doubt, reason)
            }
            Err(NoRow::Missing) => (None, f32::INFINITY, Some(Unsure::Missing)),
            Err(NoRow::NotMoved) => (None, f32::INFINITY, Some(Unsure::NotMoved)),
        };
        self.judge(reason, answer_n.is_none(), dt_s);
        self.held_s += dt_s;
        if let (Some(answer_n), None) = (answer_n, reason) {
            (self.held_n, self.held_s) = (answer_n, 0.0);
        }
        let target = if self.unsure.is_none() { 1.0 } else { 0.0 };
        self.share += (target - self.share).clamp(-dt_s / HANDOVER_S, dt_s / HANDOVER_S);
        // A single uncertain prediction is replaced by the last reliable one.
        let force_s1_n = self.held_n * self.share + self.fallback_n(gravity_free) * (1.0 - self.share);
        TipForceReport { force_s1_n, network_share: self.share, unsure: self.unsure, doubt }
    }

    fn judge(&mut self, reason: Option<Unsure>, no_row: bool, dt_s: f64) {
        self.doubtful = (self.doubtful << 1 | u32::from(reason.is_some())) & 0b1_1111;
        self.sure_s = if reason.is_some() { 0.0 } else { self.sure_s + dt_s };
        if let Some(reason) = reason
            && (no_row || self.doubtful.count_ones() >= DOUBTFUL_OF_FIVE || self.unsure.is_some())
        {
            self.unsure = Some(reason);
        } else if self.sure_s >= SURE_AFTER_S {
            self.unsure = None;
        }
    }

    fn fallback_n(&self, gravity_free: &Wrench) -> Vector3<f64> {
        match self.fallback {
            Fallback::WristForce if gravity_free.is_finite() => gravity_free.force_n,
            Fallback::WristForce => Vector3::zeros(),
            Fallback::HoldAndFade => self.held_n * (1.0 - self.held_s / HOLD_S).max(0.0),
        }
    }
}
