//! The force at the tip from what the wrist feels: a small network that takes the trocar's friction out.
//!
//! Takes named columns (wrist force in N, torque in Nm, orientation, motion through the trocar); gives the force at the tip in
//! the frame of the wrist sensor (`s1`, N), and says when it is out of its depth. The same machinery learns any other
//! instrument's named columns. [`Estimator`] allocates nothing; training
//! lives in a crate of its own.

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

pub use baseline::{BASELINES, Baselines};
pub use columns::{DEFAULT_INPUTS, DEFAULT_OUTPUTS, Expansion, MAX_FEATURES, MAX_OUTPUTS};
pub use coverage::{Coverage, DEPTH_M, FORCE_N, Goal, MAP, Map, SPEED_M_S, Span, TILT};
pub use doubt::{Doubt, FALSE_ALARMS};
pub use estimator::{Estimate, Estimator};
pub use features::{FeatureSettings, Features, LIVE_INPUTS, NoRow};
pub use history::{Derived, Memory};
pub use live::{Fallback, NotLive, TipForce, TipForceReport, Unsure};
pub use model::Model;
pub use network::{Answer, Layer, Member, Network};
pub use normal::Normalisation;
pub use origin::{Check, MemberFigures, Origin, TrainingSettings};
