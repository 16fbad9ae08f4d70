//! Is there a hand after all? What speaks for one while the force is withheld.

use nalgebra::SVector;

use super::{
    Push, decay,
    flight::{ALONG_M_S, FREE, WEAK_N},
};

/// Share above which the force counts as withheld.
const WITHHELD: f64 = 0.1;
/// Almost all.
const NEARLY_ALL: f64 = 0.97;
/// A hand's force is one above this, N, and above this share of the largest force applied lately: a handle's mass that is wrong by a
/// quarter looks like a force as large. It must last so long, s.
const FORCE_N: f64 = 0.35;
const OF_APPLIED: f64 = 0.3;
const LATELY_S: f64 = 0.006;
const LASTS_S: f64 = 0.005;
/// A share of the asked force that says at once that the hand carries it.
const STRONG: f64 = 0.5;
/// For how long strong and weak evidence count, s.
const STRONG_FOR_S: f64 = 0.060;
const WEAK_FOR_S: f64 = 0.200;
/// A force that is there on average this long (s) after the fade.
const LATER_S: f64 = 0.030;
const MEAN_S: f64 = 0.010;
const MEANS_MEAN_S: f64 = 0.030;
/// Moved back against the push from its farthest place, m.
const BACK_M: f64 = 0.15e-3;
/// At rest below this speed (m/s), or the one from which the brake stops it within the next limit, for this long (s); then moved by this
/// much (m) from where it was 40 ms ago.
const REST_M_S: f64 = 0.005;
const REST_S: f64 = 0.020;
const STIR_M: f64 = 60e-6;
const STIR_S: f64 = 0.040;
/// Under less than this it does not stir by itself, N.
const UNPUSHED_N: f64 = 0.1;
/// Still moving so fast (m/s) so late (s), or so many times the brake's time constant: it would have stopped it.
const MOVING_M_S: f64 = 0.015;
const MOVING_AFTER_S: f64 = 0.050;
const MOVING_AFTER: f64 = 3.0;
/// Mean force applied that moves a free handle, N; how far a free handle's hand force may be off, N; time of the mean, s.
const PUSHED_N: f64 = 0.25;
const OFF_N: f64 = 0.1;
const FREE_MEAN_S: f64 = 0.012;

/// What the evidence says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Says {
    /// A hand carries the force.
    Hand,
    /// Something like a hand.
    Perhaps,
    /// The handle flies freely.
    Free,
    /// Nothing.
    Nothing,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Evidence<const D: usize> {
    period_s: f64,
    rest_m_s: f64,
    moving_after_s: f64,
    /// How long the force has been withheld, s.
    withheld_s: f64,
    /// How long there has been no evidence, s.
    quiet_s: f64,
    /// How long the hand's force has lasted, s.
    force_s: f64,
    /// How long strong and weak evidence still count, s.
    strong_left_s: f64,
    weak_left_s: f64,
    /// Largest force applied lately, N.
    applied_n: f64,
    hand_mean_n: SVector<f64, D>,
    later_mean_n: f64,
    free_applied_n: SVector<f64, D>,
    free_hand_n: SVector<f64, D>,
    farthest_m: SVector<f64, D>,
    at_rest_s: f64,
    /// Where it rests, m, once it does.
    rest_m: Option<SVector<f64, D>>,
}

impl<const D: usize> Evidence<D> {
    /// For a handle that the brake stops with this time constant, s.
    pub(super) fn new(stopping_s: f64, period_s: f64) -> Self {
        Self {
            period_s,
            rest_m_s: REST_M_S.min(STIR_M / stopping_s),
            moving_after_s: MOVING_AFTER_S.max(MOVING_AFTER * stopping_s),
            withheld_s: 0.0,
            quiet_s: 0.0,
            force_s: 0.0,
            strong_left_s: 0.0,
            weak_left_s: 0.0,
            applied_n: 0.0,
            hand_mean_n: SVector::zeros(),
            later_mean_n: 0.0,
            free_applied_n: SVector::zeros(),
            free_hand_n: SVector::zeros(),
            farthest_m: SVector::zeros(),
            at_rest_s: 0.0,
            rest_m: None,
        }
    }

    /// The force has just been withheld: what was seen before counts no more.
    pub(super) const fn begin(&mut self) {
        (self.withheld_s, self.quiet_s, self.at_rest_s, self.rest_m) = (0.0, 0.0, 0.0, None);
        (self.force_s, self.later_mean_n, self.strong_left_s, self.weak_left_s) = (0.0, 0.0, 0.0, 0.0);
    }

