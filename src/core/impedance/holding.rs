//! The fraction of the held force in a rendered force: the judgement of holding.

use super::motion_clock::newest_fraction;
use crate::signal::Lanes;

/// Memory of the judgement (s); 2 to 5 s perform equally well.
const MEMORY_S: f64 = 5.0;
/// Time (s) of about equal differences between the two forces after which the judgement counts in full. A single touch of
/// new tissue, where both forces are wrong for some 0.1 s, proves nothing. With 1.5 s, `best` is 0.2 % worse than anchored
/// rendering over tissue that changes at each touch; with 0.3 s, it is up to 6 % worse.
const EVIDENCE_S: f64 = 2.5;
/// A smaller fraction of the held force is chance, and is not used.
const CHANCE: f64 = 0.1;
/// A force that stays the same to the last bit for this long (s), and for longer than the delay, while the hand moves comes
/// from a sensor that renews its value more slowly. Until the next value, the last one is the best prediction.
pub(super) const STALE_S: f64 = 0.02;
/// Pace of the motion clock above which the hand moves.
const MOVES: f64 = 0.5;

/// Forces (N) of one tick.
#[derive(Clone, Copy, Debug)]
pub(super) struct HeldMixture {
    pub(super) anchored: Lanes,
    /// Rendered without holding.
    pub(super) without: Lanes,
    pub(super) held: Lanes,
    /// Rendered with holding.
    pub(super) mixed: Lanes,
}

/// Estimates, for each axis, the fraction of the held force that would have caused the least error. Where motion does not
/// explain the force (a person pushes the arm, an estimate is noisy, a sensor is slow), a force computed from motion is
/// worse than the last measured one. The fraction is a regression coefficient, which is zero wherever holding adds
/// nothing; a comparison of the two errors would give it a weight there.
#[derive(Clone, Debug)]
pub(super) struct Holding {
    rate_hz: f64,
    judged: f64,
    mean_error_n: Lanes,
    products: Lanes,
    squares: Lanes,
    /// Sum of the squared terms of `squares`: both sums give the number of terms that the regression is based on.
    fourths: Lanes,
    held: Lanes,
    renewal: ForceRenewal,
}

impl Holding {
    pub(super) fn new(rate_hz: f64) -> Self {
        Self {
            rate_hz,
            judged: 0.0,
            mean_error_n: Lanes::ZERO,
            products: Lanes::ZERO,
            squares: Lanes::ZERO,
            fourths: Lanes::ZERO,
            held: Lanes::ZERO,
            renewal: ForceRenewal::default(),
        }
    }

    /// Mixes the force that is rendered without holding with the held one.
    pub(super) fn mix(&self, plain: HeldMixture) -> HeldMixture {
        HeldMixture { mixed: plain.without + (plain.held - plain.without) * self.held, ..plain }
    }

    /// Takes a measured force (N) and the forces that were rendered for it `age` ticks ago, at this pace of the motion
    /// clock.
    pub(super) fn judge(&mut self, force_n: Lanes, said: &HeldMixture, pace: f64, age: usize) {
        self.judged += 1.0;
        let memory = MEMORY_S * self.rate_hz;
        let fraction = newest_fraction(1.0, self.judged, memory);
        let error_n = (force_n - said.mixed).map(f64::abs);
        self.mean_error_n = (self.mean_error_n + (error_n - self.mean_error_n) * fraction).settled();
        // Weighted by the usual error, because otherwise one strong contact outweighs all that follows.
        let weight = self.mean_error_n.recip_or_zero();
        let difference_n = said.held - said.without;
        let weighted = difference_n * weight;
        let fade = libm::exp(-1.0 / memory);
        self.products = (self.products * fade + weighted * (force_n - said.without)).settled();
        let term = weighted * difference_n;
        self.squares = (self.squares * fade + term).settled();
        self.fourths = (self.fourths * fade + term * term).settled();
        let held = self.products * self.squares.recip_or_zero();
        let terms = self.squares * self.squares * self.fourths.recip_or_zero();
        let known = terms.map(|terms| (terms / (EVIDENCE_S * self.rate_hz)).min(1.0));
        let used = held.map(|held| ((held - CHANCE) / (1.0 - CHANCE)).clamp(0.0, 1.0));
        self.held = used * known;
        let same = self.renewal.step(force_n, pace > MOVES);
        if same > age && same as f64 > STALE_S * self.rate_hz {
            self.held = Lanes::splat(1.0);
        }
    }

    pub(super) fn reset(&mut self) {
        *self = Self::new(self.rate_hz);
    }
}

/// Ticks for which the force stays the same while the hand moves.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ForceRenewal {
    force_n: Lanes,
    same: usize,
    before: usize,
}

impl ForceRenewal {
    /// Returns the longer of the current and the last period without a new value.
    pub(super) fn step(&mut self, force_n: Lanes, moves: bool) -> usize {
        // Exactly zero: the tip touches nothing.
        if force_n == self.force_n && force_n != Lanes::ZERO {
            self.same += usize::from(moves);
        } else {
            self.before = std::mem::take(&mut self.same);
        }
        self.force_n = force_n;
        self.same.max(self.before)
    }
}
