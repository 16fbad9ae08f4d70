//! Training and evaluation of the network that estimates the force at the tip.
//!
//! Takes a data set; returns a [`Model`](nima_core::tip_force::ForceModel) and its errors on held-out rows. Runs on a
//! background thread, never in the loop.

mod adamw;
mod check;
mod ensemble;
mod evaluation;
mod fit;
mod folds;
mod perceptron;
#[cfg(test)]
mod tests;

pub use check::check;
pub use ensemble::{MIN_ROWS, TrainedEnsemble, TrainingProgress, train, train_model};
pub use evaluation::{Evaluation, EvaluationPart, MethodFigures, NoContact, Stats, evaluate};
