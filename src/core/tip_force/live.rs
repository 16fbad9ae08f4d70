//! The tip force in the loop: a network while it is sure of itself, and a chosen fallback while it is not.
//!
//! Takes the gravity-free wrench (N, Nm, `s1`), the wrist sample and its time (s); gives the force at the tip (N, `s1`) and
//! says who answered. Three doubtful samples of the last five hand over to the fallback; the network comes back after 50 ms
//! without doubt. Between the two the answer is faded over 50 ms, so that no handover is felt as a push. Allocates nothing.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::{DEFAULT_INPUTS, DEFAULT_OUTPUTS, Estimator, FeatureSettings, Features, Model, NoRow};
use crate::frames::{Wrench, WristSample};

/// A good model whose columns a live wrist does not deliver.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the model works with {found}, which the live loop does not know; train one on the default columns")]
pub struct NotLive {
    /// What the loop does not know.
    pub found: String,
}

/// What answers while the network is in doubt.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Fallback {
    /// The gravity-free force at the wrist: the trocar's friction is felt again.
    #[default]
    WristForce,
    /// The last sure answer, fading to nothing over 0.3 s: what is not known is not felt.
    HoldAndFade,
}

/// Why the network does not answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unsure {
    /// The sample lies outside of what the network was trained on.
    OutsideTraining,
    /// The instrument has not moved yet, or samples were missing: the friction's direction is not known.
    NotMoved,
    /// The sample lacks the orientation or the depth through the trocar.
    Missing,
}

/// The answer to one sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TipForceReport {
    /// Force of the tissue on the tip, N (`s1`).
    pub force_s1_n: Vector3<f64>,
    /// Share of the network in it, 0 to 1; the rest is the fallback's.
    pub network_share: f64,
    /// Who answers from here on: `None` is the network.
    pub unsure: Option<Unsure>,
    /// How far this sample lies from the training data, 1 at the limit; endless where there is no row.
    pub doubt: f32,
}

/// Doubtful samples of the last five that hand over to the fallback.
const DOUBTFUL_OF_FIVE: u32 = 3;
/// Time without doubt after which the network answers again, s.
const SURE_AFTER_S: f64 = 0.050;
/// Time in which one answer is faded into the other, s.
const HANDOVER_S: f64 = 0.050;
/// Time in which a held answer fades to nothing, s.
const HOLD_S: f64 = 0.300;

/// A network at work.
#[derive(Clone, Debug)]
pub struct TipForce {
    estimator: Estimator,
    /// Which live columns the model reads, and room for them.
    columns: Vec<usize>,
    inputs: Vec<f32>,
    features: Features,
    fallback: Fallback,
    /// Doubt of the last five samples, newest in the lowest bit.
    doubtful: u32,
    sure_s: f64,
    unsure: Option<Unsure>,
    share: f64,
    held_n: Vector3<f64>,
    held_s: f64,
    last_t_s: Option<f64>,
}

impl TipForce {
    /// Takes a model into the loop; refuses one whose columns a live wrist does not deliver.
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

    /// What answers while the network is in doubt.
    pub const fn fallback(&self) -> Fallback {
        self.fallback
    }

    /// The answer to this sample. Call with every sample, in order.
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
        // A single doubtful answer is not given: the last sure one stands for it.
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
