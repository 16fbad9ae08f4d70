//! The force at the tip from what the wrist feels: a small network that takes the trocar's friction out.
//!
//! Takes named columns (wrist force in N, torque in Nm, orientation, motion through the trocar); gives the force at the tip in
//! the frame of the wrist sensor (`s1`, N), and says when it is out of its depth. The same machinery learns any other
//! instrument's named columns. Training ([`train`]) belongs on a background thread; [`Estimator`] allocates nothing.

mod baseline;
mod check;
mod columns;
mod coverage;
mod dataset;
mod doubt;
mod error;
mod estimator;
mod evaluation;
mod features;
mod fit;
mod folds;
mod history;
mod keeping;
mod linear;
mod live;
mod model;
mod network;
mod normal;
mod recorder;
#[cfg(test)]
mod tests;
mod training;

pub use baseline::{BASELINES, Baselines};
pub use check::{Check, check};
pub use columns::{DEFAULT_INPUTS, DEFAULT_OUTPUTS, Expansion, MAX_FEATURES, MAX_OUTPUTS};
pub use coverage::{Coverage, DEPTH_M, FORCE_N, Goal, MAP, Map, SPEED_M_S, Span, TILT};
pub use dataset::{DataSet, Selection, Trajectory};
pub use doubt::{Doubt, FALSE_ALARMS};
pub use error::TipForceError;
pub use estimator::{Estimate, Estimator};
pub use evaluation::{Evaluation, MethodFigures, NoContact, Part, Stats, evaluate};
pub use features::{FeatureSettings, Features, LIVE_INPUTS, NoRow};
pub use history::{Derived, Memory};
pub use live::{Fallback, TipForce, TipForceReport, Unsure};
pub use model::{Model, Origin};
pub use network::{Answer, Layer, Member, Network};
pub use normal::Normalisation;
pub use recorder::{Lack, MOST_ROWS, ROW_EVERY_S, Recorder, RecorderPhase};
pub use training::{MIN_ROWS, MemberFigures, Progress, Settings, Trained, train};
