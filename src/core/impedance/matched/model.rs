//! The model that crosses the link, and the force that the hand's own motion produces with it.

use super::{
    super::{anchored::within, messages::Posture},
    form::{COLUMNS, Form},
    slip::{SLIPS, Slip},
};
use crate::signal::Lanes;

/// Parameters of matched rendering: `f = clip(theta phi(own motion)) + o`. They contain no measured force, except
/// through the range and the offset (at most a tenth of the maximum force).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MatchedModel {
    pub form: Form,
    /// Degree with the largest weight; 0 before anything is known.
    pub degree: u8,
    /// 1 on the axes in use.
    pub one: Lanes,
    /// N per unit of the column, zero beyond the columns in use: all experts, by their weights.
    pub parameters: [Lanes; COLUMNS],
    /// Origin of the positions (m; in the paper's form in scaled units).
    pub origin: Lanes,
    /// Length at which the springs of the slip columns slip, per force along the other axes (m/N).
    pub gives: [f64; SLIPS],
    /// Minimum and maximum force computed from the parameters (N).
    pub bounds_n: [Lanes; 2],
    /// A slow offset (N), added after the bounds.
    pub offset_n: Lanes,
}

impl MatchedModel {
    pub const NONE: Self = Self {
        form: Form::Tissue,
        degree: 0,
        one: Lanes::ZERO,
        parameters: [Lanes::ZERO; COLUMNS],
        origin: Lanes::ZERO,
        gives: [0.0; SLIPS],
        bounds_n: [Lanes::ZERO; 2],
        offset_n: Lanes::ZERO,
    };

    /// Returns the force (N) for a motion; `None` without a model or if the force is not finite. `slip`: this end's
    /// springs, which are advanced.
    pub(in super::super) fn force(&self, now: &Posture, slip: &mut Slip) -> Option<Lanes> {
        if self.degree == 0 {
            return None;
        }
        let (_, force) = slip.step(self, now);
        force.is_finite().then(|| self.clipped(force) + self.offset_n)
    }

    pub(super) fn clipped(&self, force_n: Lanes) -> Lanes {
        let [low, high] = self.bounds_n;
        within(force_n, low, high)
    }
}
