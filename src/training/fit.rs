//! Training of one member.

use std::sync::atomic::{AtomicBool, Ordering};

use candle_core::{Device, Tensor, Var};
use candle_nn::optim::{AdamW, Optimizer as _, ParamsAdamW};
use nima_core::tip_force::{Layer, Member, MemberFigures, TrainingSettings};
use nima_recording::tip_force::TipForceError;

use super::Progress;

/// A member stops after this share of the maximum epochs without a lower validation loss.
const PATIENCE: f64 = 0.25;
/// Number of rows evaluated at once in a validation pass.
const CHUNK: usize = 8192;

/// Why a member could not be trained; includes errors of the tensor library.
#[derive(Debug)]
pub(super) struct Failure(pub(super) TipForceError);

impl From<candle_core::Error> for Failure {
    fn from(error: candle_core::Error) -> Self {
        Self(TipForceError::Tensor { reason: error.to_string() })
    }
}

/// Data common to all members: normalised features and outputs, row by row, and their numbers of columns.
pub(super) struct Fit<'a> {
    pub(super) x: &'a [f32],
    pub(super) y: &'a [f32],
    pub(super) shape: (usize, usize),
    /// The linear path, solved over all rows: with so few parameters it cannot overfit.
    pub(super) skip: &'a [f32],
    pub(super) settings: &'a TrainingSettings,
    pub(super) cancel: &'a AtomicBool,
    pub(super) progress: &'a (dyn Fn(&Progress) + Sync),
}

/// Weights during training.
struct Weights {
    layers: Vec<(Var, Var)>,
    skip: Tensor,
}

impl Fit<'_> {
    /// Trains one member on the training rows, with early stopping on the held-out rows.
    pub(super) fn member(
        &self,
        member: usize,
        training: &[usize],
        validation: &[usize],
    ) -> Result<(Member, MemberFigures), Failure> {
        let mut generator =
            fastrand::Rng::with_seed(self.settings.seed.wrapping_mul(1_000_003).wrapping_add(member as u64));
        let weights = Weights::new(self.shape, &self.settings.hidden, self.skip.to_vec(), &mut generator)?;
        let parameters = ParamsAdamW {
            lr: self.settings.learning_rate,
            weight_decay: self.settings.weight_decay,
            ..ParamsAdamW::default()
        };
        let mut optimiser = AdamW::new(weights.all(), parameters)?;
        let epochs_max = self.settings.epochs_for(training.len());
        let patience = ((epochs_max as f64 * PATIENCE).ceil() as usize).max(5);
        let mut order = training.to_vec();
        // A network that does not improve the held-out rows is dropped, and the linear path is used alone.
        let (training_loss, validation_loss) = (self.loss(&weights, training)?, self.loss(&weights, validation)?);
        let mut figures = MemberFigures { epoch: 0, epochs: 0, training_loss, validation_loss };
        let mut best = weights.member()?;
        for epoch in 1..=epochs_max {
            generator.shuffle(&mut order);
            let part = (epoch - 1) as f64 / epochs_max as f64;
            let training_loss = self.epoch(&weights, &mut optimiser, &order, [part, 1.0 / epochs_max as f64])?;
            let validation_loss = self.loss(&weights, validation)?;
            if !(training_loss + validation_loss).is_finite() {
                return Err(Failure(TipForceError::Diverged { member: member + 1 }));
            }
            if validation_loss < figures.validation_loss {
                figures = MemberFigures { epoch, epochs: epoch, training_loss, validation_loss };
                best = weights.member()?;
            }
            let finished = epoch == epochs_max || epoch - figures.epoch >= patience;
            figures.epochs = epoch;
            (self.progress)(&Progress {
                member,
                members: self.settings.members,
                epoch,
                epochs_max,
                training_loss,
                validation_loss,
                best: figures.validation_loss,
                elapsed_s: 0.0,
                finished,
            });
            if finished {
                break;
            }
        }
        Ok((best, figures))
    }

    /// One epoch over the rows in this order; returns the mean loss. `[from, length]` is its position within the whole
    /// training.
    fn epoch(
        &self,
        weights: &Weights,
        optimiser: &mut AdamW,
        order: &[usize],
        [from, length]: [f64; 2],
    ) -> Result<f64, Failure> {
        let (mut sum, mut batches) = (0.0, 0.0);
        let total = order.len().div_ceil(self.settings.batch) as f64;
        for rows in order.chunks(self.settings.batch) {
            if self.cancel.load(Ordering::Relaxed) {
                return Err(Failure(TipForceError::Cancelled));
            }
            let part = from + length * batches / total;
            let fall = 0.02 + 0.98 * 0.5 * (1.0 + (std::f64::consts::PI * part).cos());
            optimiser.set_learning_rate(self.settings.learning_rate * fall);
            let (x, y) = self.batch(rows)?;
            let loss = (weights.forward(&x)? - y)?.sqr()?.mean_all()?;
            optimiser.backward_step(&loss)?;
            sum += f64::from(loss.to_scalar::<f32>()?);
            batches += 1.0;
        }
        Ok(sum / batches)
    }

    fn loss(&self, weights: &Weights, rows: &[usize]) -> Result<f64, Failure> {
        let mut sum = 0.0;
        for rows in rows.chunks(CHUNK) {
            let (x, y) = self.batch(rows)?;
            let loss = (weights.forward(&x)? - y)?.sqr()?.mean_all()?.to_scalar::<f32>()?;
            sum += f64::from(loss) * rows.len() as f64;
        }
        Ok(sum / rows.len().max(1) as f64)
    }

    fn batch(&self, rows: &[usize]) -> Result<(Tensor, Tensor), Failure> {
        let gather = |values: &[f32], width: usize| {
            let mut taken = Vec::with_capacity(rows.len() * width);
            for row in rows {
                taken.extend_from_slice(&values[row * width..(row + 1) * width]);
            }
            Tensor::from_vec(taken, (rows.len(), width), &Device::Cpu)
        };
        Ok((gather(self.x, self.shape.0)?, gather(self.y, self.shape.1)?))
    }
}

