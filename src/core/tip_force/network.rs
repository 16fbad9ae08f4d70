//! Inference of the network: an ensemble of small networks, in f32, without allocation.
//!
//! A member computes `y = S x + W_k a(... a(W_1 x + b_1) ...) + b_k` with the activation `a(z) = z / sqrt(1 + z^2)`:
//! smooth, bounded, and composed of operations that a vector unit provides, so that training and inference compute the
//! same function. The linear path `S` represents the linear part; the layers learn the nonlinear part, which is faded
//! out beyond the training data. The ensemble returns the mean of its members. Inputs and outputs are normalised (see
//! [`Normalisation`](super::Normalisation)); NaN in the input gives NaN.

use super::MAX_OUTPUTS;

/// Number of values processed at once; rows of weights are padded with zeros to a multiple of it. The width of AVX2 for
/// 32-bit numbers, because that is the widest unit that most computers have.
const LANE: usize = 8;

/// A matrix with a bias: `outputs = inputs W + b`.
///
/// ```
/// use nima_core::tip_force::TipForceLayer;
///
/// let layer = TipForceLayer::new(2, 1, &[0.5, -1.0], &[0.1]).expect("sizes agree");
/// assert_eq!((layer.shape(), layer.weights()), ((2, 1), vec![0.5, -1.0]));
/// assert!(TipForceLayer::new(2, 1, &[0.5], &[0.1]).is_none(), "a weight is missing");
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct TipForceLayer {
    inputs: usize,
    outputs: usize,
    padded: usize,
    /// Row `i` contains the weights from input `i` to every output.
    weights: Vec<f32>,
    bias: Vec<f32>,
}

impl TipForceLayer {
    /// Creates a layer with weights stored input by input (`inputs x outputs`) and a bias of length `outputs`; `None`
    /// if the sizes disagree.
    pub fn new(inputs: usize, outputs: usize, weights: &[f32], bias: &[f32]) -> Option<Self> {
        if inputs == 0 || outputs == 0 || weights.len() != inputs * outputs || bias.len() != outputs {
            return None;
        }
        let padded = outputs.next_multiple_of(LANE);
        let mut layer = Self { inputs, outputs, padded, weights: vec![0.0; inputs * padded], bias: vec![0.0; padded] };
        for (to, from) in layer.weights.chunks_mut(padded).zip(weights.chunks(outputs)) {
            to[..outputs].copy_from_slice(from);
        }
        layer.bias[..outputs].copy_from_slice(bias);
        Some(layer)
    }

    pub const fn shape(&self) -> (usize, usize) {
        (self.inputs, self.outputs)
    }

    /// Returns the weights, `inputs x outputs`, without padding.
    pub fn weights(&self) -> Vec<f32> {
        self.weights.chunks(self.padded).flat_map(|row| row[..self.outputs].iter().copied()).collect()
    }

    pub fn bias(&self) -> &[f32] {
        &self.bias[..self.outputs]
    }

    /// Adds `inputs W` to `to`, which must be padded.
    fn accumulate(&self, inputs: &[f32], to: &mut [f32]) {
        for (input, row) in inputs[..self.inputs].iter().zip(self.weights.chunks_exact(self.padded)) {
            for (to, weight) in to.chunks_exact_mut(LANE).zip(row.chunks_exact(LANE)) {
                // A fixed inner length lets the compiler use one vector instruction.
                for lane in 0..LANE {
                    to[lane] += input * weight[lane];
                }
            }
        }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct Member {
    layers: Vec<TipForceLayer>,
    skip: TipForceLayer,
}

impl Member {
    /// Creates a network with these layers and the linear path; `None` if the sizes do not match.
    pub fn new(layers: Vec<TipForceLayer>, skip: TipForceLayer) -> Option<Self> {
        let first = layers.first()?;
        let last = layers.last()?;
        let chained = layers.windows(2).all(|pair| pair[0].outputs == pair[1].inputs);
        // A wider output would not fit the arrays of fixed size.
        let fits = first.inputs == skip.inputs && last.outputs == skip.outputs && skip.outputs <= MAX_OUTPUTS;
        (chained && fits).then_some(Self { layers, skip })
    }

    /// Returns the layers, from the inputs to the outputs.
    pub fn layers(&self) -> &[TipForceLayer] {
        &self.layers
    }

    pub const fn skip(&self) -> &TipForceLayer {
        &self.skip
    }

    pub const fn shape(&self) -> (usize, usize) {
        self.skip.shape()
    }

    fn run(&self, inputs: &[f32], trust: f32, [now, next]: &mut [Vec<f32>; 2]) -> [f32; MAX_OUTPUTS] {
        let last = self.layers.len() - 1;
        for (k, layer) in self.layers.iter().enumerate() {
            let to = &mut next[..layer.padded];
            to.copy_from_slice(&layer.bias);
            layer.accumulate(if k == 0 { inputs } else { now }, to);
            if k == last {
                for z in &mut *to {
                    // Only the last layer is scaled: its sum is the nonlinear part, and the linear path is added
                    // afterwards.
                    *z *= trust;
                }
                self.skip.accumulate(inputs, to);
            } else {
                for z in to {
                    // A smooth step without an exponential: `z / sqrt(1 + z^2)` costs one root.
                    *z /= (1.0 + *z * *z).sqrt();
                }
            }
            std::mem::swap(now, next);
        }
        let mut outputs = [0.0; MAX_OUTPUTS];
        outputs[..self.skip.outputs].copy_from_slice(&now[..self.skip.outputs]);
        outputs
    }
}

/// Output of an ensemble for one row of normalised inputs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnsembleOutput {
    pub mean: [f32; MAX_OUTPUTS],
    /// Largest distance of a member from that mean, per output.
    pub spread: [f32; MAX_OUTPUTS],
}

#[derive(Clone, Debug)]
pub struct TipForceNetwork {
    members: Vec<Member>,
    buffers: [Vec<f32>; 2],
}

impl TipForceNetwork {
    /// Creates an ensemble of members of the same shape; `None` if there are no members or their shapes differ.
    pub fn new(members: Vec<Member>) -> Option<Self> {
        let shape = members.first()?.shape();
        let widest = members.iter().flat_map(|member| &member.layers).map(|layer| layer.padded).max()?;
        let buffer = vec![0.0; widest];
        members
            .iter()
            .all(|member| member.shape() == shape)
            .then(|| Self { members, buffers: [buffer.clone(), buffer] })
    }

