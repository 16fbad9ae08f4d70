//! The score of a trial of a training task: peg transfer, palpation, wire loop.
//!
//! Takes [`ScoreSample`]s of motion (m) and force (N) of both hands at about 1 kHz, and
//! [`Happening`](nima_core::task::TimedTaskEvent)s (a ring placed, a wire touched); returns a [`Score`] of named
//! measures, each with unit, definition and source. [`Proficiency`] and [`LearningCurve`] judge a sequence of trials,
//! [`Guidance`] says after which of them the trainee sees the result. [`trial_score`] scores the ticks of a loop, or a
//! recorded session; everything else knows no loop, device, file, thread or clock. `docs/reference/measures.md` lists
//! the measures.
//!
//! ```
//! use nalgebra::Vector3;
//! use nima_core::{
//!     Side,
//!     task::{TaskEvent, TimedTaskEvent},
//! };
//! use nima_score::{HandSample, ScoreSample, Scorer, TaskFile};
//!
//! let task = TaskFile::from_toml("name = 'Six rings'\nkind = 'peg_transfer'")?;
//! let mut scorer = Scorer::new(&task);
//! scorer.happening(&TimedTaskEvent { t_s: 0.0, event: TaskEvent::Begun });
//! for tick in 0..=2000 {
//!     let t_s = f64::from(tick) * 1e-3;
//!     let right = HandSample { tip_m: Vector3::new(0.05 * t_s, 0.0, 0.0), engaged: true, ..HandSample::default() };
//!     scorer.sample(&ScoreSample { t_s, hands: Side::Right.alone(right) });
//! }
//! scorer.happening(&TimedTaskEvent { t_s: 2.0, event: TaskEvent::Ended });
//! let score = scorer.finish();
//! assert!((score.of("path_length_m", Side::Right).unwrap_or(0.0) - 0.1).abs() < 1e-6);
//! assert_eq!(score.value("completion_time_s"), Some(2.0));
//! assert_eq!(score.of("path_length_m", Side::Left), None, "there is no left hand");
//! # Ok::<(), nima_score::TaskError>(())
//! ```
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod applicable;
mod catalogue;
mod economy;
mod ellipsoid;
mod events;
mod force;
mod guidance;
mod hand;
mod jaw;
mod learning;
mod proficiency;
mod sample;
mod score;
mod scorer;
mod signal;
mod smoothness;
mod task;
#[cfg(test)]
mod tests;
mod tip_motion;
pub mod trial_score;
mod two_hands;

pub use catalogue::{CatalogueDefinition, MEASURES};
pub use guidance::{FeedbackSchedule, Guidance};
pub use learning::{CurveShape, LearningCurve, MIN_TRIALS};
pub use proficiency::{Proficiency, TrainingState};
pub use sample::{HandSample, ScoreSample};
pub use score::{Measure, Score, TrialOutcome};
pub use scorer::Scorer;
pub use task::{LONGEST_TRIAL_S, TaskCriterion, TaskError, TaskFile, provide_tasks};
