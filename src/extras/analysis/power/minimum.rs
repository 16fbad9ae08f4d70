//! The minimum number of participants for the requested power.

use super::Power;
use crate::check;
use crate::error::{AnalysisError, Result};
use serde::Serialize;

/// The minimum number of participants, with the resulting power.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MinimumSample {
    pub participants: usize,
    pub power: Power,
}

impl MinimumSample {
    /// Returns the minimum number from `from` to `largest` at which the fraction from `power_of` reaches `wanted`
    /// (between 0 and 1): doubles until it is reached, then bisects.
    ///
    /// The power of an exact test rises in small steps and may fall from one number to the next, and simulations
    /// scatter: one participant fewer does not reach the requested power, but a still smaller number may do so by
    /// chance. [`AnalysisError::NotReached`] if `largest` does not reach it.
    ///
    /// ```
    /// use nima_analysis::{power::{MinimumSample, PairedTest, Population, PowerSimulation}, AnalysisError};
    ///
    /// let (simulation, population) = (PowerSimulation::default(), Population::Normal { sd: 1.0 });
    /// let min = MinimumSample::of(0.8, 5, 100, |n| simulation.paired(&population, 1.0, n, PairedTest::T))?;
    /// assert!((9..=11).contains(&min.participants)); // exactly: 10
    /// # Ok::<(), AnalysisError>(())
    /// ```
    pub fn of(
        wanted: f64,
        from: usize,
        largest: usize,
        mut power_of: impl FnMut(usize) -> Result<Power>,
    ) -> Result<Self> {
        check::fraction("the wanted power", wanted)?;
        check::enough("the maximum number of participants", largest, from)?;
        let mut below = None;
        let mut at = from;
        let mut power = power_of(at)?;
        while power.fraction < wanted {
            if at >= largest {
                return Err(AnalysisError::NotReached { wanted, power: power.fraction, largest });
            }
            below = Some(at);
            at = at.saturating_mul(2).clamp(at + 1, largest);
            power = power_of(at)?;
        }
        let mut min = Self { participants: at, power };
        while let Some(low) = below.filter(|low| low + 1 < min.participants) {
            let middle = usize::midpoint(low, min.participants);
            let power = power_of(middle)?;
            if power.fraction < wanted {
                below = Some(middle);
            } else {
                min = Self { participants: middle, power };
            }
        }
        Ok(min)
    }
}
