//! `AdamW`: Loshchilov and Hutter, "Decoupled weight decay regularization", ICLR 2019, algorithm 2.

/// Decay rates of the mean gradient and of its mean square, and the constant that keeps the division finite: the
/// paper's values.
const MEAN: f32 = 0.9;
const SQUARE: f32 = 0.999;
const SMALL: f32 = 1e-8;

/// The optimiser's state for one set of parameters.
pub(super) struct AdamW {
    weight_decay: f32,
    mean: Vec<f32>,
    square: Vec<f32>,
    steps: i32,
}

impl AdamW {
    pub(super) fn new(parameters: usize, weight_decay: f64) -> Self {
        Self { weight_decay: weight_decay as f32, mean: vec![0.0; parameters], square: vec![0.0; parameters], steps: 0 }
    }

    /// Takes one step down the gradient at this learning rate.
    pub(super) fn step(&mut self, learning_rate: f64, gradient: &[f32], parameters: &mut [f32]) {
        self.steps += 1;
        let rate = learning_rate as f32;
        let decay = 1.0 - rate * self.weight_decay;
        // The means start at zero; this corrects them in the first steps (the paper's bias correction).
        let [of_mean, of_square] = [MEAN, SQUARE].map(|memory| 1.0 / (1.0 - memory.powi(self.steps)));
        let moments = self.mean.iter_mut().zip(&mut self.square);
        for ((parameter, gradient), (mean, square)) in parameters.iter_mut().zip(gradient).zip(moments) {
            *mean += (1.0 - MEAN) * (gradient - *mean);
            *square += (1.0 - SQUARE) * (gradient * gradient - *square);
            *parameter = *parameter * decay - rate * (*mean * of_mean) / ((*square * of_square).sqrt() + SMALL);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_step_is_the_learning_rate_against_the_sign_whatever_the_size_of_the_gradient() {
        for size in [1e-4, 1.0, 1e4] {
            let mut parameters = [1.0, -2.0, 3.0];
            AdamW::new(3, 0.0).step(0.1, &[size, -size, 0.0], &mut parameters);
            for (found, expected) in parameters.into_iter().zip([0.9, -1.9, 3.0]) {
                assert!((found - expected).abs() < 1e-4, "{parameters:?}");
            }
        }
    }

    #[test]
    fn decay_shrinks_what_has_no_gradient() {
        let mut parameters = [2.0];
        let mut optimiser = AdamW::new(1, 0.5);
        (0..10).for_each(|_| optimiser.step(0.1, &[0.0], &mut parameters));
        assert!((parameters[0] - 2.0 * 0.95_f32.powi(10)).abs() < 1e-5, "{parameters:?}");
    }

    #[test]
    fn a_valley_of_unlike_curvatures_is_walked_to_its_bottom() {
        let mut parameters = [3.0_f32, -3.0];
        let mut optimiser = AdamW::new(2, 0.0);
        for step in 0..3000 {
            let gradient = [1000.0 * (parameters[0] - 1.0), 0.1 * (parameters[1] - 2.0)];
            optimiser.step(0.02 * (1.0 - f64::from(step) / 3000.0), &gradient, &mut parameters);
        }
        assert!((parameters[0] - 1.0).abs() < 1e-2 && (parameters[1] - 2.0).abs() < 1e-2, "{parameters:?}");
    }
}
