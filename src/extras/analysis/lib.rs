//! Statistics of user studies with repeated measures: few participants, each of them under every condition.
//!
//! | question | answer |
//! |---|---|
//! | What was measured? | [`SampleSummary`], [`Bootstrap`] |
//! | Do two conditions differ, within participants? | [`signed_rank`], [`t_test`], [`mixed`] |
//! | Do two groups of participants differ? | [`mann_whitney`] |
//! | Do several conditions differ? | [`friedman`], [`mixed`]; then pairs, with [`correction`] |
//! | By how much? | [`effect`], and the Hodges-Lehmann estimates of the rank tests |
//! | How many participants does the study need? | [`power`] |
//!
//! Everything is a function of its input: functions that draw random numbers take a seed. Unusable input gives an
//! [`AnalysisError`] in one sentence; no function panics or returns NaN.
//!
//! Equal values are ties. Differences such as 0.3 - 0.1 and 0.2 are not equal in floating point, so round measurements
//! and differences to the resolution of the instrument before a rank test.
//!
//! ```
//! use nima_analysis::{signed_rank::{self, SignedRankOptions}, AnalysisError};
//!
//! // Peak force without and with haptics, N, of eight participants.
//! let without = [4.1, 5.0, 3.2, 6.3, 4.4, 5.1, 3.9, 4.8];
//! let with = [3.2, 4.4, 3.3, 4.1, 3.9, 4.0, 3.5, 3.1];
//! let test = signed_rank::paired(&without, &with, &SignedRankOptions::default())?;
//! assert!((test.p - 2.0 * 2.0 / 256.0).abs() < 1e-12);
//! # Ok::<(), AnalysisError>(())
//! ```

pub mod bootstrap;
mod check;
pub mod correction;
mod distribution;
pub mod effect;
mod error;
pub mod friedman;
mod interval;
pub mod mann_whitney;
pub mod mixed;
pub mod power;
mod ranks;
pub mod signed_rank;
pub mod summary;
pub mod t_test;
#[cfg(test)]
mod tests;

pub use bootstrap::Bootstrap;
pub use error::AnalysisError;
pub use interval::ConfidenceInterval;
pub use summary::SampleSummary;