    /// For so long the handle has rested without any sign of a hand, s; 0 while it moves.
    pub(super) fn quiet_s(&self) -> f64 {
        if self.rest_m.is_some() { self.quiet_s } else { 0.0 }
    }

    /// Looks at a push while this share of it is withheld, `held_n` (N) being the force that was applied since the last look. The
    /// second answer: there is new evidence.
    pub(super) fn look(&mut self, push: &Push<D>, held_n: &SVector<f64, D>, withheld: f64) -> (Says, bool) {
        let dt_s = self.period_s;
        self.hand_mean_n += (push.hand_n - self.hand_mean_n) * decay(dt_s, MEAN_S);
        if withheld > WITHHELD {
            self.follow(push);
        }
        let (hand_n, held) = (push.hand_n.norm(), held_n.norm());
        self.applied_n += (held - self.applied_n) * decay(dt_s, LATELY_S);
        let pulls = hand_n > FORCE_N + OF_APPLIED * self.applied_n.max(held);
        self.force_s = if pulls { self.force_s + dt_s } else { (self.force_s - 2.0 * dt_s).max(0.0) };
        let lasts = self.force_s > LASTS_S;
        if lasts && hand_n > STRONG * push.size_n {
            self.strong_left_s = STRONG_FOR_S;
        }
        let seen = lasts || self.moves(push, held, withheld);
        if seen {
            self.weak_left_s = WEAK_FOR_S;
            (self.quiet_s, self.at_rest_s, self.rest_m) = (0.0, 0.0, None);
        }
        self.free_applied_n += (held_n - self.free_applied_n) * decay(dt_s, FREE_MEAN_S);
        self.free_hand_n += (push.hand_n - self.free_hand_n) * decay(dt_s, FREE_MEAN_S);
        (self.says(push), seen)
    }

    fn says(&mut self, push: &Push<D>) -> Says {
        let (strong, weak) = (self.strong_left_s > 0.0, self.weak_left_s > 0.0);
        self.strong_left_s = (self.strong_left_s - self.period_s).max(0.0);
        self.weak_left_s = (self.weak_left_s - self.period_s).max(0.0);
        if strong {
            Says::Hand
        } else if self.is_free(push) {
            self.weak_left_s = 0.0;
            Says::Free
        } else if weak {
            Says::Perhaps
        } else {
            Says::Nothing
        }
    }

    fn is_free(&self, push: &Push<D>) -> bool {
        let pushed_n = self.free_applied_n.norm();
        pushed_n > PUSHED_N
            && self.free_hand_n.norm() < FREE * pushed_n + OFF_N
            && self.free_applied_n.dot(&push.along) > 0.0
            && push.out_m_s > ALONG_M_S
    }

    /// Where the handle went since the force is withheld, and whether it rests.
    fn follow(&mut self, push: &Push<D>) {
        let dt_s = self.period_s;
        if self.withheld_s <= 0.0 || (push.at_m - self.farthest_m).dot(&push.along) > 0.0 {
            self.farthest_m = push.at_m;
        }
        self.withheld_s += dt_s;
        self.quiet_s += dt_s;
        if self.withheld_s > LATER_S {
            self.later_mean_n += (self.hand_mean_n.norm() - self.later_mean_n) * decay(dt_s, MEANS_MEAN_S);
        }
        self.at_rest_s = if push.velocity_m_s.norm() < self.rest_m_s { self.at_rest_s + dt_s } else { 0.0 };
        match &mut self.rest_m {
            Some(rest_m) => *rest_m += (push.at_m - *rest_m) * decay(dt_s, STIR_S),
            None if self.at_rest_s > REST_S => self.rest_m = Some(push.at_m),
            None => {}
        }
    }

    /// The handle moves as no handle does that is braked and alone.
    fn moves(&self, push: &Push<D>, held_n: f64, withheld: f64) -> bool {
        let back = withheld > WITHHELD && (self.farthest_m - push.at_m).dot(&push.along) > BACK_M;
        let stirs = self.rest_m.is_some_and(|rest_m| {
            let way_m = push.at_m - rest_m;
            let along_m = way_m.dot(&push.along);
            let aside_m = (way_m - push.along * along_m).norm();
            let unpushed = held_n < UNPUSHED_N && withheld > NEARLY_ALL;
            along_m < -STIR_M || ((along_m > STIR_M || aside_m > STIR_M) && unpushed)
        });
        let late = self.withheld_s > self.moving_after_s && self.rest_m.is_none();
        let goes_on = late && push.velocity_m_s.norm() > MOVING_M_S && (push.out_m_s < 0.0 || withheld > NEARLY_ALL);
        back || stirs || goes_on || self.later_mean_n > WEAK_N
    }
}
