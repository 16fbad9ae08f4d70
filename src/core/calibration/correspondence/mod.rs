//! Correspondence: the rotation between the sensor under the tissue (`s2`) and the one at the wrist (`s1`).
//!
//! Input: pairs of gravity-free forces (N) that both sensors measured at the same time, and the known part of the chain
//! `s1_from_c` of each; finds the `R = c_from_s2` that minimises `sum |s1_from_c_i R f2_i - f1_i|^2`. Without a chain
//! (`s1_from_c` all identity) the result is `s1_from_s2`. Both sensors must measure the force on the instrument; for a
//! sensor that measures the force on the tissue set [`CorrespondenceOptions::flip_s2`].
//!
//! The solver is Wahba's problem by singular values (Markley 1988) with a seeded consensus over pairs of pushes, so
//! that a quarter of gross outliers does no harm; the paper's search over Euler angles serves as a cross-check. The
//! verdict is based on residuals of held-out pushes, and on whether the pushes span all three dimensions: pushes along
//! one line or in one plane are refused. Non-finite or implausible numbers are errors; poor data get a verdict with its
//! reason.

mod diagnosis;
mod euler;
mod excitation;
mod fit;
mod interval;
mod record;
mod report;
mod session;
mod solver;
#[cfg(test)]
mod tests;

use nalgebra::{UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

use crate::frames::WristSample;

pub use diagnosis::{OffsetFrame, SensorDiagnosis};
pub use excitation::CorrespondenceExcitation;
pub use fit::fit;
pub use record::{CorrespondenceKind, CorrespondenceRecord};
pub use report::{CorrespondenceReport, CorrespondenceSolution, FitTarget, PushAgreement};
pub use session::{
    CorrespondencePhase, CorrespondenceSession, CorrespondenceSessionSettings, MissingInput, PushRefusal, PushTarget,
    TARGETS,
};

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PushPair {
    /// Gravity-free force at the wrist, N (`s1`).
    pub f1_n: Vector3<f64>,
    /// Force at the sensor under the tissue, N (`s2`).
    pub f2_n: Vector3<f64>,
    /// The known part of the chain; identity if no part is known.
    pub s1_from_c: UnitQuaternion<f64>,
}

impl PushPair {
    /// Creates a pair without a chain: the result is then `s1_from_s2`.
    pub fn plain(f1_n: Vector3<f64>, f2_n: Vector3<f64>) -> Self {
        Self { f1_n, f2_n, s1_from_c: UnitQuaternion::identity() }
    }
}

/// A known correspondence: transforms readings of the sensor under the tissue to the frame of the wrist sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Correspondence {
    pub target: FitTarget,
    /// Rotation from `s2` to the frame that `target` names.
    pub rotation: UnitQuaternion<f64>,
    /// The sensor under the tissue measures the force on the tissue, not on the instrument.
    pub flip_s2: bool,
}

impl Correspondence {
    /// Returns the force on the tip, N (`s1`), for a reading of the sensor under the tissue, N (`s2`), and this sample;
    /// `None` if the sample lacks a rotation of the chain.
    pub fn tip_force_s1(&self, sample: &WristSample, tissue_n: &Vector3<f64>) -> Option<Vector3<f64>> {
        let s1_from_s2 = match self.target {
            FitTarget::CFromS2 => sample.s1_from_c()? * self.rotation,
            FitTarget::S1FromS2 => self.rotation,
        };
        let on_tip_n = if self.flip_s2 { -tissue_n } else { *tissue_n };
        Some(s1_from_s2 * on_tip_n)
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CorrespondenceOptions {
    /// Invert the forces of `s2`: the sensor measures the force on the tissue, not on the instrument.
    pub flip_s2: bool,
    pub limits: CorrespondenceLimits,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct CorrespondenceLimits {
    #[serde(rename = "least_pairs")]
    pub min_pairs: usize,
    /// Pushes weaker than this on either sensor are left out, N.
    #[serde(rename = "least_force_n")]
    pub min_force_n: f64,
    /// Minimum spread of the push directions along their weakest axis relative to their strongest, with any tenth of
    /// the pushes left out. 1 is uniform over all directions, 0 a plane; a cone of half angle 25 degrees has 0.22.
    #[serde(rename = "least_spread")]
    pub min_spread: f64,
    /// Minimum force along the weakest axis, as a multiple of the residuals' noise, so that noise does not count as a
    /// direction.
    #[serde(rename = "least_signal")]
    pub min_signal: f64,
    pub uncertainty_deg: f64,
    #[serde(rename = "outlier_share")]
    pub outlier_fraction: f64,
    /// Maximum held-out mean absolute error of any axis, N (the paper's worst axis has 0.13).
    pub held_out_mae_n: f64,
    /// Minimum held-out coefficient of determination over all axes (the paper has 0.95).
    #[serde(rename = "least_r2")]
    pub min_r2: f64,
    /// Maximum deviation of the ratio of the two sensors' forces from one.
    pub gain_error: f64,
    pub offset_n: f64,
    /// Maximum angle between the results of the two solvers, degrees.
    pub cross_check_deg: f64,
}

impl Default for CorrespondenceLimits {
    fn default() -> Self {
        Self {
            // Two per axis of the tissue's force.
            min_pairs: 6,
            min_force_n: 0.5,
            // A cone of 25 degrees (0.22) just passes.
            min_spread: 0.2,
            // Three standard deviations.
            min_signal: 3.0,
            // At 5 N, 1.5 degrees are 0.13 N across: the paper's error.
            uncertainty_deg: 1.5,
            // Design choice: beyond a quarter, the pushes themselves are doubtful.
            outlier_fraction: 0.25,
            // The paper's worst axis has 0.13 N (Validation I).
            held_out_mae_n: 0.15,
            min_r2: 0.9,
            gain_error: 0.1,
            // Half of `end_n`: an offset below it cannot be mistaken for contact.
            offset_n: 0.15,
            // Far above the precision of both solvers, far below `uncertainty_deg`.
            cross_check_deg: 0.1,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum CorrespondenceError {
    #[error("pair {index}: a force or rotation is not finite; remove the pair")]
    NotFinite { index: usize },
    #[error("pair {index}: {force_n:e} N is not a plausible force of a push; check the units (N)")]
    NotPlausible { index: usize, force_n: f64 },
}
