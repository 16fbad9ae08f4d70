//! Anchored rendering: the delayed force, corrected by what the motion since then is expected to have changed.
//!
//! `f^(t) = f(t-D) + clip(c)`. Per axis the CHANGE of force over the delay D itself is regressed on the change of motion over D
//! and on what the follower knew D ago; so the fit minimises the very error that is judged. Every coefficient is shrunk
//! towards zero, which is delayed direct reflection (DFR). Variants (two nested sets of columns, three ridges) are mixed by
//! non-negative weights that add up to at most one, fitted to the errors their own earlier predictions made at the true
//! horizon: what is missing to one is shrinkage to DFR. A bound, an envelope of the forces seen and a guard limit what a
//! wrong model can do: when the long-running error is not below DFR's, nothing is added.
//!
//! The follower learns, judges and mixes ([`Follower`]); what crosses the link is one [`Correction`] a tick, already mixed
//! into fourteen numbers an axis; the leader only evaluates it on its own motion. All constants are ratios or seconds, so
//! units cancel. How they were chosen and what else was tried: `docs/anchored.md`.
//!
//! | file | holds |
//! |---|---|
//! | `bands` | motion and force seen through four low-passes instead of derivatives |
//! | `regressors` | the 22 columns, and the state of the follower they are made from |
//! | `learner` | weighted recursive least squares with three ridges |
//! | `cross_talk` | one more expert with the full `M`, only where it is asked for |
//! | `mixture` | the judge: weights of the variants, guard |
//! | `correction` | what the link carries and how the leader evaluates it |
//! | `follower` | one tick of all of it |

mod bands;
mod correction;
mod cross_talk;
mod follower;
mod learner;
mod mixture;
mod regressors;

pub(super) use bands::Bands;
pub use correction::Correction;
pub(super) use correction::Seen;
pub(super) use follower::Follower;

/// Weight of the old in a running mean with time constant `memory_s` (s) at `rate_hz`.
fn keep(memory_s: f64, rate_hz: f64) -> f64 {
    (-1.0 / (memory_s * rate_hz)).exp()
}
