//! Identification and rendering: from motion and tip force to an impedance `f = M X`, and from `M` back to a force for
//! the hand.
//!
//! Takes: tip positions (m, workspace frame) and tip forces (N, same frame), one [`Sample`] per tick at a fixed rate.
//! Returns: a [`Parcel`] of parameters for the link (follower side, [`Identifier`]) and a force (N) rendered from the
//! leader's own motion (leader side, [`Renderer`]). Pure and deterministic; nothing is allocated after construction; no
//! devices, files or threads are used. Bad input (NaN, infinite, absurdly large, or a time stamp that does not advance)
//! is counted, left out of the window, and bridged by a prediction of the motion; it never reaches a parameter. Dead
//! band, gain, ceiling and age of the rendered force are not handled here; the gates of `safety` handle them.
//!
//!  file | content |
//! ---|---|
//!  `track`, `features` | the motion of one end; its features `u, u', u'', ..., u^N, u'^N, u''^N` and their scales |
//!  `window`, `factor`, `solution` | sliding window at a constant cost; triangular factor; all its nested solutions |
//!  `paper`, `gram`, `literal` | the paper's normal equations, all degrees, in-window choice |
//!  `recipe` | interpretation of the paper where it leaves a choice; the choice of the degree by the data after the window |
//!  `degrees`, `horizon` | the nested solution that predicts force best at the true delay, where modes are compared |
//!  `anchored`, `regressors`, `regression`, `mixture` | anchored rendering: experts and their weights |
//!  `best` | a softmin over anchored and matched rendering, evaluated by the leader |
//!  `matched` | matched rendering: the force from the hand's own motion, by parameters alone |
//!  `damper` | the damping that keeps a force of the handle's own motion from driving the hand |
//!  `baselines` | published methods for comparison; at most one is computed |
//!  `pace`, `envelope` | a clock that motion drives; the range of past forces |
//!  `method` | the follower's part of each rendering method, as one list |
//!  `identifier`, `information`, `renderer`, `messages` | the two ends of the link, and the data between them |

mod anchored;
mod baselines;
mod best;
mod damper;
mod degrees;
mod envelope;
mod factor;
mod features;
mod gram;
mod horizon;
mod identifier;
mod information;
mod literal;
mod matched;
mod messages;
mod method;
mod mixture;
mod mode;
mod normal;
mod pace;
mod packed;
mod paper;
mod recipe;
mod regression;
mod regressors;
mod renderer;
mod settings;
mod solution;
mod track;
mod window;

#[cfg(test)]
mod comparison_tests;
#[cfg(test)]
mod recipe_tests;
#[cfg(test)]
mod rest_tests;
#[cfg(test)]
mod tests;

pub use baselines::{BaselineModel, Contact, Wave};
pub use factor::Factor;
pub use features::{Features, MOTION_COLUMNS, Scales};
pub use gram::Gram;
pub use identifier::Identifier;
pub use literal::LiteralSolver;
pub use matched::{Form, MatchedModel};
pub use messages::{AnchoredModel, Excitation, LiteralModel, Parcel, Rendered, Report, Sample};
pub use mode::{Baseline, MODES, Mode, ParseModeError, SLOTS};
pub use packed::{PACKED_MAX, Packed};
pub use recipe::{Choice, Reading, Recipe};
pub use renderer::Renderer;
pub use settings::{MAX_DELAY_S, ModeSet, OwnMotion, Settings, SettingsError};
pub use solution::Solution;
pub use window::{SlidingWindow, Summary};

/// Number of axes handled in parallel: x, y, z of the workspace.
pub const AXES: usize = 3;
/// Highest polynomial degree `N` of the motion features (the paper's five).
pub const MAX_DEGREE: usize = 5;
