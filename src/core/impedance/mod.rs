//! Identification and rendering: from motion and tip force to an impedance `f = M X`, and from `M` back to a force for
//! the hand.
//!
//! Takes: tip positions (m, workspace frame) and tip forces (N, same frame), one [`Sample`] per tick at a fixed rate.
//! Returns: a [`LinkPacket`] of parameters for the link (follower side, [`Identifier`]) and a force (N) rendered from the
//! leader's own motion (leader side, [`Renderer`]). Pure and deterministic; nothing is allocated after construction; no
//! devices, files or threads are used. Bad input (NaN, infinite, absurdly large, or a time stamp that does not advance)
//! is counted, left out of the window, and bridged by a prediction of the motion; it never reaches a parameter. Dead
//! band, gain, ceiling and age of the rendered force are not handled here; the gates of `safety` handle them.
//!
//! | file | holds |
//! |---|---|
//! | `track`, `features` | the motion of one end; its features `u, u', u'', ..., u^N, u'^N, u''^N` and their scales |
//! | `window`, `factor`, `solution` | sliding window at a constant cost; triangular factor; all its nested solutions |
//! | `gram`, `literal` | the paper's normal equations, all degrees, in-window choice |
//! | `recipe` | how the paper is read where it leaves a choice; the choice by the data after the window |
//! | `degrees`, `horizon` | the nested solution that predicts force best at the true delay, where modes are compared |
//! | `mode`, `method` | the list of the ways to render; the parts of each |
//! | `paper`, `dfr`, `anchored`, `matched`, `best` | the program's own ways to render |
//! | `holding` | the fraction of the held force in `best` |
//! | `baseline` | the names of the methods of others, to compare with; at most one is computed |
//! | `regressors`, `regression`, `mixture` | experts of anchored rendering and their trust |
//! | `damper` | the damping that keeps a force of the handle's own motion from driving the hand |
//! | `motion_clock`, `envelope` | a clock that motion drives; the range of forces seen |
//! | `identifier`, `information`, `renderer`, `messages` | the two ends of the link, and the messages between them |

mod anchored;
mod baseline;
mod best;
mod change;
mod damper;
mod degrees;
mod dfr;
mod envelope;
mod factor;
mod features;
mod gram;
mod holding;
mod horizon;
mod identifier;
mod information;
mod literal;
mod matched;
mod messages;
mod method;
mod mixture;
mod mode;
mod motion_clock;
mod normal;
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
mod robustness_tests;
#[cfg(test)]
mod tests;

pub use anchored::AnchoredModel;
pub use baseline::{Baseline, BaselineModel, ForceIncrements, HuntCrossleyContact, Wave};
pub use envelope::Envelope;
pub use factor::ImpedanceFactor;
pub use features::{ImpedanceFeatures, MOTION_COLUMNS, Scales};
pub use gram::Gram;
pub use identifier::Identifier;
pub use literal::LiteralSolver;
pub use matched::{MatchedModel, ModelForm};
pub use messages::{
    IdentificationFailures, IdentificationReport, IdentifiedDegrees, ImpedanceExcitation, LinkPacket, Posture,
    RenderedForces, Sample,
};
pub use method::{Entry, FollowerEnd, LeaderEnd, LeaderInput, MethodInput, Place, RenderingMethod};
pub use mode::{MODES, Mode, Models, ParseModeError, SLOTS, add_baselines};
pub use packed::{PACKED_MAX, ParameterPack};
pub use paper::LiteralModel;
pub use recipe::{DegreeChoice, IncrementReading, Recipe};
pub use renderer::Renderer;
pub use settings::{ImpedanceSettings, MAX_DELAY_S, ModeSet, OwnMotion, SettingsError};
pub use solution::ImpedanceSolution;
pub use window::{SlidingWindow, WindowSummary};

/// Number of axes handled in parallel: x, y, z of the workspace.
pub const AXES: usize = 3;
/// Highest polynomial degree `N` of the motion features (the paper's five).
pub const MAX_DEGREE: usize = 5;
