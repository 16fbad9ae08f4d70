//! What crosses the link, and the force that the hand's own motion makes of it.

use super::{
    super::{anchored::within, messages::Posture},
    form::{COLUMNS, Form},
    slip::{SLIPS, Slip},
};
use crate::signal::Lanes;

/// Parameters of matched rendering: `f = clip(theta phi(own motion)) + o`. No measured force is among them but in what the
/// range and the offset (at most a tenth of the largest force) tell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MatchedModel {
    /// Which columns.
    pub form: Form,
    /// The degree that has the largest weight; 0: nothing is known yet.
    pub degree: u8,
    /// 1 on the axes in use.
    pub one: Lanes,
    /// N per unit of the column, zero beyond those in use: all experts, by their weights.
    pub parameters: [Lanes; COLUMNS],
    /// Where positions count from (m; in the paper's form in scaled units).
    pub origin: Lanes,
    /// How far the springs of the slip columns give way per force along the other axes (m/N).
    pub gives: [f64; SLIPS],
    /// Least and greatest force made of the parameters (N).
    pub bounds_n: [Lanes; 2],
    /// A slow offset (N), added after the bounds.
    pub offset_n: Lanes,
}

impl MatchedModel {
    /// Nothing is known.
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

    /// The force (N) for a motion; `None` without a model or where it is not finite. `slip`: this end's springs, which move on.
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
