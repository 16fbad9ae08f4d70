//! Estimates the force at the tip from the wrist sensor: a small network removes the friction in the trocar.
//!
//! Takes named columns (wrist force in N, torque in Nm, orientation, motion through the trocar); returns the force at
//! the tip (N) in the frame of the wrist sensor without its roll (`shaft`), and flags inputs outside the training data.
//! The same code can learn other named columns, for other instruments. [`Estimator`] allocates nothing; training is in
//! the crate `nima-training`.

mod baseline;
mod columns;
mod coverage;
mod doubt;
mod estimator;
mod features;
mod history;
pub mod linear;
mod live;
mod model;
mod network;
mod normal;
mod origin;

pub use baseline::{BASELINES, Baselines, FRICTION, NO_MODEL};
pub use columns::{DEFAULT_INPUTS, DEFAULT_OUTPUTS, Expansion, MAX_FEATURES, MAX_OUTPUTS};
pub use coverage::{CoverageMap, DEPTH_M, FORCE_N, Goal, GoalKind, MAP, SPEED_M_S, TILT, TipForceCoverage, ValueSpan};
pub use doubt::{Doubt, FALSE_ALARMS};
pub use estimator::{Estimator, TipForceEstimate};
pub use features::{FeatureRow, FeatureSettings, LIVE_INPUTS, NoRow, TipForceFeatures};
pub use history::{DerivedInput, DerivedMemory};
pub use live::{Fallback, LiveTipForce, NotLive, TipForceReport, Unsure};
pub use model::ForceModel;
pub use network::{EnsembleOutput, Member, TipForceLayer, TipForceNetwork};
pub use normal::Normalisation;
pub use origin::{MemberFigures, ModelOrigin, OriginCheck, TrainingSettings};
