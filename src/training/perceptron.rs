//! A member during training: its loss on a batch, and the gradient of the loss by back-propagation.
//!
//! The function is the one used for inference (`nima_core::tip_force::TipForceNetwork`): activation `a(z) = z / sqrt(1 + z^2)`,
//! whose slope is `(1 + z^2)^(-3/2)`. A batch has one column per row of the data, so that every product is a matrix
//! product.

use std::ops::Range;

use nalgebra::{DMatrix, DMatrixView};
use nima_core::tip_force::{Member, TipForceLayer};

/// Layers in parallel to a linear path, which is not trained. Outside the training data only the linear path remains.
#[derive(Clone, Debug)]
pub(super) struct Perceptron {
    /// Number of inputs, sizes of the hidden layers, number of outputs.
    widths: Vec<usize>,
    /// For each layer the weights, input by input, then the bias.
    parameters: Vec<f32>,
    skip: DMatrix<f32>,
}

/// Rows of data, one column each.
pub(super) struct Batch {
    pub(super) x: DMatrix<f32>,
    pub(super) y: DMatrix<f32>,
}

/// Outputs of a hidden layer, and the slope of its activation there.
struct HiddenLayer {
    output: DMatrix<f32>,
    slope: DMatrix<f32>,
}

impl Perceptron {
    /// Creates a network with uniform random weights, whose variance is one over the number of inputs. The last layer
    /// starts at zero, so that the initial model is the linear path (`skip`: input by input).
    pub(super) fn new(
        (inputs, outputs): (usize, usize),
        hidden: &[usize],
        skip: &[f32],
        generator: &mut fastrand::Rng,
    ) -> Self {
        let widths: Vec<usize> = [inputs].into_iter().chain(hidden.iter().copied()).chain([outputs]).collect();
        let mut parameters = Vec::new();
        for (k, pair) in widths.windows(2).enumerate() {
            let last = k + 2 == widths.len();
            // A uniform distribution from -r to r has the variance `r^2 / 3`.
            let reach = if last { 0.0 } else { (3.0 / pair[0] as f32).sqrt() };
            parameters.extend((0..(pair[0] + 1) * pair[1]).map(|_| reach * (2.0 * generator.f32() - 1.0)));
        }
        Self { widths, parameters, skip: DMatrix::from_column_slice(outputs, inputs, skip) }
    }

    pub(super) fn parameters_mut(&mut self) -> &mut [f32] {
        &mut self.parameters
    }

    fn layers(&self) -> usize {
        self.widths.len() - 1
    }

    /// Returns the ranges of a layer's weights and bias within the parameters.
    fn places(&self, layer: usize) -> [Range<usize>; 2] {
        let from: usize = self.widths.windows(2).take(layer).map(|pair| (pair[0] + 1) * pair[1]).sum();
        let bias = from + self.widths[layer] * self.widths[layer + 1];
        [from..bias, bias..bias + self.widths[layer + 1]]
    }

