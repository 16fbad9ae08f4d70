//! What the link carries of anchored rendering.

use super::{
    super::{features::Features, messages::clip},
    bands::{BANDS, BandMotion},
    cross_talk::{CrossModel, crossed},
    regressors::saturate,
};
use crate::signal::Lanes;

/// The motion at one instant as corrections see it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in super::super) struct Seen {
    /// Through the low-passes.
    pub(in super::super) bands: BandMotion,
    /// As the paper's features, scaled.
    pub(in super::super) features: Features,
}

/// A correction ready to be evaluated on the leader's motion: all variants mixed, all that only the follower knows folded in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Correction {
    /// Share of the mixture in force, 0 (plain delayed reflection) to 1.
    pub share: f64,
    /// Largest correction, N (norm over the axes).
    pub bound_n: f64,
    /// Lowest and highest force rendered, N, per axis: what has been seen lately, and a little more.
    pub(super) envelope: [Lanes; 2],
    /// Position from which powers are counted, m.
    pub(super) centre: Lanes,
    /// Where friction's sign turns, m.
    pub(super) friction_scale: Lanes,
    /// Expected change of force without any motion, N.
    pub(super) constant: Lanes,
    /// Per change of position, N/m.
    pub(super) stiffness: Lanes,
    /// Per change of each band of the motion, N/m.
    pub(super) bands: [Lanes; BANDS],
    /// Per change of friction's smooth sign, N.
    pub(super) friction: Lanes,
    /// Per change of `x^2` (N/m^2), of `x^3` (N/m^3) and of `x u` (N/m^2).
    pub(super) powers: [Lanes; 3],
    /// The full `M` with cross-talk, where it is asked for and has earned weight.
    pub(super) cross_talk: Option<CrossModel>,
}

impl Correction {
    /// No correction: the force is reflected as it comes.
    pub const NONE: Self = Self {
        share: 0.0,
        bound_n: 0.0,
        envelope: [Lanes::ZERO; 2],
        centre: Lanes::ZERO,
        friction_scale: Lanes::ZERO,
        constant: Lanes::ZERO,
        stiffness: Lanes::ZERO,
        bands: [Lanes::ZERO; BANDS],
        friction: Lanes::ZERO,
        powers: [Lanes::ZERO; 3],
        cross_talk: None,
    };

    /// The force (N) for the motion `now`, from `force` (N) when the motion was `then`.
    pub(in super::super) fn apply(&self, force: Lanes, now: &Seen, then: &Seen) -> Lanes {
        if self.share <= 0.0 {
            return force;
        }
        let crossed = self.cross_talk.as_ref().map(|model| crossed(model, &now.features, &then.features));
        let (now, then) = (&now.bands, &then.bands);
        let (a, b) = (now.x - self.centre, then.x - self.centre);
        let mut change = self.constant + self.stiffness * (now.x - then.x);
        for ((coefficient, now), then) in self.bands.iter().zip(&now.u).zip(&then.u) {
            change += *coefficient * (*now - *then);
        }
        change += self.friction * (saturate(now.u[1], self.friction_scale) - saturate(then.u[1], self.friction_scale));
        change += self.powers[0] * (a * a - b * b);
        change += self.powers[1] * (a * a * a - b * b * b);
        change += self.powers[2] * (a * now.u[1] - b * then.u[1]);
        change += crossed.unwrap_or_default();
        within(force + clip(change, self.bound_n), &self.envelope)
    }
}

/// Pulls a force into an envelope, axis by axis.
pub(super) fn within(force: Lanes, [lowest, highest]: &[Lanes; 2]) -> Lanes {
    force.zip(*lowest, f64::max).zip(*highest, f64::min)
}
