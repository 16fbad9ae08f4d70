//! Removes the tool's weight and the sensor's bias from a wrist sensor's readings.
//!
//! At rest the tool acts on the sensor with its weight: `f = m R u + f0` and `tau = com x (m R u) + tau0` in `s1`, with
//! the gravity vector `u` (m/s^2, pointing down) in the frame of the orientation source. That source is either the
//! accelerometer (`u = -a`, frame `imu`, `R = s1_from_imu`) or the arm (`u = s1_from_world * (0, 0, -g)`, frame `s1`,
//! `R` near the identity). The accelerometer's reading is not normalised, so that its constant bias becomes part of
//! `f0`. A drift of the bias over the poses is fitted and removed; `f0` is the bias of the last pose. Drift after the
//! calibration is not covered; the drift check detects it.
//!
//! Three models are fitted to the same still poses and compared on held-out poses: the physical one above, one with a
//! free 3x3 gain instead of `m R`, and the paper's, linear in sine and cosine of roll and pitch.

mod compensator;
mod consensus;
mod coverage;
mod drift;
mod fit;
mod model;
mod pass;
mod plausible;
mod pose;
mod precheck;
mod record;
mod report;
mod session;
mod solve;
mod still;
mod targets;
#[cfg(test)]
mod tests;
mod trend;

pub use compensator::{Compensator, DEFAULT_TIME_CONSTANT_S};
pub use drift::{DriftCheck, GravityDrift, NotChecked};
pub use fit::fit;
pub use model::{GravityModel, GravityParameters, GravitySource, ModelKind, TorqueParameters};
pub use pass::{CheckPass, PassResult};
pub use pose::{GravityPose, Orientation};
pub use precheck::{CheckState, Precheck, PrecheckResult};
pub use record::{GravityKind, GravityRecord};
pub use report::{GravityLimits, GravityReport, GravitySettings, ModelFit};
pub use session::{GravityPhase, GravitySession, GravitySessionSettings};
pub use still::StillSettings;
pub use targets::{PoseTarget, TARGETS};

/// Reason why poses could not be fitted. Messages count poses from 1.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum GravityError {
    #[error("no poses were given; record still poses of the tool first")]
    NoPoses,
    #[error("pose {} contains a non-finite number; remove or repeat it", index + 1)]
    NotFinite { index: usize },
    /// Orientations from the accelerometer and from the arm are mixed.
    #[error("pose {} takes its orientation from a different source than the first pose; use one source for all poses", index + 1)]
    MixedSources { index: usize },
    #[error("pose {}: the accelerometer reads {norm_m_s2:.2} m/s^2 instead of 9.81; check the sensor and its units", index + 1)]
    DeadAccelerometer { index: usize, norm_m_s2: f64 },
    #[error("the accelerometer's sign {sign} is invalid; use 1 or -1")]
    BadSign { sign: i8 },
}
