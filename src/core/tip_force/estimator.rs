//! Predicts the outputs for one row of inputs, and whether the prediction is reliable. Allocates nothing after
//! construction; computes in f32.

use super::{ForceModel, MAX_OUTPUTS};

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TipForceEstimate {
    /// The outputs in their own units, in the model's order; unused entries are zero.
    pub output: [f32; MAX_OUTPUTS],
    /// Largest deviation of a member from the mean, per output, in the output's unit.
    pub spread: [f32; MAX_OUTPUTS],
    /// Distance from the training data: 1 is the limit; infinite for inputs that are not finite.
    pub doubt: f32,
    pub in_doubt: bool,
}

#[derive(Clone, Debug)]
pub struct Estimator {
    model: ForceModel,
    features: Vec<f32>,
    scratch: Vec<f32>,
}

impl Estimator {
    /// Prepares a model; allocates everything that it needs.
    pub fn new(model: ForceModel) -> Self {
        let features = vec![0.0; model.expansion.width()];
        let scratch = vec![0.0; model.doubt.width];
        Self { model, features, scratch }
    }

    pub const fn model(&self) -> &ForceModel {
        &self.model
    }

    /// Predicts for one row of inputs, in the order of [`ForceModel::inputs`]. A wrong number of inputs or a non-finite
    /// input gives zeros with `in_doubt`.
    pub fn estimate(&mut self, inputs: &[f32]) -> TipForceEstimate {
        // Zero force with infinite doubt: the caller then uses its fallback.
        let refused = TipForceEstimate { doubt: f32::INFINITY, in_doubt: true, ..TipForceEstimate::default() };
        let Self { model, features, scratch } = self;
        if inputs.len() != model.inputs.len() || !inputs.iter().all(|x| x.is_finite()) {
            return refused;
        }
        model.expansion.expand(inputs, features);
        // Constant features must be checked before the normalisation sets them to zero.
        let moved = moved(features, &model.features.mean, &model.features.inverse_sd);
        model.features.apply(features);
        if !features.iter().all(|x| x.is_finite()) {
            return refused;
        }
        let outside = model.doubt.outside(features, scratch).max(moved);
        // The distance of the inputs from the training data is known before the members run; it sets the trust in their
        // nonlinear part.
        let answer = model.network.answer(features, trust(outside));
        let outputs = model.outputs.len();
        let score = outside.max(model.doubt.disagreement(&answer.spread[..outputs]));
        let mut output = answer.mean;
        model.scale.undo(&mut output[..outputs]);
        // Unused entries would otherwise show the padding of the network.
        output[outputs..].fill(0.0);
        if !output.iter().all(|y| y.is_finite()) {
            return refused;
        }
        let mut spread = [0.0; MAX_OUTPUTS];
        for k in 0..outputs {
            spread[k] = answer.spread[k] / model.scale.inverse_sd[k];
        }
        TipForceEstimate { output, spread, doubt: score, in_doubt: score > 1.0 }
    }
}

/// Returns the weight of the nonlinear part: 1 within the training data, falling to 0 at 1.25 times the limit of doubt.
fn trust(outside: f32) -> f32 {
    // `(1.25 - x) / 0.25`: linear between the limit and 1.25 times it, so that nothing switches.
    (5.0 - 4.0 * outside).clamp(0.0, 1.0)
}

/// Returns infinity if a feature that was constant in training differs from its value beyond rounding, otherwise zero.
fn moved(features: &[f32], mean: &[f32], inverse_sd: &[f32]) -> f32 {
    let differs =
        // A thousandth of the value, and a hundred-thousandth near zero: more than the rounding of a file with 32-bit
        // numbers.
        |((x, mean), inverse): ((&f32, &f32), &f32)| *inverse == 0.0 && (x - mean).abs() > 1e-3 * mean.abs() + 1e-5;
    if features.iter().zip(mean).zip(inverse_sd).any(differs) { f32::INFINITY } else { 0.0 }
}