    pub fn members(&self) -> &[Member] {
        &self.members
    }

    pub fn shape(&self) -> (usize, usize) {
        self.members[0].shape()
    }

    /// Evaluates all members on normalised inputs. `trust` (0 to 1) scales the nonlinear part: outside the training
    /// data, that part is unreliable, and the linear path alone is a better estimate. Allocates nothing.
    pub fn answer(&mut self, inputs: &[f32], trust: f32) -> EnsembleOutput {
        // Not zero: `new` refuses an empty ensemble.
        let count = self.members.len() as f32;
        let (mut mean, mut low, mut high) =
            ([0.0; MAX_OUTPUTS], [f32::INFINITY; MAX_OUTPUTS], [f32::NEG_INFINITY; MAX_OUTPUTS]);
        for member in &self.members {
            let outputs = member.run(inputs, trust, &mut self.buffers);
            for k in 0..MAX_OUTPUTS {
                mean[k] += outputs[k] / count;
                low[k] = low[k].min(outputs[k]);
                high[k] = high[k].max(outputs[k]);
            }
        }
        EnsembleOutput { mean, spread: std::array::from_fn(|k| (high[k] - mean[k]).max(mean[k] - low[k])) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn random_member(widths: &[usize], generator: &mut fastrand::Rng) -> Member {
        let mut layer = |inputs: usize, outputs: usize| {
            let mut draw = |n: usize| (0..n).map(|_| generator.f32() - 0.5).collect::<Vec<_>>();
            let weights = draw(inputs * outputs);
            let bias = draw(outputs);
            TipForceLayer::new(inputs, outputs, &weights, &bias).unwrap()
        };
        let layers = widths.windows(2).map(|pair| layer(pair[0], pair[1])).collect();
        let skip = TipForceLayer { bias: vec![0.0; LANE], ..layer(widths[0], widths[widths.len() - 1]) };
        Member::new(layers, skip).unwrap()
    }

    /// Returns the same function, implemented in the simplest way in f64.
    fn reference(member: &Member, inputs: &[f64]) -> Vec<f64> {
        let times = |layer: &TipForceLayer, inputs: &[f64]| -> Vec<f64> {
            let (n, m) = layer.shape();
            let weights = layer.weights();
            let dot = |o| (0..n).map(|i| inputs[i] * f64::from(weights[i * m + o])).sum::<f64>();
            (0..m).map(|o| f64::from(layer.bias()[o]) + dot(o)).collect()
        };
        let mut now = inputs.to_vec();
        for (k, layer) in member.layers.iter().enumerate() {
            now = times(layer, &now);
            if k + 1 < member.layers.len() {
                for z in &mut now {
                    *z /= z.hypot(1.0);
                }
            }
        }
        now.iter().zip(times(&member.skip, inputs)).map(|(a, b)| a + b).collect()
    }

    #[test]
    fn f32_agrees_with_f64_of_the_same_weights() {
        let mut generator = fastrand::Rng::with_seed(5);
        let members: Vec<_> = (0..4).map(|_| random_member(&[18, 32, 32, 3], &mut generator)).collect();
        let mut network = TipForceNetwork::new(members.clone()).unwrap();
        let mut worst = 0.0_f64;
        for _ in 0..1000 {
            let inputs: Vec<f32> = (0..18).map(|_| 6.0 * generator.f32() - 3.0).collect();
            let wide: Vec<f64> = inputs.iter().map(|x| f64::from(*x)).collect();
            let answer = network.answer(&inputs, 1.0);
            let all: Vec<_> = members.iter().map(|member| reference(member, &wide)).collect();
            for k in 0..3 {
                let mean = all.iter().map(|y| y[k]).sum::<f64>() / 4.0;
                let spread = all.iter().map(|y| (y[k] - mean).abs()).fold(0.0, f64::max);
                worst = worst.max((f64::from(answer.mean[k]) - mean).abs());
                worst = worst.max((f64::from(answer.spread[k]) - spread).abs());
            }
        }
        eprintln!("largest difference between f32 and f64: {worst:.1e} of an output's spread");
        assert!(worst < 2e-5 && worst > 0.0, "{worst}");
    }

    #[test]
    fn sizes_that_do_not_fit_are_refused() {
        assert!(TipForceLayer::new(2, 2, &[0.0; 3], &[0.0; 2]).is_none());
        let layer = |n, m| TipForceLayer::new(n, m, &vec![0.0; n * m], &vec![0.0; m]).unwrap();
        assert!(Member::new(vec![layer(3, 4), layer(5, 2)], layer(3, 2)).is_none());
        assert!(Member::new(vec![layer(3, 4), layer(4, 2)], layer(3, 1)).is_none());
        assert!(Member::new(Vec::new(), layer(3, 1)).is_none());
        let member = |n| Member::new(vec![layer(n, 4), layer(4, 2)], layer(n, 2)).unwrap();
        assert!(TipForceNetwork::new(vec![member(3), member(4)]).is_none());
        assert!(TipForceNetwork::new(Vec::new()).is_none());
    }
}
