//! Training and judging the network that gives the force at the tip.
//!
//! Takes a data set; gives a [`Model`](nima_core::tip_force::Model) and its figures on rows that it was not trained on. The one crate
//! that needs a tensor library. Belongs on a background thread; nothing here runs in the loop.
#![warn(missing_docs)]

mod check;
mod ensemble;
mod evaluation;
mod fit;
mod folds;
#[cfg(test)]
mod tests;

pub use check::check;
pub use ensemble::{MIN_ROWS, Progress, Trained, train, train_model};
pub use evaluation::{Evaluation, MethodFigures, NoContact, Part, Stats, evaluate};
