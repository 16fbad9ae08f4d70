//! The columns of the regression over the horizon, and the follower's state they are made from.

use super::{
    bands::{BANDS, BandMotion},
    learner::Variants,
};
use crate::signal::Lanes;

/// Columns.
pub(super) const REGRESSORS: usize = 22;
/// Three ridges; the columns linear in the motion (with stiffness that may scale with the force), and all.
pub(super) const VARIED: Variants = Variants { ridges_s: &[0.0003, 0.01, 0.3], prefixes: &[12, REGRESSORS] };
/// How many variants that makes.
pub(super) const VARIANTS: usize = 6;
/// The columns that only the follower knows; at the leader they are one constant.
pub(super) const FOLLOWER_ONLY: [usize; 11] = [5, 6, 7, 8, 15, 16, 17, 18, 19, 20, 21];

/// What the follower knows at one instant besides its motion.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct State {
    /// Force, N.
    pub(super) force: Lanes,
    /// Force minus its low-passes, N, bounded: trend, noise and relaxation of the force.
    pub(super) force_bands: [Lanes; BANDS],
    /// Position averaged over 2 s, m: the centre that powers are counted from.
    pub(super) centre: Lanes,
    /// Mean size of the fast motion, m: where friction's sign turns.
    pub(super) friction_scale: Lanes,
    /// Position from its centre, m, bounded.
    pub(super) position_level: Lanes,
    /// Force from its 2 s mean, N, bounded.
    pub(super) force_level: Lanes,
    /// The motion's bands, m, bounded.
    pub(super) band_levels: [Lanes; BANDS],
}

/// `u / (|u| + s/2)`: the sign of the motion, smooth through zero (Coulomb friction without its jump).
pub(super) fn saturate(u: Lanes, scale: Lanes) -> Lanes {
    u * (u.map(f64::abs) + scale * 0.5).recip_or_zero()
}

/// The columns for the motion `now` from the instant `then` with its `state`, in the order of nesting.
pub(super) fn regressors(now: &BandMotion, then: &BandMotion, state: &State) -> [Lanes; REGRESSORS] {
    let dx = now.x - then.x;
    let du = |band: usize| now.u[band] - then.u[band];
    let (a, b) = (now.x - state.centre, then.x - state.centre);
    let s = state;
    [
        dx,
        du(0),
        du(1),
        du(2),
        du(3),
        s.force_bands[0],
        s.force_bands[1],
        s.force_bands[2],
        s.force_bands[3],
        // Stiffness and damping that scale with the force: none in free motion, Hertz and Hunt-Crossley in contact.
        s.force * dx,
        s.force * du(1),
        saturate(now.u[1], s.friction_scale) - saturate(then.u[1], s.friction_scale),
        a * a - b * b,
        a * a * a - b * b * b,
        a * now.u[1] - b * then.u[1],
        s.position_level,
        s.force_level,
        Lanes::splat(1.0),
        s.band_levels[0],
        s.band_levels[1],
        s.band_levels[2],
        s.band_levels[3],
    ]
}
