//! Calibrations: each returns a verdict with its reason, and the residuals on data that were not used for the fit.
//!
//! `gravity` removes the tool's weight and the sensor's bias from a wrist sensor's readings; `correspondence` finds the
//! rotation between the sensor under the tissue and the one at the wrist; `frames` finds the poses of tip, marker,
//! tracker, trocar, table, camera image and wrist sensor. Each is stored as a [`CalibrationRecord`], which is bound to sensor,
//! tool and date. SI units; frames as in [`crate::frames`].

pub mod correspondence;
pub mod frames;
pub mod gravity;
mod record;
mod rotation_mean;
mod verdict;

pub use record::{CalibrationRecord, Judgement, RecordHead};
pub use verdict::{AxisStats, Residuals, Verdict};