    /// Outputs x inputs.
    fn weights(&self, layer: usize) -> DMatrixView<'_, f32> {
        let [weights, _] = self.places(layer);
        DMatrixView::from_slice(&self.parameters[weights], self.widths[layer + 1], self.widths[layer])
    }

    fn bias(&self, layer: usize) -> &[f32] {
        let [_, bias] = self.places(layer);
        &self.parameters[bias]
    }

    /// `W a + b` for every column of `a`.
    fn affine(&self, layer: usize, a: &DMatrix<f32>) -> DMatrix<f32> {
        let mut z = self.weights(layer) * a;
        for mut column in z.column_iter_mut() {
            column.iter_mut().zip(self.bias(layer)).for_each(|(z, bias)| *z += bias);
        }
        z
    }

    fn forward(&self, x: &DMatrix<f32>) -> (Vec<HiddenLayer>, DMatrix<f32>) {
        let mut hidden: Vec<HiddenLayer> = Vec::with_capacity(self.layers() - 1);
        for layer in 0..self.layers() - 1 {
            let mut output = self.affine(layer, hidden.last().map_or(x, |before| &before.output));
            let mut slope = output.clone();
            for (z, slope) in output.iter_mut().zip(slope.iter_mut()) {
                let root = 1.0 / (1.0 + *z * *z).sqrt();
                *z *= root;
                *slope = root * root * root;
            }
            hidden.push(HiddenLayer { output, slope });
        }
        let mut output = self.affine(self.layers() - 1, hidden.last().map_or(x, |before| &before.output));
        output.gemm(1.0, &self.skip, x, 1.0);
        (hidden, output)
    }

    /// Returns the mean square error on a batch.
    pub(super) fn loss(&self, batch: &Batch) -> f64 {
        mean_square(&(self.forward(&batch.x).1 - &batch.y))
    }

    /// Returns the mean square error on a batch and writes its gradient.
    pub(super) fn gradient(&self, batch: &Batch, gradient: &mut Vec<f32>) -> f64 {
        let (hidden, output) = self.forward(&batch.x);
        let error = output - &batch.y;
        let loss = mean_square(&error);
        gradient.resize(self.parameters.len(), 0.0);
        let mut by_z = &error * (2.0 / error.len() as f32);
        for layer in (0..self.layers()).rev() {
            let before = if layer == 0 { &batch.x } else { &hidden[layer - 1].output };
            let [weights, bias] = self.places(layer);
            gradient[weights].copy_from_slice((&by_z * before.transpose()).as_slice());
            gradient[bias].copy_from_slice(by_z.column_sum().as_slice());
            if layer > 0 {
                by_z = self.weights(layer).transpose() * by_z;
                by_z.component_mul_assign(&hidden[layer - 1].slope);
            }
        }
        loss
    }

    /// Returns the current weights in the form used for inference; `None` if a width is zero or there are more outputs
    /// than that form can hold.
    pub(super) fn member(&self) -> Option<Member> {
        let layer = |k: usize| {
            let [weights, bias] = self.places(k).map(|place| &self.parameters[place]);
            TipForceLayer::new(self.widths[k], self.widths[k + 1], weights, bias)
        };
        let layers = (0..self.layers()).map(layer).collect::<Option<_>>()?;
        let (outputs, inputs) = self.skip.shape();
        Member::new(layers, TipForceLayer::new(inputs, outputs, self.skip.as_slice(), &vec![0.0; outputs])?)
    }
}

fn mean_square(error: &DMatrix<f32>) -> f64 {
    f64::from(error.norm_squared()) / error.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_gradient_is_the_slope_of_the_loss_in_every_direction() {
        let mut generator = fastrand::Rng::with_seed(1);
        let mut draw =
            |rows: usize, columns: usize| DMatrix::from_fn(rows, columns, |_, _| 2.0 * generator.f32() - 1.0);
        let skip = draw(2, 5);
        let batch = Batch { x: draw(5, 40), y: draw(2, 40) };
        let mut network = Perceptron::new((5, 2), &[7, 4], skip.as_slice(), &mut fastrand::Rng::with_seed(2));
        // The last layer starts at zero, where the other layers have no gradient, so start elsewhere.
        let start = draw(network.parameters.len(), 1);
        network.parameters.copy_from_slice(start.as_slice());
        let mut gradient = Vec::new();
        let loss = network.gradient(&batch, &mut gradient);
        assert!((loss - network.loss(&batch)).abs() < 1e-6);
        let step = 1e-2;
        for (k, slope) in gradient.iter().enumerate() {
            let at = |by: f32| {
                let mut moved = network.clone();
                moved.parameters_mut()[k] += by;
                moved.loss(&batch)
            };
            let measured = (at(step) - at(-step)) / (2.0 * f64::from(step));
            assert!((measured - f64::from(*slope)).abs() < 1e-3, "parameter {k}: {measured} and {slope}");
        }
    }

    #[test]
    fn what_is_trained_and_what_is_used_are_the_same_function() {
        use nima_core::tip_force::TipForceNetwork;
        let mut generator = fastrand::Rng::with_seed(3);
        let mut draw =
            |rows: usize, columns: usize| DMatrix::from_fn(rows, columns, |_, _| 2.0 * generator.f32() - 1.0);
        let skip = draw(3, 6);
        let x = draw(6, 20);
        let mut network = Perceptron::new((6, 3), &[9, 5], skip.as_slice(), &mut fastrand::Rng::with_seed(4));
        let start = draw(network.parameters.len(), 1);
        network.parameters.copy_from_slice(start.as_slice());
        let (_, said) = network.forward(&x);
        let mut used = TipForceNetwork::new(vec![network.member().unwrap()]).unwrap();
        for (x, said) in x.column_iter().zip(said.column_iter()) {
            let answer = used.answer(x.as_slice(), 1.0).mean;
            for (a, b) in answer.iter().zip(said.iter()) {
                assert!((a - b).abs() < 1e-5, "{a} and {b}");
            }
        }
    }
}
