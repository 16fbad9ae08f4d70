//! Calibrations that prove themselves: each gives a verdict with its reason and its residuals on data it was not fitted on.
//!
//! `gravity` takes the tool's weight and the sensor's bias out of a wrist sensor's readings; `correspondence` finds how the
//! sensor under the tissue is turned against the one at the wrist. A [`Record`] of each is bound to sensor, tool and date.
//! SI units; frames as in [`crate::frames`].

pub mod correspondence;
pub mod gravity;
mod record;
mod verdict;

pub use record::{Judgement, Record, RecordHead};
pub use verdict::{AxisStats, Residuals, Verdict};
