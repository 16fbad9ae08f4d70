//! Simpler methods, fitted on the same rows and inputs, with which every network is compared.

use serde::{Deserialize, Serialize};

use super::{Expansion, MAX_FEATURES, Normalisation, linear};

/// Linear regression over columns: `y = constant + x W`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct BaselineRegression {
    /// `inputs x outputs`, row by row.
    weights: Vec<f32>,
    constant: Vec<f32>,
}

/// The simpler models that are compared with one network, stored in its file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Baselines {
    /// Per output: index of the input of the same name (`fx_n` for `tip_fx_n`), which the baseline "no model" returns
    /// unchanged.
    like: Vec<Option<usize>>,
    linear: BaselineRegression,
    /// Linear in the inputs and in `v / sqrt(v^2 + v0^2)` of every speed: Coulomb and viscous friction, and a constant.
    friction: BaselineRegression,
    soft: Vec<f32>,
}

/// Name of the baseline that uses the unmodified wrist force.
pub const NO_MODEL: &str = "no model";
pub const FRICTION: &str = "friction";
/// Names of the baselines, in the order of [`Baselines::predict`].
pub const BASELINES: [&str; 3] = [NO_MODEL, "linear", FRICTION];

impl Baselines {
    pub fn fit(inputs: &[String], outputs: &[String], x: &[f32], y: &[f32]) -> Self {
        let soft = Expansion::fit(inputs, x).soft(inputs.len());
        let like = |output: &String| {
            // Only outputs called `tip_...` have a counterpart at the wrist.
            let wrist = output.strip_prefix("tip_")?;
            inputs.iter().position(|input| input == wrist)
        };
        // At least one column, because `chunks_exact` refuses zero.
        let signs: Vec<f32> = x.chunks_exact(inputs.len().max(1)).flat_map(|row| with_signs(row, &soft)).collect();
        Self {
            like: outputs.iter().map(like).collect(),
            linear: BaselineRegression::fit(x, y, outputs.len()),
            friction: BaselineRegression::fit(&signs, y, outputs.len()),
            soft,
        }
    }

    /// Returns whether the baselines belong to a model with these numbers of inputs and outputs.
    pub fn fits(&self, inputs: usize, outputs: usize) -> bool {
        let signs = self.soft.iter().filter(|v0| **v0 > 0.0).count();
        let one = |regression: &BaselineRegression, width: usize| {
            regression.weights.len() == width * outputs && regression.constant.len() == outputs
        };
        let like = self.like.len() == outputs && self.like.iter().flatten().all(|column| *column < inputs);
        like && self.soft.len() == inputs
            && one(&self.linear, inputs)
            && one(&self.friction, inputs + signs)
            // A file with more is not one of ours, and would allocate without limit.
            && inputs + signs <= 2 * MAX_FEATURES
    }

    /// Returns the predictions of each of [`BASELINES`] for one row of inputs; `None` for an output that a method does
    /// not predict.
    pub fn predict(&self, inputs: &[f32]) -> [Vec<Option<f32>>; 3] {
        let none = self.like.iter().map(|column| column.map(|column| inputs[column])).collect();
        let friction = self.friction.predict(&with_signs(inputs, &self.soft));
        [none, self.linear.predict(inputs), friction]
    }
}

/// Returns the inputs, followed by the soft signs of the directions of motion.
fn with_signs(inputs: &[f32], soft: &[f32]) -> Vec<f32> {
    // `v0` of zero marks a column that is not a direction of motion.
    let sign = |(v, v0): (&f32, &f32)| (*v0 > 0.0).then(|| v / (v * v + v0 * v0).sqrt());
    inputs.iter().copied().chain(inputs.iter().zip(soft).filter_map(sign)).collect()
}

impl BaselineRegression {
    fn fit(x: &[f32], y: &[f32], outputs: usize) -> Self {
        let rows = y.len() / outputs.max(1);
        let width = x.len() / rows.max(1);
        let nx = Normalisation::of(x, width, 0..rows);
        let ny = Normalisation::of(y, outputs, 0..rows);
        let mut x = x.to_vec();
        let mut y = y.to_vec();
        x.chunks_mut(width).for_each(|row| nx.apply(row));
        y.chunks_mut(outputs).for_each(|row| ny.apply(row));
        let mut weights = linear::solve(&x, &y, (width, outputs), &(0..rows).collect::<Vec<_>>());
        let mut constant = ny.mean.clone();
        for (k, row) in weights.chunks_mut(outputs).enumerate() {
            for (o, weight) in row.iter_mut().enumerate() {
                // The regression was fitted on normalised data; this converts its weights back to the columns' own
                // units.
                *weight *= nx.inverse_sd[k] / ny.inverse_sd[o];
                constant[o] -= *weight * nx.mean[k];
            }
        }
        Self { weights, constant }
    }

    fn predict(&self, inputs: &[f32]) -> Vec<Option<f32>> {
        let outputs = self.constant.len();
        let dot = |o: usize| inputs.iter().enumerate().map(|(k, x)| x * self.weights[k * outputs + o]).sum::<f32>();
        (0..outputs).map(|o| Some(self.constant[o] + dot(o))).collect()
    }
}