impl Weights {
    /// Uniform initial weights of variance one over the number of inputs. The last layer starts at zero, so that the
    /// initial model is the linear path. The linear path itself is not trained, because outside the training data only
    /// it remains.
    fn new(
        (inputs, outputs): (usize, usize),
        hidden: &[usize],
        skip: Vec<f32>,
        generator: &mut fastrand::Rng,
    ) -> Result<Self, Failure> {
        let widths: Vec<usize> = [inputs].into_iter().chain(hidden.iter().copied()).chain([outputs]).collect();
        let mut layers = Vec::new();
        for (k, pair) in widths.windows(2).enumerate() {
            let last = k + 2 == widths.len();
            let reach = if last { 0.0 } else { (3.0 / pair[0] as f32).sqrt() };
            let mut draw = |n: usize| (0..n).map(|_| reach * (2.0 * generator.f32() - 1.0)).collect::<Vec<_>>();
            let matrix = Var::from_vec(draw(pair[0] * pair[1]), (pair[0], pair[1]), &Device::Cpu)?;
            let bias = Var::from_vec(draw(pair[1]), (1, pair[1]), &Device::Cpu)?;
            layers.push((matrix, bias));
        }
        let skip = Tensor::from_vec(skip, (inputs, outputs), &Device::Cpu)?;
        Ok(Self { layers, skip })
    }

    fn all(&self) -> Vec<Var> {
        self.layers.iter().flat_map(|(matrix, bias)| [matrix.clone(), bias.clone()]).collect()
    }

    fn forward(&self, x: &Tensor) -> candle_core::Result<Tensor> {
        let mut now = x.clone();
        for (k, (matrix, bias)) in self.layers.iter().enumerate() {
            now = now.matmul(matrix)?.broadcast_add(bias)?;
            if k + 1 < self.layers.len() {
                // z / sqrt(1 + z^2), as in the inference.
                let root = now.sqr()?.affine(1.0, 1.0)?.sqrt()?;
                now = (now / root)?;
            }
        }
        now + x.matmul(&self.skip)?
    }

    /// The present weights in the form used for inference.
    fn member(&self) -> Result<Member, Failure> {
        let flat = |var: &Tensor| var.flatten_all().and_then(|flat| flat.to_vec1::<f32>());
        let layer = |matrix: &Tensor, bias: Vec<f32>| {
            let (inputs, outputs) = matrix.dims2()?;
            let built = Layer::new(inputs, outputs, &flat(matrix)?, &bias);
            built.ok_or_else(|| candle_core::Error::Msg("a layer lost its shape".into()))
        };
        let layers = self.layers.iter().map(|(matrix, bias)| layer(matrix, flat(bias)?)).collect::<Result<_, _>>()?;
        let outputs = self.skip.dims2()?.1;
        let skip = layer(&self.skip, vec![0.0; outputs])?;
        Member::new(layers, skip)
            .ok_or_else(|| Failure(TipForceError::Tensor { reason: "layers do not fit together".into() }))
    }
}
