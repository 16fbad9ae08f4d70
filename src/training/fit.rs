//! Training of one member.

use std::sync::atomic::{AtomicBool, Ordering};

use nalgebra::DMatrix;
use nima_core::tip_force::{Member, MemberFigures, TrainingSettings};
use nima_recording::tip_force::TipForceError;

use super::{
    TrainingProgress,
    adamw::AdamW,
    perceptron::{Batch, Perceptron},
};

/// Training of a member stops after this fraction of the maximum epochs without a lower validation loss.
const PATIENCE: f64 = 0.25;
/// Number of rows evaluated at once in a validation pass.
const CHUNK: usize = 1024;

/// Data common to all members: normalised features and outputs, row by row, and their column counts.
pub(super) struct TrainingFit<'a> {
    pub(super) x: &'a [f32],
    pub(super) y: &'a [f32],
    pub(super) shape: (usize, usize),
    /// The linear path, solved over all rows, because with so few parameters it cannot overfit.
    pub(super) skip: &'a [f32],
    pub(super) settings: &'a TrainingSettings,
    pub(super) cancel: &'a AtomicBool,
    pub(super) progress: &'a (dyn Fn(&TrainingProgress) + Sync),
}

impl TrainingFit<'_> {
    /// Trains one member on the training rows, with early stopping on the held-out rows.
    pub(super) fn member(
        &self,
        member: usize,
        training: &[usize],
        validation: &[usize],
    ) -> Result<(Member, MemberFigures), TipForceError> {
        // Multiplied, so that no member of another seed has the same sequence.
        let mut generator =
            fastrand::Rng::with_seed(self.settings.seed.wrapping_mul(1_000_003).wrapping_add(member as u64));
        let mut network = Perceptron::new(self.shape, &self.settings.hidden, self.skip, &mut generator);
        let mut optimiser = AdamW::new(network.parameters_mut().len(), self.settings.weight_decay);
        let epochs_max = self.settings.epochs_for(training.len());
        // At least five, because the loss of a few epochs varies by chance.
        let patience = ((epochs_max as f64 * PATIENCE).ceil() as usize).max(5);
        let mut order = training.to_vec();
        // A network that does not improve the held-out rows is dropped, leaving only the linear path.
        let training_loss = self.loss(&network, training);
        let validation_loss = self.loss(&network, validation);
        let mut figures = MemberFigures { epoch: 0, epochs: 0, training_loss, validation_loss };
        let mut best = network.clone();
        for epoch in 1..=epochs_max {
            generator.shuffle(&mut order);
            let part = (epoch - 1) as f64 / epochs_max as f64;
            let training_loss = self.epoch(&mut network, &mut optimiser, &order, [part, 1.0 / epochs_max as f64])?;
            let validation_loss = self.loss(&network, validation);
            if !(training_loss + validation_loss).is_finite() {
                return Err(TipForceError::Diverged { member: member + 1 });
            }
            if validation_loss < figures.validation_loss {
                figures = MemberFigures { epoch, epochs: epoch, training_loss, validation_loss };
                best = network.clone();
            }
            let finished = epoch == epochs_max || epoch - figures.epoch >= patience;
            figures.epochs = epoch;
            (self.progress)(&TrainingProgress {
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
        Ok((best.member().ok_or(TipForceError::Shapes)?, figures))
    }

    /// Runs one epoch over the rows in this order and returns the mean loss. `[from, length]` is its position within
    /// the whole training.
    fn epoch(
        &self,
        network: &mut Perceptron,
        optimiser: &mut AdamW,
        order: &[usize],
        [from, length]: [f64; 2],
    ) -> Result<f64, TipForceError> {
        let mut sum = 0.0;
        let mut batches = 0.0;
        let mut gradient = Vec::new();
        let total = order.len().div_ceil(self.settings.batch) as f64;
        for rows in order.chunks(self.settings.batch) {
            if self.cancel.load(Ordering::Relaxed) {
                return Err(TipForceError::Cancelled);
            }
            let part = from + length * batches / total;
            // Cosine decay of the learning rate (Loshchilov and Hutter, SGDR, ICLR 2017) to a fiftieth of the first.
            let fall = 0.02 + 0.98 * 0.5 * (1.0 + (std::f64::consts::PI * part).cos());
            sum += network.gradient(&self.batch(rows), &mut gradient);
            optimiser.step(self.settings.learning_rate * fall, &gradient, network.parameters_mut());
            batches += 1.0;
        }
        Ok(sum / batches)
    }

    fn loss(&self, network: &Perceptron, rows: &[usize]) -> f64 {
        let squares = rows.chunks(CHUNK).map(|rows| network.loss(&self.batch(rows)) * rows.len() as f64);
        squares.sum::<f64>() / rows.len().max(1) as f64
    }

    fn batch(&self, rows: &[usize]) -> Batch {
        let gather = |values: &[f32], width: usize| {
            let taken = rows.iter().flat_map(|row| &values[row * width..(row + 1) * width]).copied();
            DMatrix::from_iterator(width, rows.len(), taken)
        };
        Batch { x: gather(self.x, self.shape.0), y: gather(self.y, self.shape.1) }
    }
}
