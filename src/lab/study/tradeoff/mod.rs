//! Trade-off between computing time and accuracy, for every parameter of the identification.
//!
//! Takes motion and force over time ([`TradeoffSource`]: a recording, or a simulated scene) and a [`TradeoffPlan`]. For every
//! [`ParameterChoice`] of parameters, returns the time of one tick (us, measured on this computer) and the prediction error at
//! the horizon: the force rendered for time t from data up to t - D and the motion at t, compared with the force
//! measured at t (mean 3-D distance, in the unit of the source), and with delayed direct force reflection (DFR), which
//! renders the force of t - D. Not all combinations are measured: each parameter is varied alone around a base point,
//! and degree and window together at every delay, where the Pareto front is marked. Deterministic except for the times.
//! A choice for which a source is too short or too slow is left out, and the reason is reported.
//!
//! | file | holds |
//! |---|---|
//! | `source` | recordings, scenes recorded open-loop, resampling to lower rates |
//! | `plan` | the parameters and their values |
//! | `modes` | cost and error of a mode as the loop runs it |
//! | `windows` | cost and error of the plain model of a window, by each solver |
//! | `sweep` | all points of all sources, their curves and the Pareto front |
//! | `chart`, `images` | the curves as SVG |
//! | `table`, `text` | the figures as CSV and as text for a terminal |

mod charts;
mod modes;
mod plan;
mod source;
mod sweep;
mod table;
mod text;
mod windows;

#[cfg(test)]
mod tests;

pub use plan::{Knob, ParameterChoice, PlanCurve, PlanMethod, TradeoffPlan};
pub use source::TradeoffSource;
pub use sweep::{CostUs, SkippedChoice, SourceFigures, SweepError, SweepPoint, SweepStudy, sweep};
