//! What speed costs in accuracy: every knob of the identification, measured.
//!
//! Takes motion and force over time ([`Source`]: a recording, or one made of a scene) and a [`Plan`]; gives for every
//! [`Choice`] of the knobs the time of one tick (us, measured on this computer) and the error at the horizon: the force
//! rendered for time t from data up to t - D and the motion at t, against the force measured at t (mean 3-D distance, in
//! the unit of the source), beside delayed direct reflection (DFR), which renders the force of t - D.
//! Not the full product of all knobs: one at a time around a base point, and the grid of degree and window at every
//! delay, where the Pareto front is marked. Deterministic but for the times. A choice that a source is too short or too
//! slow for is left out and named with its reason.
//!
//! | file | holds |
//! |---|---|
//! | `source` | recordings, scenes recorded open-loop, slower sampling |
//! | `plan` | the knobs, and which of their values are tried |
//! | `modes` | cost and error of a mode, as the loop runs it |
//! | `windows` | cost and error of the plain model of a window, by each solver |
//! | `sweep` | all points of all sources, their curves and the front |
//! | `chart`, `pictures` | the curves as SVG |
//! | `table`, `words` | the figures as CSV, and for a terminal |

mod modes;
mod pictures;
mod plan;
mod source;
mod sweep;
mod table;
mod windows;
mod words;

#[cfg(test)]
mod tests;

pub use plan::{Choice, Curve, Knob, Method, Plan};
pub use source::Source;
pub use sweep::{CostUs, Point, Skipped, SourceFigures, Study, SweepError, sweep};
